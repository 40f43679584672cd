"""Joint tokens before and after a split: a joint's path names all that stands above it.

A split puts a joint above another, ``A/B`` becomes ``A/B_orient/B``, and every
token below takes the step in between.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Mapping, Sequence
from functools import partial


def child_token(parent: str, name: str) -> str:
    """The token of a joint below another; ``parent`` is "" for none."""
    return f"{parent}/{name}" if parent else name


def split_token(token: str, holders: Mapping[str, str]) -> str:
    """A token with a step above every joint that is split.

    holders: the token of each split joint, and the name of what goes above it.

    >>> split_token("A/B/C", {"A/B": "B_orient"}), split_token("A/BC", {"A/B": "B_orient"})
    ('A/B_orient/B/C', 'A/BC')
    """
    steps: list[str] = []
    passed = ""
    for k, step in enumerate(token.split("/")):
        passed = step if k == 0 else f"{passed}/{step}"
        steps += [holders[passed], step] if passed in holders else [step]
    return "/".join(steps)


def renamed_token(token: str, names: Mapping[str, str], elsewhere: Mapping[str, str] | None = None) -> str:
    """A token with other names for joints. names: by the token of each joint its new name.

    elsewhere: by their old names those of joints whose tokens are not in ``names``.

    >>> renamed_token("A/B/C", {"A": "X", "A/B/C": "Z"})
    'X/B/Z'
    >>> renamed_token("B/C", {"A": "X", "A/B": "B", "A/B/C": "Z"}, {"C": "Z"})
    'B/Z'
    """
    steps, elsewhere = token.split("/"), elsewhere or {}
    passed = ["/".join(steps[: k + 1]) for k in range(len(steps))]
    return "/".join(
        names.get(way, elsewhere.get(step, step)) for way, step in zip(passed, steps, strict=True)
    )


def renamer(tokens: Sequence[str], names: Mapping[str, str]) -> Callable[[str], str]:
    """What becomes of a joint's token, also where another variant lists other joints.

    There joints are known by their paths, else by names that no two of ``tokens`` have.
    """
    steps = [token.split("/") for token in tokens]
    listed = {"/".join(each[: k + 1]): each[k] for each in steps for k in range(len(each))} | dict(names)
    count = Counter(each[-1] for each in steps)
    elsewhere = {old: new for token, new in names.items() if count[old := token.rpartition("/")[2]] == 1}
    return partial(renamed_token, names=listed, elsewhere=elsewhere)


def unsplit(tokens: Sequence[str], holders: Collection[str]) -> list[str]:
    """Tokens without the steps that ``holders`` (tokens) are in them; a holder keeps its own name.

    By these a joint is known again after a split. The tokens as they are where two would
    be called the same.

    >>> unsplit(["A", "A/B_orient", "A/B_orient/B"], {"A/B_orient"})
    ['A', 'A/B_orient', 'A/B']
    """
    found = [_without(token, holders) for token in tokens] if holders else list(tokens)
    return found if len(set(found)) == len(found) else list(tokens)


def _without(token: str, holders: Collection[str]) -> str:
    steps, passed, kept = token.split("/"), "", []
    for k, step in enumerate(steps):
        passed = step if k == 0 else f"{passed}/{step}"
        if passed not in holders or k == len(steps) - 1:
            kept.append(step)
    return "/".join(kept)
