"""Edits of Skeleton prims: all lists with an item for each joint, at once."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from pxr import Sdf

from rigtri.formats.usd.composition.stage import refuse, why_instanced
from rigtri.formats.usd.composition.variants import SkeletonVariants
from rigtri.formats.usd.opinions.edits import Edit, set_matrices, set_tokens
from rigtri.formats.usd.reading.skeleton_reader import Skeleton
from rigtri.maths.trigonometry import Floats

_LISTS = ("joints", "bindTransforms", "restTransforms", "jointNames")
# In customData of restTransforms: rigtri added them, together with a joint.
REST_ADDED = "rigtri:added"


def set_joints(
    path: Any, tokens: Sequence[str], bind: Floats, rest: Floats | None, names: Sequence[str] | None = None
) -> Iterator[Edit]:
    """Set the joints of a skeleton. bind, rest: (n, 4, 4); without ``rest`` or ``names`` these stay."""
    yield set_tokens(path, "joints", tokens)
    yield set_matrices(path, "bindTransforms", bind)
    if rest is not None:
        yield set_matrices(path, "restTransforms", rest)
    if names is not None:
        yield set_tokens(path, "jointNames", names)


def joint_names(stage: Any, skeleton: Skeleton) -> list[str] | None:
    """The ``jointNames`` of a skeleton; None where it has not one for each joint."""
    prim = stage.GetPrimAtPath(skeleton.path)
    names = prim.GetAttribute("jointNames").Get() if prim.HasAttribute("jointNames") else None
    return [str(name) for name in names] if names and len(names) == len(skeleton.tokens) else None


def check_joints_editable(stage: Any, skeleton: Skeleton, change: str) -> None:
    """FileError where the joints of a skeleton cannot be edited; change: ``added`` or ``removed``."""
    refuse(why_instanced(stage.GetPrimAtPath(skeleton.path)), f"A joint cannot be {change}")
    own = [Sdf.Path(skeleton.path).AppendProperty(name) for name in _LISTS]
    variants = SkeletonVariants(stage, skeleton.path, skeleton.animation)
    variants.refuse_dependent(own, f"A joint cannot be {change}")
