"""Compare two USD files in the variants that neither selects, too."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, Protocol, runtime_checkable

from rigtri.errors import FileError, NameNotFoundError
from rigtri.verification.compare import compare
from rigtri.verification.compare.compare import Comparison, Source

# Each is a comparison of all that the files show; what is beyond is named. As many as an edit looks through
# for one skeleton (`formats.usd.composition.variants.LIMIT`), so that all is seen that an edit has written.
MOST = 64
# So many nodes are compared again, in all of them; one variant at least.
MOST_NODES = 20_000


@runtime_checkable
class Choosing(Source, Protocol):
    """A document of a format with variants."""

    def choices(self) -> Sequence[Mapping[Any, str]]: ...
    def selecting(self, chosen: Mapping[Any, str]) -> Choosing | None: ...


@runtime_checkable
class Sharing(Source, Protocol):
    """A document of a format with instances."""

    def sharing(self, other: Any) -> Sharing: ...


def looks_apart(before: Source, after: Source) -> Comparison:
    """How far two documents look apart, in the selected variants, with the same instances read of both."""
    if isinstance(before, Sharing) and isinstance(after, Sharing):
        after = after.sharing(before)
        before = before.sharing(after)
    return compare.verify(before, after)


def with_variants(found: Comparison, before: Source, after: Source) -> Comparison:
    """What was found with the selected variants, and what there is in others, up to `MOST` of them.

    One set is selected otherwise at a time, and with it those that only its variant shows; then several at
    once that each show characters otherwise. What could not be compared is named as ``unseen``: what only the
    first file can select, cannot be read, or is too much.
    """
    if not (isinstance(before, Choosing) and isinstance(after, Choosing)):
        return found
    unseen: list[str] = []
    most = max(1, min(MOST, MOST_NODES // max(1, len(before.rig))))
    for count, chosen in enumerate(before.choices()):
        where = _words(chosen)
        if count >= most:
            unseen.append(f"{where}, as {most} other{'s were' if most > 1 else ' was'}")
            continue
        try:
            mine = before.selecting(chosen)
        except (FileError, NameNotFoundError) as error:
            unseen.append(f"{where}: {error}")
            continue
        try:
            theirs = after.selecting(chosen)
        except (FileError, NameNotFoundError) as error:
            lost = where if isinstance(error, NameNotFoundError) else f"{where}: {error}"
            found = replace(found, lost=(*found.lost, lost))
            continue
        if mine is None or theirs is None:
            unseen.append(f"{where}, because AFTER does not have that set")
            continue
        found = found.with_also(looks_apart(mine, theirs), where)
    return replace(found, unseen=tuple(unseen)) if unseen else found


def _words(chosen: Mapping[Any, str]) -> str:
    from rigtri.formats.usd.composition.variants import in_words

    return in_words(chosen)
