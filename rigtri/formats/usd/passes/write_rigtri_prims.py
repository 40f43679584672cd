"""Write rigtri's own prims, such as controls: below a Scope ``rigtri`` of the prim that holds a skeleton."""

from __future__ import annotations

from collections.abc import Collection
from functools import cached_property
from itertools import chain
from typing import Any

import numpy as np
from pxr import Gf, Sdf, Usd, UsdGeom, UsdSkel, Vt

from rigtri.errors import FileError
from rigtri.formats.usd.composition.stage import refuse, why_locked
from rigtri.formats.usd.identifiers import identifier
from rigtri.formats.usd.opinions.edits import (
    Edit,
    apply_schema,
    bind_skeleton,
    define,
    drop_attribute,
    free_path,
    remove_properties,
    set_attributes,
    set_value,
)
from rigtri.formats.usd.opinions.reference_edits import portable, reference_edits
from rigtri.formats.usd.opinions.removal_edits import removals
from rigtri.formats.usd.opinions.skeleton_edits import as_one, set_joints
from rigtri.formats.usd.opinions.xform_edits import EULER, SAME_ROTATION, set_transform
from rigtri.formats.usd.passes.usd_edit import UsdEdit, is_rigtri_prim, sets_transform
from rigtri.formats.usd.reading.control_shape_reader import curves_name, curves_of
from rigtri.formats.usd.reading.joint_tokens import child_token
from rigtri.formats.usd.reading.metadata_attributes import TWIN, api_name, attributes_of, joint_attributes
from rigtri.formats.usd.reading.node_keys import kind, parts
from rigtri.formats.usd.reading.source import Source
from rigtri.formats.usd.reading.xform_hierarchy import OPS
from rigtri.maths.matrices import inverse, multiply
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Track
from rigtri.model.control_shapes import Shape
from rigtri.model.metadata import PoseWeightRecord, references
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin

# The Scope that holds rigtri's prims; it has no transform, so it is not Xformable to USD.
GROUP = "rigtri"


def write_rigtri_prims(edit: UsdEdit) -> None:
    """Define prims for new nodes, update those that changed, and remove those that go.

    FileError where another layer holds one that must be edited here.
    """
    source, rig = edit.source, edit.rig
    if any(c.key is None and c.kind != "tail" for c in rig.node_constraints):
        raise FileError("USD has no VRM node constraints; leave out --vrm-constraints")
    edit.values += _updates(source, rig, edit.changes.rigtri_prims)
    additions = _Additions(source, rig)
    edit.values += additions.edits()
    edit.values += removals(source, rig)
    # Renaming comes behind all edits that know a prim by the path it had.
    renamed = _renamed(source.rig, rig)
    edit.values += [_rename(str(path), name) for path, name in renamed.items()]

    def now(path: Any) -> Any:
        for old, name in renamed.items():
            path = path.ReplacePrefix(old, old.GetParentPath().AppendChild(name))
        return path

    made = {**additions.scopes, **additions.paths}
    edit.values += reference_edits(source, rig, made, additions.skeletons, now)


def _renamed(before: Rig, rig: Rig) -> dict[Any, str]:
    """The new names of prims of rigtri that have others, by path, deepest first."""
    return {
        Sdf.Path(before.labels[node]): identifier(rig.names[node])
        for node, key in reversed(list(enumerate(before.keys)))
        if kind(key) == "prim"
        and node not in rig.pending.removed
        and is_rigtri_prim(before, node)
        and before.names[node] != rig.names[node]
    }


class _Motion:
    """What moves prims of rigtri; the tracks of all nodes are looked through once, when first asked for."""

    def __init__(self, rig: Rig) -> None:
        self._rig = rig

    def of(self, node: int) -> list[Track]:
        """All that moves a prim, as samples hold it; a scale that stays 1 is none."""
        found = as_one(self._tracks.get(node, ()), f"'{self._rig.title(node)}'")
        return [
            t for t in found.values() if t.path != "scale" or np.abs(t.values - 1.0).max() > SAME_ROTATION
        ]

    @cached_property
    def _tracks(self) -> dict[int, list[Track]]:
        found: dict[int, list[Track]] = {}
        for track in (track for clip in self._rig.clips for track in clip.tracks):
            if track.path != "weights":
                found.setdefault(track.node, []).append(track)
        return found


