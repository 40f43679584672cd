"""UsdSkel skeletons as arrays, checked: joint tokens, parents, bind and rest matrices.

Source: UsdSkel schemas: bindTransforms are in world space at bind time,
restTransforms are joint-local, a joint's parent is its nearest *listed* ancestor.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from pxr import Sdf, UsdSkel, Vt

from rigtri.errors import FileError
from rigtri.formats.usd.composition.stage import DEFAULT, numbers, tokens_of
from rigtri.maths.arrays import Booleans, Integers
from rigtri.maths.matrices import determinant, inverse, multiply
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length
from rigtri.model.dataclass import dataclass
from rigtri.report import Notice

# A frame whose volume is a smaller share of its axes' lengths has no inverse worth the name.
SINGULAR = 1e-12

# Places that differ by a smaller share of their largest number are one: what a few products leave.
_ONE_PLACE = 1e-9

# What exporters that multiply in float32 leave in a column that should be 0, 0, 0, 1.
PERSPECTIVE = 1e-5


@dataclass(frozen=True, eq=False)
class Skeleton:
    """One Skeleton prim. parents: (n,), −1 for a root. bind, rest: (n, 4, 4).

    locked: why it cannot be edited, "" where it can; a clip library may lack what that needs.
    animations: the paths of the SkelAnimations that are bound to it, several where instances share it.
    unbound: of those that move its joints as well, though nothing plays them (`loose_animations`); decided:
    of these the ones that variants decide, and those of variants that are not selected.
    scattered: no pose of the joints shows all its meshes as they are without skinning. unskinned: and UsdSkel
    shows them so, for it has no pose.
    """

    path: str
    tokens: tuple[str, ...]
    parents: Integers
    bind: Floats
    rest: Floats
    has_rest: bool
    locked: str
    animations: tuple[str, ...]
    scattered: bool = False
    unskinned: bool = False
    unbound: tuple[str, ...] = ()
    decided: tuple[str, ...] = ()

    @property
    def varied(self) -> tuple[str, ...]:
        """Those of its animations that may be others in other variants."""
        return tuple(dict.fromkeys((*self.animations, *self.decided)))

    @property
    def every_animation(self) -> tuple[str, ...]:
        """All that list its joints, and are edited with them."""
        return (*self.animations, *self.unbound)


def read_skeleton(
    prim: Any,
    animations: Sequence[Any],
    world: Floats,
    bound: Callable[[], Sequence[tuple[Floats, Floats]]],
    warnings: list[Notice],
) -> Skeleton | None:
    """The skeleton of a Skeleton prim whose world matrix is ``world``; None if it has no joints.

    animations: the SkelAnimation prims that are bound to it (`bound_animation`). bound: where each of its
    meshes is bound, and where it stands, as matrices of the world.
    FileError where its joints or matrices break UsdSkel's rules, naming them.
    """
    path = str(prim.GetPath())
    tokens = tokens_of(prim, "joints")
    if not tokens:
        warnings.append(Notice("no-joints", f"Skeleton <{path}> has no joints; it is left alone."))
        return None
    for number in unnamed(tokens)[:1]:
        what = f"is '{tokens[number]}', which is not a path" if tokens[number] else "has no name"
        text = f"Skeleton <{path}>: joint {number} {what}; it counts as a root, as in UsdSkel"
        warnings.append(Notice("joint-unnamed", text))
    parents = joint_parents(path, tokens)
    bind = _matrices(prim, "bindTransforms", tokens)
    if bind is None:
        raise FileError(
            f"Skeleton <{path}> has no bindTransforms, so what its skin looks like is undefined. "
            "Export it again with a bind pose."
        )
    wrong = singular(bind)
    if wrong.any():
        raise FileError(
            f"<{path}>.bindTransforms: the matrix of joint '{tokens[int(wrong.argmax())]}' has no "
            "inverse (an axis is zero or two coincide), so its skin is undefined."
        )
    rest = _matrices(prim, "restTransforms", tokens)
    driving = [animation for animation in animations if animation.IsActive()]
    shift: Floats | None = np.eye(4)
    if rest is None:
        for animation in driving:
            _check_covered(path, tokens, animation)
        shift = _shift(bound())
        warnings.append(
            Notice("no-rest", f"Skeleton <{path}> has no restTransforms; its bind pose is used instead.")
        )
    return Skeleton(
        path=path,
        tokens=tokens,
        parents=parents,
        bind=bind,
        rest=_local(_moved(bind, shift), parents, world) if rest is None else rest,
        has_rest=rest is not None,
        locked="",
        animations=tuple(str(animation.GetPath()) for animation in animations),
        scattered=shift is None,
        unskinned=shift is None and not driving,
    )


def refuse_unskinned(skeleton: Skeleton, pose: str) -> None:
    """FileError for a skeleton whose meshes a rest pose would move elsewhere. pose: which it would get."""
    if skeleton.unskinned:
        raise FileError(
            f"<{skeleton.path}> has no restTransforms and no animation, so UsdSkel leaves its meshes where "
            f"they are, and with {pose} it would skin them. Add restTransforms."
        )


def _shift(bound: Sequence[tuple[Floats, Floats]]) -> Floats | None:
    """What takes all joints from where they are bound to where the skin is as UsdSkel shows it: unskinned.

    Without any pose it leaves points where their prims are. None where meshes would need joints elsewhere.
    """
    shifts = [multiply(inverse(bind), world) for bind, world in bound if not singular(bind[np.newaxis])[0]]
    if len(shifts) < len(bound):
        return None
    first = shifts[0] if shifts else np.eye(4)
    size = max(1.0, float(np.abs(first).max()))
    same = all(float(np.abs(shift - first).max()) <= _ONE_PLACE * size for shift in shifts)
    return first if same else None


def _moved(bind: Floats, shift: Floats | None) -> Floats:
    return bind if shift is None else multiply(bind, shift)


def joint_parents(path: str, tokens: Sequence[str]) -> Integers:
    """The index of each joint's nearest listed ancestor, (n,), −1 for roots.

    FileError where a joint is listed twice, or before its parent.
    """
    index: dict[str, int] = {}
    for number, token in enumerate(tokens):
        if token in index:
            raise FileError(
                f"Skeleton <{path}> lists joint '{token}' twice. Every joint needs a path of its own."
            )
        index[token] = number
    parents = nearest_listed(tokens)
    early = np.flatnonzero(parents > np.arange(len(tokens)))
    if len(early):
        # A parent before its children: one pass is enough, and UsdSkel accepts nothing else.
        token, above = tokens[int(early[0])], tokens[int(parents[early[0]])]
        raise FileError(
            f"Skeleton <{path}> lists joint '{token}' before its parent '{above}'. "
            "UsdSkel requires parents first; sort the joints, their matrices and their influences."
        )
    return parents


def nearest_listed(tokens: Sequence[str]) -> Integers:
    """The index of each joint's nearest listed ancestor, (n,), −1 for roots, in whatever order they are.

    A token that is no path (``a/x:y``, ``a//b``, none at all) is a root, as in UsdSkel itself.
    """
    parents = _listed_parents(tokens)
    if parents is None:
        parents = UsdSkel.Topology(Vt.TokenArray(list(tokens))).GetParentIndices()
    return np.array(parents, dtype=np.int64).reshape(-1)


def unnamed(tokens: Sequence[str]) -> list[int]:
    """The numbers of tokens that are no paths."""
    if _listed_parents(tokens) is not None:
        return []
    return [number for number, token in enumerate(tokens) if not Sdf.Path.IsValidPathString(token)]


def _listed_parents(tokens: Sequence[str]) -> list[int] | None:
    """The index of what is right above each joint; None unless all are listed once, by the names of prims.

    OpenUSD makes a path of each token, and one of each joint above it: what a long chain costs is the square
    of its length, and more than all else that is done with it.
    """
    index = {token: number for number, token in enumerate(tokens)}
    found = []
    for token in tokens:
        above, slash, name = token.rpartition("/")
        parent = index.get(above) if slash else -1
        if parent is None or not Sdf.Path.IsValidIdentifier(name):
            return None
        found.append(parent)
    return found if len(index) == len(tokens) else None


def unbounded(matrices: Floats) -> Booleans:
    """Which matrices have numbers that are none, or none in float32, in which skins are computed, (n,)."""
    with np.errstate(over="ignore"):
        return np.asarray(~np.isfinite(matrices.astype(np.float32)).all(axis=(-2, -1)))


def _matrices(prim: Any, name: str, tokens: Sequence[str]) -> Floats | None:
    attribute, path = prim.GetAttribute(name), prim.GetPath()
    if attribute and attribute.GetNumTimeSamples():
        raise FileError(
            f"<{path}>.{name} has time samples, which UsdSkel reads as empty. Write one value without time."
        )
    value = attribute.Get(DEFAULT) if attribute else None
    if value is None or not len(matrices := numbers(attribute, value)):
        return None
    if len(matrices) != len(tokens):
        raise FileError(
            f"<{path}>.{name} has {len(matrices)} matrices for {len(tokens)} joints. Export it again."
        )
    lost = unbounded(matrices)
    if lost.any():
        raise FileError(
            f"<{path}>.{name}: the matrix of joint '{tokens[int(lost.argmax())]}' is not finite, or too "
            "large for float32. Export it again."
        )
    odd = (np.abs(matrices[:, :, 3] - (0.0, 0.0, 0.0, 1.0)) > PERSPECTIVE).any(axis=1)
    if odd.any():
        if (flat := odd & singular(matrices)).any():
            raise FileError(
                f"<{path}>.{name}: the matrix of joint '{tokens[int(flat.argmax())]}' is singular."
            )
        raise FileError(
            f"<{path}>.{name}: the last column of the matrix of joint '{tokens[int(odd.argmax())]}' "
            "is not 0, 0, 0, 1."
        )
    return matrices


def singular(matrices: Floats) -> Booleans:
    """Which matrices have no inverse worth the name, (n, 4, 4) → (n,)."""
    size = length(matrices[:, :3, :3]).prod(axis=1)
    return np.asarray(~(np.abs(determinant(matrices)) > SINGULAR * size))


def _check_covered(path: str, tokens: Sequence[str], animation: Any) -> None:
    driven = set(tokens_of(animation, "joints"))
    missing = [token for token in tokens if token not in driven]
    if missing:
        raise FileError(
            f"Skeleton <{path}> has no restTransforms and its animation <{animation.GetPath()}> drives "
            f"no joint '{missing[0]}', so the position of that joint is undefined. Add restTransforms."
        )


def _local(bind: Floats, parents: Integers, world: Floats) -> Floats:
    """Bind matrices (of the world) seen from the parents, (n, 4, 4)."""
    above = np.where((parents >= 0)[:, np.newaxis, np.newaxis], bind[parents], world)
    return multiply(bind, inverse(above))


def outside_of_scene(stage: Any) -> str:
    """Why USD counts no Skeleton of a stage as part of the scene, and what to do; "" without a reason."""
    prims = (prim for prim in stage.TraverseAll() if prim.GetTypeName() == "Skeleton")
    skeleton = next((prim for prim in prims if prim.IsAbstract() or not prim.IsDefined()), None)
    if skeleton is None:
        layer = stage.GetRootLayer()
        if not any(prim.specifier == Sdf.SpecifierOver for prim in layer.rootPrims):
            return ""
        return (
            "Its prims are overs of another layer's: give a stage that has both as sublayers, with "
            f"--edit-target {Path(layer.realPath).name}"
        )
    above = [stage.GetPrimAtPath(path) for path in skeleton.GetPath().GetPrefixes()]
    top = next(prim for prim in above if prim.IsAbstract() or not prim.IsDefined())
    kind = "a class" if top.IsAbstract() else "an over that no layer defines"
    return (
        f"<{skeleton.GetPath()}> is no prim of the scene, because <{top.GetPath()}> is {kind}. Make it "
        "a def, or edit the stage that defines it"
    )
