"""Files by hand: read a rig, change it by operations, write it; `edit.edit` in parts."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from rigtri.errors import UsageError
from rigtri.files import temp_dirs
from rigtri.files.input_stream import opened, path_of
from rigtri.formats import Document, ReadOptions
from rigtri.formats import read as read_document
from rigtri.limits import TOLERANCE
from rigtri.model.arguments import typed
from rigtri.model.dataclass import dataclass
from rigtri.model.edit_options import RunOptions
from rigtri.model.rig import Rig
from rigtri.operations.operation import with_keywords
from rigtri.pipeline.edit import EditRequest, Outcome, edit_file
from rigtri.pipeline.verify_variants import looks_apart, with_variants
from rigtri.report import Report
from rigtri.verification import Terms
from rigtri.verification.compare import compare
from rigtri.verification.compare.compare import Comparison, Source

if TYPE_CHECKING:
    from rigtri.verification.diff.diff import Difference


@dataclass(frozen=True, eq=False)
class Origin:
    """What a rig goes on knowing of its file: how it was read, and what operations have reported since.

    content: what was read, where no file at ``path`` has it. The document does not know this: a rig
    that its own document held would keep the file open in a ring.
    """

    path: Path
    document: Document
    reading: ReadOptions
    report: Report
    content: bytes | None = None

    def after(self, report: Report) -> Origin:
        """This origin for a rig to which something more was done; other rigs of the file keep theirs."""
        merged = Report()
        merged.merge(self.report)
        merged.merge(report)
        return replace(self, report=merged)

    def needed(self) -> list[tuple[Path, str]]:
        """The file and all that it refers to, each with what it is: where its rig helps to edit another,
        nothing that is written may take their place."""
        own = [] if self.content is not None else [(self.path, "a file that the edit reads")]
        return [*own, *self.document.needed()]


@typed
def read(path: Path | str, options: ReadOptions | None = None) -> Rig:
    """The rig in a file; its suffix names the format. It knows its file, so that `write` can write it.

    path: a glTF, VRM or USD file; ``-`` is standard input. options: how it is read.
    Its arrays are read-only: an edit is a new rig with arrays of its own (`dataclasses.replace`).
    Raises FileError for anything unreadable, NameNotFoundError for a root that is not there.
    """
    options = options or ReadOptions()
    with opened(path) as place:
        return known(read_document(place, options), place, options)


def known(document: Document, path: Path, options: ReadOptions, content: bytes | None = None) -> Rig:
    """The rig of a document that was read from ``path``, or from ``content``, able to be written."""
    _protect(document.rig)
    return replace(document.rig, source=Origin(path, document, options, Report(), content))


def _protect(rig: Rig) -> None:
    """Let nobody write over numbers of a file: what is compared with them would not see it."""
    numbers = [
        rig.parents,
        rig.translation,
        rig.rotation,
        rig.scale,
        rig.matrix,
        rig.has_matrix,
        rig.attachment,
    ]
    numbers += [bound.vector for bound in rig.bound]
    numbers += [each for skin in rig.skins for each in (skin.joints, skin.inverse_bind)]
    numbers += [each for clip in rig.clips for track in clip.tracks for each in (track.times, track.values)]
    for each in numbers:
        each.flags.writeable = False


@with_keywords(RunOptions)
def write(
    rig: Rig,
    target: Path | str,
    *,
    overwrite: bool = False,
    verify: bool = True,
    tolerance: float = TOLERANCE,
    strict: bool = False,
    dry_run: bool = False,
) -> Outcome:
    """Write the file that ``rig`` was read from with the rig as it is now, compared with the file as it was.

    ``target`` appears complete or not at all, with the bytes that a command for the same operation writes.
    Everything is as in `edit.edit`, and so are the errors; UsageError for a rig that no `read`
    has read. The report of the outcome has what all operations have reported.
    """
    origin = rig.source
    if not isinstance(origin, Origin):
        raise UsageError("this rig was not read by rigtri.read; there is no file to write it back into")

    def step(first: Rig, report: Report) -> Rig:
        report.merge(origin.report)
        same = all(getattr(rig, f.name) is getattr(first, f.name) for f in fields(Rig) if f.name != "source")
        return first if same else replace(rig, source=None)

    how: dict[str, Any] = {"verify": verify, "tolerance": tolerance, "dry_run": dry_run, "strict": strict}
    with _file(origin) as path:
        request = EditRequest(path, target, origin.reading, overwrite=overwrite, **how)
        return edit_file(replace(request, document=origin.document), step, Report())


@contextmanager
def _file(origin: Origin) -> Iterator[Path]:
    """The file of an origin; one for the meantime where what was read is in none."""
    if origin.content is None:
        yield origin.path
        return
    with temp_dirs.folder() as folder:
        path = Path(folder, origin.path.name)
        path.write_bytes(origin.content)
        yield path


@typed
def verify(
    before: Path | str | Source, after: Path | str | Source, *, options: ReadOptions | None = None
) -> Comparison:
    """How far two files, or two documents, look apart, in every pose; see `compare.verify`.

    Up to 64 variants of a USD file that are not selected, and combinations of them, are compared, too, and
    others named (``unseen``).
    before, after: paths, or documents as `rigtri.formats.read` returns them. options: how files are read.
    Of a glTF and a USD that `rigtri.convert` has made of one another, nodes are known by what it calls them.
    """
    with _source(before, options) as one, _source(after, options) as other:
        found = _of_two_formats(one, other)
        return with_variants(looks_apart(one, other), one, other) if found is None else found


def _of_two_formats(one: Source, other: Source) -> Comparison | None:
    """How far a glTF and a USD that were made of one another look apart; None for any others."""
    if type(one) is type(other):
        return None
    from rigtri.pipeline.convert import verify_converted

    return verify_converted(one, other)


@typed
def diff(
    before: Path | str,
    after: Path | str,
    *,
    only: Terms | None = None,
    tolerance: float = 0.0,
    verify: bool = True,
    options: ReadOptions | None = None,
) -> Difference:
    """Say what of the second file is not what it was in the first; see `rigtri.verification.diff.diff.diff`.

    How far a glTF and a USD that were made of one another look apart is what `verify` says.
    before, after: paths of files. only: in ``rig`` or ``file`` terms alone. tolerance: numbers that
    differ by no more are the same. verify: measure how far they look apart, too. options: how files are read.
    """
    from rigtri.verification.diff import diff as terms

    def looks(one: Source, other: Source) -> Comparison:
        return _of_two_formats(one, other) or compare.verify(one, other)

    measure = looks if verify else None
    before, after = path_of(before), path_of(after)
    return terms.diff(before, after, only=only, tolerance=tolerance, options=options, measure=measure)


@contextmanager
def _source(file: Path | str | Source, options: ReadOptions | None) -> Iterator[Source]:
    if not isinstance(file, Path | str) and hasattr(file, "rig"):
        yield file
        return
    with opened(path_of(cast(Path, file))) as place:
        yield read_document(place, replace(options or ReadOptions(), empty=True))