def _is_control(rig: Rig, node: int) -> bool:
    return rig.type_of(node) == "control"


def _values(rig: Rig, node: int, control: Any, motion: _Motion) -> list[Edit]:
    """The attribute of a control that a pose reader drives: the x translation of its value node."""
    metadata = rig.metadata.get(node, {})
    name = TWIN + identifier(str(metadata["attribute"]))
    samples = {
        float(time): float(row[0])
        for track in motion.of(node)
        if track.path == "translation"
        for time, row in zip(track.times, track.values, strict=True)
    }
    resting = float(rig.translation[node, 0])
    double = Sdf.ValueTypeNames.Double
    return [set_value(control, name, double, resting, samples=samples, custom=True, alone=True)]


def _updates(source: Source, rig: Rig, keyed: Collection[int]) -> list[Edit]:
    before, found, motion = source.rig, [], _Motion(rig)
    for node, key in enumerate(before.keys):
        if kind(key) != "prim" or node in rig.pending.removed:
            continue
        path, metadata = before.labels[node], rig.metadata.get(node, {})
        if dict(metadata) != dict(before.metadata.get(node, {})):
            found += _update_metadata(source, rig, node)
        if not sets_transform(before, rig, node):
            continue
        if node in rig.pending.shapes:
            known = curves_of(source.stage.GetPrimAtPath(path))
            name = known.GetName() if known else curves_name(before.names[node])
            found += _define_curves(Sdf.Path(path).AppendChild(name), rig.pending.shapes[node], known)
        if node in keyed or (before.local[node] != rig.local[node]).any():
            prim = source.stage.GetPrimAtPath(path)
            refuse(_why_still(prim) or why_locked(prim, ("xformOpOrder",)))
            resets = UsdGeom.Xformable(prim).GetResetXformStack()
            stands = set_transform(
                path, rig.local[node], motion.of(node), to_key=_is_control(rig, node), resets=resets
            )
            used = {edit.name for edit in stands}
            idle = [name for name in (*OPS.values(), EULER) if name not in used]
            found += [*stands, *(remove_properties(path, name) for name in idle if prim.HasAttribute(name))]
            record = rig.record(node)
            if isinstance(record, PoseWeightRecord) and record.attribute:
                found += _values(rig, node, rig.labels[rig.find(record.control, "node")], motion)
    return found


def _why_still(prim: Any) -> str:
    """Why a prim of rigtri has no transform, as a rivet of another type has none; "" where it has."""
    why = f"<{prim.GetPath()}> is a {prim.GetTypeName()}, which USD gives no transform; make it an Xform"
    return "" if prim.IsA(UsdGeom.Xformable) else why


def _update_metadata(source: Source, rig: Rig, node: int) -> list[Edit]:
    """Edits of the attributes of a prim of which other metadata say another value, or nothing."""
    path, old, new = source.rig.labels[node], source.rig.metadata.get(node, {}), rig.metadata.get(node, {})
    before, after = (attributes_of(portable(r, stored)) for r, stored in ((source.rig, old), (rig, new)))
    gone = [name for name in before if name not in after]
    # What an older version has written with other types of values.
    changed = {str(key) for key in {*old, *new} if old.get(key) != new.get(key)}
    for written in source.stage.GetPrimAtPath(path).GetAuthoredPropertiesInNamespace("rigtri"):
        name = str(written.GetName())
        if name not in after and name.split(":")[1] in changed and isinstance(written, Usd.Attribute):
            gone.append(name)
    prim = source.stage.GetPrimAtPath(path)
    dropped = (prim.GetAttribute(name) for name in dict.fromkeys(gone))
    found: list[Edit] = [drop_attribute(attribute, source.layer) for attribute in dropped if attribute]
    return found + set_attributes(path, {k: v for k, v in after.items() if before.get(k) != v})


