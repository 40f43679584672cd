"""Plain Xform hierarchies as rigs: prims that stand in for joints, and tracks that move them.

An animated prim becomes tracks of its translate, orient and scale ops where these hold all of it.
Other stacks (Euler angles, matrices, pivots) interpolate in ways that no track has; they become tracks with
keys as near to each other as that takes, which are evaluated and not written.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from pxr import Usd, UsdGeom, Vt

from rigtri.errors import FileError, NameNotFoundError, UsageError
from rigtri.formats.usd.composition.stage import why_locked
from rigtri.formats.usd.composition.time_samples import has_splines, ops_times
from rigtri.formats.usd.reading.mesh_reader import at_start
from rigtri.formats.usd.reading.node_keys import kind
from rigtri.formats.usd.reading.sampled_xforms import astray, notice_shear, sampled_tracks
from rigtri.maths.matrices import SKEW, decompose, decompose_flat, inverse, skew
from rigtri.maths.quaternions import IDENTITY, multiply, norm, normalise, off_unit, rotate, to_axes
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import dot
from rigtri.model.animation import PATHS, Clip, Interpolation, Path, Track
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin
from rigtri.report import Notice
from rigtri.text import and_more

# The ops that reorient a prim stand innermost and outermost.
FRAME = "xformOp:orient:rigtriFrame"
PARENT_INVERSE = "xformOp:orient:rigtriParentInv"
# The ops that resize a frame, beside those: uniform, so that their order is all one.
FRAME_SIZE, PARENT_INVERSE_SIZE = "xformOp:scale:rigtriFrame", "xformOp:scale:rigtriParentInv"
# The op of each property that a track moves, in the order of a stack.
OPS: Mapping[Path, str] = {
    "translation": "xformOp:translate",
    "rotation": "xformOp:orient",
    "scale": "xformOp:scale",
}
# What a property is without an op.
NOTHING: Mapping[Path, Floats] = {"translation": np.zeros(3), "rotation": IDENTITY, "scale": np.ones(3)}
# The clip of all prims that move, still without tracks.
XFORMS = Clip("xforms", (), ("xforms", ""))
_SIZES = (PARENT_INVERSE_SIZE, FRAME_SIZE)
_ORDER = (PARENT_INVERSE, *OPS.values(), FRAME)
# Scale components that differ by less are one number that was rounded to float32.
_UNIFORM = 1e-6
# A constant rotation farther off unit length is none to OpenUSD: it shears and scales what it turns.
_UNIT = 1e-6
# An axis is turned onto another where no part of it is off by more than a double rounds, a few times over.
_ONTO = 1e-14
# So many prims that no rig needs are looked at between their samples: one takes about 20 ms.
_FEW = 50


def rooted(rig: Rig, stage: Any, root: str, interpolation: Interpolation, warnings: list[Notice]) -> Rig:
    """The rig with the prims at and below ``root`` as joints; those that must keep their axes are fixed."""
    top = find_root(rig, root)
    _refuse_skeletons(stage, rig.labels[top])
    skin = pseudo_skin(rig, top)
    _notice_resets(rig, stage, top, warnings)
    fixed, bodies = dict(rig.rules.fixed), jointed_bodies(stage)
    for node in skin.joints.tolist():
        prim = stage.GetPrimAtPath(rig.labels[node])
        if not np.isfinite(UsdGeom.Xformable(prim).GetLocalTransformation()).all():
            text = "give no finite matrix, so nothing says where this joint is. Correct their default values"
            raise FileError(f"The ops of <{rig.labels[node]}> {text}")
        if why := bodies.get(rig.labels[node]) or why_fixed(prim):
            fixed[node] = why
    rig = replace(rig, skins=(*rig.skins, skin), rules=replace(rig.rules, fixed=fixed))
    return _animated(rig, stage, skin.joints.tolist(), interpolation, warnings)


def _animated(
    rig: Rig, stage: Any, joints: list[int], interpolation: Interpolation, warnings: list[Notice]
) -> Rig:
    """The rig with a clip of its animated Xform joints, as far as tracks can hold it."""
    rest: dict[Path, Floats] = {path: getattr(rig, path).copy() for path in OPS}
    tracks: list[Track] = []
    unread: dict[int, str] = {}
    for node in joints:
        prim = stage.GetPrimAtPath(rig.labels[node])
        xformable = UsdGeom.Xformable(prim)
        if not ops_times(xformable):
            continue
        stand = read_transform(prim, node, interpolation)
        # One sample is a key of an op that a track stands for; of others it is but where the prim stands.
        if stand is None and not xformable.TransformMightBeTimeVarying():
            continue
        if stand is None and (sampled := sampled_tracks(prim, node, interpolation)) is not None:
            stand = dict(zip(PATHS, decompose(rig.local[node]), strict=True)), sampled
            notice_shear(prim, sampled, interpolation, warnings)
        if stand is None:
            why = f"<{prim.GetPath()}> moves by ops that no track can hold"
            warnings.append(Notice("animated-xform", f"{why}; only its rest is measured."))
            unread[node] = why
            continue
        for path, value in stand[0].items():
            rest[path][node] = value
        tracks += stand[1]
    rig = replace(rig, rules=replace(rig.rules, unread=unread))
    if not tracks:
        return rig
    clip = replace(XFORMS, tracks=tuple(tracks))
    translation, rotation, scale = rest.values()
    return replace(rig, clips=(*rig.clips, clip), translation=translation, rotation=rotation, scale=scale)


def find_root(rig: Rig, root: str) -> int:
    """The prim that ``--root`` names: by path, or by a name that only one has."""
    if not rig.has(root):
        prims = [node for node, key in enumerate(rig.keys) if kind(key) == "prim"]
        known = [way[node] for node in prims for way in (rig.labels, rig.names)]
        raise NameNotFoundError("prim", root, known)
    node = rig.find(root, "prim")
    if kind(rig.keys[node]) != "prim":
        raise UsageError(f"--root '{root}' is a joint; name a prim, e.g. {rig.labels[0]}")
    return node


def _refuse_skeletons(stage: Any, root: str) -> None:
    """UsageError for a Skeleton at or below the root: its joints are the ones to reorient."""
    for prim in Usd.PrimRange(stage.GetPrimAtPath(root), Usd.TraverseInstanceProxies()):
        # One below a group of rigtri's holds limbs that make-limb has made.
        if prim.GetTypeName() == "Skeleton" and not prim.GetParent().HasAttribute("rigtri:type"):
            raise UsageError(
                f"--root {root}: there is a skeleton, <{prim.GetPath()}>. --root is for plain "
                "hierarchies: leave it out, or name a prim without a skeleton below it."
            )


def _notice_resets(rig: Rig, stage: Any, top: int, warnings: list[Notice]) -> None:
    """A notice of each prim below the root that starts anew with !resetXformStack!."""
    root = f"{rig.labels[top].rstrip('/')}/"
    for node, label in enumerate(rig.labels):
        if kind(rig.keys[node]) != "prim" or not label.startswith(root) or rig.parents[node] >= 0:
            continue
        text = (
            f"<{label}> does not follow what is above it (!resetXformStack!); it and what follows it are "
            f"not joints of --root {rig.labels[top]}. To have them as joints, run again with --root {label}."
        )
        if UsdGeom.Xformable(stage.GetPrimAtPath(label)).GetResetXformStack():
            warnings.append(Notice("reset-stack", text))


def pseudo_skin(rig: Rig, root: int) -> Skin:
    """The prims at and below ``root`` as joints, bound as they are at rest; what rigtri added is none."""
    added = {node for group in rig.nodes_of("group") for node in rig.below(group)}
    joints = [node for node in rig.below(root) if kind(rig.keys[node]) == "prim" and node not in added]
    return Skin(
        name=rig.names[root],
        joints=np.array(joints, dtype=np.int64),
        inverse_bind=inverse(rig.world[joints]),
        stored=False,
        key=("root", rig.labels[root]),
    )


def why_fixed(prim: Any) -> str:
    """Why a prim must keep its axes; "" where it may be reoriented."""
    if prim.IsA(UsdGeom.Gprim) or prim.IsA(UsdGeom.Camera) or prim.IsA(UsdGeom.PointInstancer):
        return f"<{prim.GetPath()}> is itself a {prim.GetTypeName()}; only prims above it can be re-oriented"
    if prim.GetTypeName().endswith("Light"):
        return f"<{prim.GetPath()}> is itself a light; only prims above it can be re-oriented"
    ops = UsdGeom.Xformable(prim).GetOrderedXformOps() if prim.HasAttribute(FRAME) else ()
    frame = next((op for op in ops if op.GetOpName() == FRAME), None)
    if off_unit(_first(frame, IDENTITY)) > _UNIT:
        return f"<{prim.GetPath()}>.{FRAME} is not unit, and shears what it turns; normalise it"
    held = [name for name in prim.GetAuthoredPropertyNames() if name.startswith("constraintTargets:")]
    held += ["extentsHint"] if prim.GetAttribute("extentsHint").HasAuthoredValue() else []
    if held:
        return f"<{prim.GetPath()}>.{held[0]} is kept in its axes"
    return why_locked(prim, ("xformOpOrder",))


def jointed_bodies(stage: Any) -> dict[str, str]:
    """Prims that physics joints keep frames for, by path, with the reason to leave them."""
    found = {}
    for prim in stage.Traverse():
        if prim.GetTypeName().startswith("Physics") and prim.GetTypeName().endswith("Joint"):
            for name in ("physics:body0", "physics:body1"):
                relation = prim.GetRelationship(name)
                for target in relation.GetTargets() if relation else ():
                    found[str(target)] = f"the physics joint <{prim.GetPath()}> keeps a frame in its axes"
    return found


def read_transform(
    prim: Any, node: int, interpolation: Interpolation
) -> tuple[dict[Path, Floats], list[Track]] | None:
    """Where a prim stands, as a value for each property, and its tracks; None where tracks cannot hold it."""
    ops: dict[str, Any] = {str(op.GetOpName()): op for op in UsdGeom.Xformable(prim).GetOrderedXformOps()}
    names = [name for name in ops if name not in _SIZES]
    if names != [name for name in _ORDER if name in ops] or has_splines(prim):
        return None
    constant = [ops[name] for name in (PARENT_INVERSE, FRAME, *_SIZES) if name in ops]
    if any(op.GetNumTimeSamples() for op in constant):
        return None
    outer, inner = (_first(ops.get(name), IDENTITY) for name in (PARENT_INVERSE, FRAME))
    if off_unit((outer, inner)) > _UNIT:
        return None
    outer_size, inner_size = (_first(ops.get(name), NOTHING["scale"]) for name in _SIZES)
    if any(not (size > 0).all() or _uneven(size) for size in (outer_size, inner_size)):
        return None
    sizes: dict[Path, Floats] = {"translation": outer_size, "scale": outer_size * inner_size}
    rest: dict[Path, Floats] = {}
    tracks: list[Track] = []
    for path, name in OPS.items():
        size = sizes.get(path, 1.0)
        op = ops.get(name)
        stands = _first(op, NOTHING[path])
        if stands.shape != NOTHING[path].shape or not np.isfinite(stands).all():
            return None
        stands = _turning(stands) if path == "rotation" else stands
        rest[path] = _folded(path, stands * size, outer, inner)
        keys = [] if op is None else [(time, op.Get(time)) for time in op.GetTimeSamples()]
        samples = [value_numbers(value) for _, value in keys if value is not None]
        # Some are blocked, or, in a damaged layer, of another type than the op.
        if len(samples) < len(keys) or any(each.shape != stands.shape for each in samples):
            return None
        if keys:
            values = np.stack(samples)
            if not np.isfinite(values).all():
                return None
            if path == "scale" and _uneven(values) and not _onto_axes(inner):
                return None
            values = _turning(values) if path == "rotation" else values
            values = _folded(path, values * size, outer, inner)
            times = np.array([time for time, _ in keys])
            tracks.append(Track(node, path, interpolation, times, values))
    if _uneven(rest["scale"]) and not _onto_axes(inner):
        return None
    return rest, tracks


def _turning(rotations: Floats) -> Floats:
    """Rotations, (..., 4), that are unit but for rounding: ops turn, and never scale, whatever their length.

    Half floats are never unit, so they would shear what the constant rotations around them turn.
    """
    off = np.abs(norm(rotations) - 1.0) > _UNIT
    return np.where(off[..., np.newaxis], normalise(rotations), rotations)


def _folded(path: Path, values: Floats, outer: Floats, inner: Floats) -> Floats:
    """Values, (..., c), with the constant rotations outside and inside folded in."""
    if path == "translation":
        return rotate(outer, values)
    if path == "rotation":
        return multiply(multiply(outer, values), inner)
    # Along the axes that the inner rotation takes there; of uneven ones it takes each to one.
    return dot(to_axes(inner) ** 2, values[..., np.newaxis, :]) if _uneven(values) else values


def _onto_axes(rotation: Floats) -> bool:
    """Whether a rotation takes each axis to an axis, either way."""
    axes = np.abs(to_axes(rotation))
    return bool(np.abs(axes - np.round(axes)).max() < _ONTO)


def _uneven(scale: Floats) -> bool:
    spread = scale.max(axis=-1) - scale.min(axis=-1)
    return bool((spread > _UNIFORM * np.abs(scale).max(axis=-1)).any())


def _first(op: Any, nothing: Floats) -> Floats:
    value = None if op is None else at_start(op.GetAttr())
    return nothing if value is None else value_numbers(value)


def value_numbers(value: Any) -> Floats:
    """A Gf vector or quaternion as numbers, quaternions as xyzw."""
    if hasattr(value, "GetImaginary"):
        return np.array([*value.GetImaginary(), value.GetReal()], dtype=np.float64)
    return np.array(value, dtype=np.float64)


def _evaluated(rig: Rig, skeletons: Iterable[int]) -> set[int]:
    """The nodes by which joints, controls and constraints are evaluated, with all above them."""
    about = (node for stored in rig.metadata.values() for node in rig.named_by(stored))
    return rig.with_ancestors({*skeletons, *rig.metadata, *about})


def xform_tracks(
    rig: Rig,
    skeletons: Iterable[int],
    prims: Mapping[int, Any],
    interpolation: Interpolation,
    warnings: list[Notice],
) -> list[Track]:
    """Translation, rotation and scale of animated prims, by node, to measure: three tracks each.

    They go USD's way between samples above skeletons and what metadata is about, for these are evaluated by
    them, and for other prims that a constraint may come to use, where these are few. Elsewhere, within a
    frame, and where matrices are sheared, Euler angles and pivots go straight; they go the same way in two
    files that are compared. Nothing writes these tracks.
    """
    if not prims:
        return []
    shared: dict[tuple[float, ...], Floats] = {}
    times, matrices = [], []
    for prim in prims.values():
        xformable = UsdGeom.Xformable(prim)
        keys = tuple(ops_times(xformable))
        times.append(shared.setdefault(keys, np.array(keys)))
        matrices += [xformable.GetLocalTransformation(time) for time in keys]
    ends = np.cumsum([len(keys) for keys in times])
    local = np.array(Vt.Matrix4dArray(matrices), dtype=np.float64)
    of = np.repeat(np.arange(len(times)), [len(keys) for keys in times])
    paths = [str(prim.GetPath()) for prim in prims.values()]
    values = _parts(local, [paths[k] for k in of.tolist()], warnings)
    columns = [np.split(part, ends[:-1]) for part in values]
    sampled = {}
    if interpolation != "STEP":
        nodes = list(prims)
        off = [nodes[row] for row in astray(list(prims.values()), times, values)]
        shown = off if len(off) <= _FEW else _evaluated(rig, skeletons).intersection(off)
        sampled = {node: sampled_tracks(prims[node], node, interpolation, scaled=True) for node in shown}
    found = []
    for row, node in enumerate(prims):
        held = [Track(node, p, interpolation, times[row], columns[k][row]) for k, p in enumerate(PATHS)]
        found += sampled.get(node) or held
    return found


def _parts(local: Floats, paths: list[str], warnings: list[Notice]) -> tuple[Floats, Floats, Floats]:
    """Translation, rotation and scale of matrices as far as they have them, with a notice where not."""
    finite = np.asarray(np.isfinite(local).all(axis=(1, 2)))
    if not finite.all():
        text = f"Samples of the ops of {_named(paths, ~finite)} give no finite matrix; they count as none."
        warnings.append(Notice("no-place", text))
        local = np.where(finite[:, np.newaxis, np.newaxis], local, np.eye(4))
    with np.errstate(invalid="ignore", divide="ignore"):
        translation, rotation, scale = decompose_flat(local)
        whole = np.asarray(np.isfinite(rotation).all(axis=1))
        odd = np.asarray(~whole | (skew(local) > SKEW))
    # What is hidden by a scale of zero has no axes; there is nothing to measure about them.
    odd &= (scale != 0).any(axis=1)
    if odd.any():
        text = f"{_named(paths, odd)}: sheared or flat samples are measured by their place and lengths alone."
        warnings.append(Notice("xform-sheared", text))
    return translation, np.where(whole[:, np.newaxis], rotation, IDENTITY), scale


def _named(paths: list[str], which: np.ndarray) -> str:
    names = sorted({paths[k] for k in np.flatnonzero(which).tolist()})
    return and_more([f"<{name}>" for name in names], 3)