class _Additions:
    """The prims of new nodes: where each goes, what it is called, and where it stands."""

    def __init__(self, source: Source, rig: Rig) -> None:
        self.source, self.rig = source, rig
        self.world, self.motion = rig.world, _Motion(rig)
        self.paths: dict[int, Any] = {}
        self.skeletons: dict[int, Any] = {}  # the paths of those of new joints
        self.scopes: dict[int, Any] = {}  # the path that a new group has come to
        self.made: dict[Any, list[Edit]] = {}
        self.taken: set[Any] = set()

    def edits(self) -> list[Edit]:
        found: list[Edit] = []
        skins = self.rig.skins[len(self.source.rig.skins) :]
        joints = {joint for skin in skins for joint in skin.joints.tolist()}
        for node in range(len(self.source.rig), len(self.rig)):
            if self.rig.attachment[node] >= 0:
                path = self.rig.labels[int(self.rig.attachment[node])]
                raise FileError(
                    f"<{path}> has joints below it and a shape of its own, which no other prim can take, "
                    "so its axes and its scale cannot change. Put the joints below another prim."
                )
            if self._is_group(node) or node in joints:
                continue
            found += self._locator(node)
        for skin in skins:
            found += self._skeleton(skin)
        # A group without children would be an empty Scope.
        return [*chain(*self.made.values()), *found]

    def _is_group(self, node: int) -> bool:
        return node >= len(self.source.rig) and self.rig.type_of(node) == "group"

    def _free(self, parent: Any, name: str) -> Any:
        """A path below ``parent`` that no prim has."""
        stage = self.source.stage
        path = free_path(
            parent, identifier(name), lambda path: path in self.taken or stage.GetPrimAtPath(path)
        )
        self.taken.add(path)
        return path

    def _skeleton(self, skin: Skin) -> list[Edit]:
        """The skeleton of a new skin, where the locators are that are about the same."""
        joints = skin.joints.tolist()
        parent, above = self._parent(joints[0])
        rest = self.rig.local[skin.joints]
        roots = [k for k, joint in enumerate(joints) if int(self.rig.parents[joint]) not in joints]
        rest[roots] = multiply(self.world[skin.joints[roots]], inverse(above))
        path = self._free(parent, skin.name or "skeleton")
        self.skeletons |= dict.fromkeys(joints, path)
        return _define_skeleton(path, skin, self.rig, rest)

    def _locator(self, node: int) -> list[Edit]:
        parent, above = self._parent(node)
        path = self.paths[node] = self._free(parent, self.rig.names[node] or "locator")
        local = multiply(self.world[node], inverse(above))
        # 1e-16 of a position is the noise of this product, not a place.
        local = np.where(np.abs(local) < 1e-15 * max(1.0, float(np.abs(local).max())), 0.0, local)
        metadata = self.rig.metadata.get(node, {})
        to_key = _is_control(self.rig, node)
        stands = set_transform(path, local, self.motion.of(node), to_key=to_key)
        found = [define(path, "Xform"), *stands]
        found += set_attributes(path, attributes_of(portable(self.rig, metadata)))
        if "attribute" in metadata:
            control = self.rig.find(str(metadata["control"]), "node")
            found += _values(self.rig, node, self.paths.get(control) or self.rig.labels[control], self.motion)
        if node in self.rig.pending.shapes:
            found += _define_curves(path.AppendChild(curves_name(path.name)), self.rig.pending.shapes[node])
        return [*found, apply_schema(path, api_name(metadata["type"]))] if "type" in metadata else found

    def _parent(self, node: int) -> tuple[Any, Any]:
        """The prim that a new node goes under, and that prim's world matrix."""
        parent = int(self.rig.parents[node])
        if parent in self.paths:
            return self.paths[parent], self.world[parent]
        if 0 <= parent < len(self.source.rig) and kind(self.rig.keys[parent]) == "prim":
            return Sdf.Path(self.rig.labels[parent]), self.world[parent]
        return self._scope(self._top(node), parent)

    def _top(self, node: int) -> Any:
        """The top-level prim that holds the skeleton a node is about."""
        rig, metadata = self.rig, self.rig.metadata.get(node, {})
        known = (rig.known(name) for name in references(metadata))
        joints = (node for node in known if node is not None and kind(rig.keys[node]) == "joint")
        about = [parts(rig.keys[node])[1] for node in joints][:1]
        if not about:
            about = list(self.source.skeletons) or [parts(s.key)[1] for s in rig.skins if parts(s.key)]
        default = self.source.stage.GetDefaultPrim()
        if not about and not default:
            return None
        path = Sdf.Path(about[0]).GetPrefixes()[0] if about else default.GetPath()
        prim = self.source.stage.GetPrimAtPath(path)
        return None if prim.IsInstance() or prim.IsInstanceProxy() else path

    def _scope(self, top: Any, group: int) -> tuple[Any, Any]:
        """The Scope of rigtri below ``top`` (at the root where ``top`` is an instance)."""
        parent = Sdf.Path.absoluteRootPath if top is None else top
        stage = self.source.stage

        def of_others(path: Any) -> bool:
            return bool(prim := stage.GetPrimAtPath(path)) and not prim.HasAttribute("rigtri:type")

        path = free_path(parent, GROUP, of_others)
        if path not in self.made and not stage.GetPrimAtPath(path):
            metadata = self.rig.metadata.get(group, {}) if self._is_group(group) else {}
            self.made[path] = [
                define(path, "Scope"),
                *set_attributes(path, attributes_of({"v": 1, "type": "group", **metadata})),
                apply_schema(path, api_name("group")),
            ]
            if top is not None and stage.GetPrimAtPath(top).IsA(UsdSkel.Root):
                self.made[path] += bind_skeleton(str(path), [])
        if self._is_group(group):
            self.scopes.setdefault(group, path)
        nodes = {label: node for node, label in enumerate(self.rig.labels)}
        above = self.world[nodes[str(top)]] if str(top) in nodes else np.eye(4)
        return path, above


def _define_curves(path: Any, shape: Shape, known: Any = None) -> list[Edit]:
    """Edits that define the BasisCurves of a shape at ``path``; known: the prim where it has curves.

    New curves alone are a guide: with that purpose on the control itself Blender's import would drop the
    control with its attributes. Known ones keep the purpose that someone has given them.
    """
    types = Sdf.ValueTypeNames
    points = Vt.Vec3fArray.FromNumpy(np.concatenate(shape.strips).astype(np.float32))
    counts = Vt.IntArray([len(strip) for strip in shape.strips])
    wrap = "periodic" if shape.closed else "nonperiodic"
    values: list[tuple[str, Any, Any, bool]] = [
        ("type", types.Token, "linear", True),
        ("wrap", types.Token, wrap, True),
        *([] if known else [("purpose", types.Token, "guide", True)]),
        ("curveVertexCounts", types.IntArray, counts, False),
        ("points", types.Point3fArray, points, False),
        ("extent", types.Float3Array, UsdGeom.PointBased.ComputeExtent(points), False),
        ("primvars:displayColor", types.Color3fArray, Vt.Vec3fArray([Gf.Vec3f(*shape.color)]), False),
    ]
    edits = [set_value(path, name, kind, value, uniform=uniform) for name, kind, value, uniform in values]
    return [define(path, "BasisCurves"), *edits]


def _define_skeleton(path: Any, skin: Skin, rig: Rig, rest: Floats) -> list[Edit]:
    """A Skeleton prim at ``path`` with the new joints of a skin.

    rest: (m, 4, 4), where each stands, seen from its parent joint, or from the prim if it has none.
    """
    tokens: dict[int, str] = {}
    for node in skin.joints.tolist():
        tokens[node] = child_token(tokens.get(int(rig.parents[node]), ""), rig.names[node])
    by_token = {token: rig.metadata[node] for node, token in tokens.items() if node in rig.metadata}
    return [
        define(path, "Skeleton"),
        *set_joints(path, list(tokens.values()), inverse(skin.inverse_bind), rest),
        *set_attributes(path, joint_attributes(by_token)),
    ]


def _rename(path: str, name: str) -> Edit:
    def rename(layer: Any) -> None:
        spec = layer.GetPrimAtPath(path)
        if spec is None or spec.specifier != Sdf.SpecifierDef:
            raise FileError(f"<{path}> is defined in another layer, so it cannot be renamed here.")
        spec.name = name

    return Edit(Sdf.Path(path), rename)
