"""A USD stage as a rig: prims that have a place, the joints of skeletons, and what drives them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from pxr import Usd, UsdGeom

from rigtri.errors import FileError
from rigtri.formats.document import ReadOptions
from rigtri.formats.usd.composition.animation_binding import bound_animation
from rigtri.formats.usd.composition.stage import DEFAULT, quiet
from rigtri.formats.usd.composition.value_types import ignored
from rigtri.formats.usd.reading import (
    animation_library,
    joint_tokens,
    mesh_reader,
    metadata_attributes,
    xform_sampling,
)
from rigtri.formats.usd.reading.animation_reader import Animation, clips, interpolation_of, read_animation
from rigtri.formats.usd.reading.skeleton_reader import Skeleton, read_skeleton
from rigtri.formats.usd.reading.source import Source
from rigtri.formats.usd.reading.xform_hierarchy import read_transform, rooted
from rigtri.maths.matrices import compose, decompose, identity, inverse
from rigtri.maths.quaternions import from_axes, to_axes
from rigtri.model.animation import Clip, Track
from rigtri.model.format_rules import FormatRules
from rigtri.model.metadata import ADDED, illegible
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin
from rigtri.report import Notice
from rigtri.text import listed

# The Scope that holds rigtri's prims; it has no transform, so it is not Xformable to USD.
GROUP = "rigtri"
# rigtri's prims have translate, orient and scale; a transform that these cannot hold is somebody else's.
OWN_PLACE = 1e-9


def read_source(path: Path, options: ReadOptions, stage: Any, warnings: Sequence[Notice] = ()) -> Source:
    """Read the rig of a file. FileError where UsdSkel's rules are broken or there is no skeleton.

    warnings: what was noticed when the stage was opened.
    """
    with quiet(f"{path}: USD cannot read it"):
        return _Reader(path, stage, options, list(warnings)).read()


class _Reader:
    """One pass over a stage; nodes are collected in columns."""

    def __init__(self, path: Path, stage: Any, options: ReadOptions, warnings: list[Notice]) -> None:
        self.path, self.stage, self.options, self.warnings = path, stage, options, warnings
        self.names: list[str] = []
        self.parents: list[int] = []
        self.matrices: list[np.ndarray] = []
        self.keys: list[tuple[str, ...]] = []
        self.labels: list[str] = []
        self.attachment: list[int] = []
        self.own: list[int] = []  # prims of rigtri, which keep their transform as TRS
        self.metadata: dict[int, dict[str, Any]] = {}
        self.restless: list[str] = []  # prims of rigtri that are no controls, with samples and no default
        self.fixed: dict[int, str] = {}
        self.animated: dict[int, Any] = {}  # prims that their ops move over time
        self.node_of: dict[str, int] = {}
        self.joint_nodes: dict[str, dict[str, int]] = {}
        self.skeletons: dict[str, Skeleton] = {}
        self.animations: dict[str, Animation] = {}
        self.bindings = mesh_reader.Bindings(stage)
        self.interpolation = interpolation_of(stage)

    def read(self) -> Source:
        prims = self._prims()
        self._skeletons(prims)
        self._animations(prims)
        if not self.skeletons and self.options.root is None:
            self._library(prims)
        if not self.skeletons and self.options.root is None and not self.options.empty:
            raise FileError(f"{self.path}: there is no skeleton in it{self._excuse()}{self._remedy()}")
        rig = self._rig()
        rig = _mirrored_as_keyed(replace(rig, clips=tuple(self._clips()), skins=tuple(self._skins())))
        if self.options.root is not None:
            rig = rooted(rig, self.stage, self.options.root, self.interpolation, self.warnings)
        rules = replace(
            rig.rules,
            group_parent=self._group_parent(rig),
            per_second=float(self.stage.GetTimeCodesPerSecond()),
        )
        rig = replace(rig, rules=rules)
        return Source(
            self.path,
            self.stage,
            self._with_moving_prims(rig),
            self.skeletons,
            self.animations,
            self.warnings,
            self.bindings,
        )

    def _with_moving_prims(self, rig: Rig) -> Rig:
        """The rig with what moves its prims, to be measured; joints of --root have their own tracks."""
        joints = set() if self.options.root is None else set(rig.skins[-1].joints.tolist())
        prims = {node: prim for node, prim in self.animated.items() if node not in joints}
        mine = self._own_tracks(rig, prims)
        others = {node: prim for node, prim in prims.items() if node not in mine}
        tracks = xform_sampling.tracks(others, self.interpolation, self.warnings)
        tracks += [track for node in mine for track in mine[node]]
        if not tracks:
            return rig
        clips = tuple(clip for clip in rig.clips if clip.key != xform_sampling.KEY)
        known = [track for clip in rig.clips if clip.key == xform_sampling.KEY for track in clip.tracks]
        return replace(rig, clips=(*clips, Clip(xform_sampling.NAME, (*known, *tracks), xform_sampling.KEY)))

    def _own_tracks(self, rig: Rig, prims: Mapping[int, Any]) -> dict[int, tuple[Track, ...]]:
        """The keys of rigtri's prims as they are in their ops; what is mirrored goes by its matrices."""
        stands = {
            node: read_transform(prims[node], node, self.interpolation)
            for node in self.own
            if node in prims and not rig.has_matrix[node] and (rig.scale[node] > 0).all()
        }
        return {node: stand.tracks for node, stand in stands.items() if stand is not None}

    def _group_parent(self, rig: Rig) -> int:
        """The top-level prim that holds the first skeleton, where our Scope can stand below it."""
        about = list(self.skeletons) or [
            str(skin.key[1]) for skin in rig.skins if isinstance(skin.key, tuple)
        ]
        top = "/" + about[0].split("/")[1] if about else ""
        prim = self.stage.GetPrimAtPath(top) if top else None
        return self.node_of.get(top, -1) if prim and not prim.IsInstance() else -1

    def _excuse(self) -> str:
        codes = ("unresolved", "animation-ignored")
        missing = [notice.text for notice in self.warnings if notice.code in codes]
        return f" ({missing[0].rstrip('.')})" if missing else ""

    def _remedy(self) -> str:
        """What to do where there is no skeleton; nothing where there is nothing that could be one."""
        if not self.labels:
            return ", nor any prim that has a place"
        text = "If its joints are plain Xform prims, name the topmost with --root, e.g. --root"
        return f". {text} {self.labels[0]}"

    def _prims(self) -> list[Any]:
        """Every prim with a place as a node; returns the Skeleton and SkelAnimation prims."""
        others = []
        above: dict[Any, int] = {}
        for prim in Usd.PrimRange(self.stage.GetPseudoRoot(), mesh_reader.ALL_PRIMS):
            path = prim.GetPath()
            parent = above.get(path.GetParentPath(), -1)
            above[path] = parent
            kind = prim.GetTypeName()
            if kind in ("Skeleton", "SkelAnimation"):
                others.append(prim)
            group = kind == "Scope" and prim.HasAttribute("rigtri:type")
            if prim.IsA(UsdGeom.Xformable) or group:
                above[path] = self._add_prim(prim, parent, group)
        if self.restless:
            more = f" and {len(self.restless) - 1} more" if len(self.restless) > 1 else ""
            text = (
                f"Where '{self.restless[0]}'{more} stands at rest is not in the file (time samples without a "
                "default value), and limbs are recognised by it; rigtri bake --rig names a file that has it"
            )
            self.warnings.append(Notice("rest-lost", text))
        return others

    def _add_prim(self, prim: Any, parent: int, group: bool) -> int:
        node, path = len(self.names), str(prim.GetPath())
        metadata = metadata_attributes.read_prim(prim)
        made = not illegible(metadata) and metadata["type"] in ADDED
        if group:
            local = np.eye(4)
        else:
            xformable = UsdGeom.Xformable(prim)
            if xformable.GetTimeSamples():
                self.animated[node] = prim
                if made and metadata["type"] != "control" and _moment(xformable) != DEFAULT:
                    self.restless.append(str(prim.GetName()))
            # The rest value of an op of rigtri is its default; without, it is the identity.
            moment = _moment(xformable) if node in self.animated and not made else DEFAULT
            local = np.array(xformable.GetLocalTransformation(moment), dtype=np.float64)
            if not np.isfinite(local).all():
                text = f"The ops of <{path}> give no finite matrix; it is measured as if it had none."
                self.warnings.append(Notice("no-place", text))
                local = np.eye(4)
            parent = -1 if xformable.GetResetXformStack() else parent
        self._add(prim.GetName(), parent, local, ("prim", path), path)
        self.node_of[path] = node
        if _shows(prim):
            self.attachment[node] = node
        if prim.IsA(UsdGeom.PointBased):
            self.warnings += [Notice("type-ignored", text) for text in ignored(prim)]
        if metadata and not self._unread(path, metadata):
            self.metadata[node] = metadata
            self.own.append(node)
        return node

    def _add(self, name: str, parent: int, local: np.ndarray, key: tuple[str, ...], label: str) -> None:
        self.names.append(name)
        self.parents.append(parent)
        self.matrices.append(local)
        self.keys.append(key)
        self.labels.append(label)
        self.attachment.append(-1)

    def _skeletons(self, others: list[Any]) -> None:
        prims = [prim for prim in others if prim.GetTypeName() == "Skeleton"]
        if not prims:
            return
        world = self._rig().world
        for prim in prims:
            path = str(prim.GetPath())
            animation = bound_animation(prim, self.warnings)
            skeleton = read_skeleton(prim, animation, world[self.node_of[path]], self.warnings)
            if skeleton is not None:
                self.skeletons[path] = skeleton
        self._all_joints()

    def _all_joints(self) -> None:
        """The joints of all skeletons as nodes; a token that several have goes with its prim."""
        counts: dict[str, int] = {}
        for skeleton in self.skeletons.values():
            for token in skeleton.tokens:
                counts[token] = counts.get(token, 0) + 1
        for path, skeleton in self.skeletons.items():
            self._add_joints(skeleton, self._owner(path), counts)
            self._read_joint_metadata(self.stage.GetPrimAtPath(path), self.joint_nodes[path])

    def _owner(self, path: str) -> int:
        """The node of a prim, or of the nearest above it that has a place; −1 for none."""
        while path and path not in self.node_of:
            path = path.rpartition("/")[0]
        return self.node_of.get(path, -1)

    def _library(self, others: list[Any]) -> None:
        """Animations without any skeleton, as skeletons of their own."""
        world = self._rig().world
        for prim in (prim for prim in others if prim.GetTypeName() == "SkelAnimation"):
            path = str(prim.GetPath())
            animation = read_animation(prim, self.warnings)
            if animation is not None and animation.properties:
                owner = self._owner(path)
                place = world[owner] if owner >= 0 else np.eye(4)
                self.animations[path] = animation
                self.skeletons[path] = animation_library.stand_in(prim, animation, place)
        if self.skeletons:
            self.warnings.append(animation_library.notice(list(self.skeletons)))
            self._all_joints()

    def _add_joints(self, skeleton: Skeleton, owner: int, counts: Mapping[str, int]) -> None:
        first = len(self.names)
        nodes = {token: first + number for number, token in enumerate(skeleton.tokens)}
        self.joint_nodes[skeleton.path] = nodes
        before = joint_tokens.unsplit(skeleton.tokens, self._holders(skeleton))
        known = dict(zip(skeleton.tokens, before, strict=True))
        for number, token in enumerate(skeleton.tokens):
            parent = int(skeleton.parents[number])
            self._add(
                token.rpartition("/")[2],
                owner if parent < 0 else first + parent,
                skeleton.rest[number],
                ("joint", skeleton.path, known[token]),
                f"{skeleton.path}:{token}" if counts[token] > 1 else token,
            )
            if skeleton.locked:
                self.fixed[first + number] = skeleton.locked

    def _holders(self, skeleton: Skeleton) -> set[str]:
        """The tokens of joints that only hold the axes of the one below them."""
        found = metadata_attributes.read_joints(self.stage.GetPrimAtPath(skeleton.path))
        return {
            token
            for token, metadata in found.items()
            if metadata.get("type") == "frame" and "joint" in metadata
        }

    def _read_joint_metadata(self, prim: Any, nodes: Mapping[str, int]) -> None:
        for token, metadata in metadata_attributes.read_joints(prim).items():
            if token in nodes and not self._unread(token, metadata):
                self.metadata[nodes[token]] = metadata

    def _unread(self, title: str, metadata: Mapping[str, Any]) -> bool:
        """Whether another version has stored metadata, which are reported and left alone then."""
        why = illegible(metadata)
        if why:
            text = f"What rigtri stored on '{title}' stays as it is: {why}"
            self.warnings.append(Notice("note-unread", text))
        return bool(why)

    def _animations(self, others: list[Any]) -> None:
        bound = {skeleton.animation for skeleton in self.skeletons.values()} - {""}
        for path in sorted(bound):
            animation = read_animation(self.stage.GetPrimAtPath(path), self.warnings)
            if animation is not None:
                self.animations[path] = animation
        paths = [str(prim.GetPath()) for prim in others if prim.GetTypeName() == "SkelAnimation"]
        loose = [path for path in paths if path not in bound]
        if loose and self.skeletons:
            shown = listed([f"<{path}>" for path in loose])
            self.warnings.append(
                Notice(
                    "unbound-animation",
                    f"No skeleton uses {shown} in the selected variants: left as they were, unless a "
                    "skeleton of another variant uses them. What joints or controls get they do not, axes or "
                    "motion. To edit one along, bind a skeleton to it (skel:animationSource) and run again "
                    "from the source.",
                )
            )

    def _clips(self) -> list[Clip]:
        names = [animation.name for animation in self.animations.values()]
        found = []
        for path, animation in self.animations.items():
            users = [s.path for s in self.skeletons.values() if s.animation == path]
            name = animation.name if names.count(animation.name) == 1 else path
            prim, weights = self.stage.GetPrimAtPath(path), []
            if prim.IsActive() and prim.GetAttribute("blendShapeWeights").HasAuthoredValue():
                queries = self.bindings.of(users)
                weights = mesh_reader.blend_tracks(prim, queries, self.node_of, self.interpolation)
            driven = [self.joint_nodes[user] for user in users]
            found += clips(animation, name, driven, weights, self.interpolation)
        return found

    def _skins(self) -> list[Skin]:
        return [self._skin(skeleton) for skeleton in self.skeletons.values()]

    def _skin(self, skeleton: Skeleton) -> Skin:
        def weigh() -> np.ndarray:
            return mesh_reader.weighted(self.bindings.of({skeleton.path}), skeleton.tokens)

        nodes = self.joint_nodes[skeleton.path]
        real = skeleton.path not in self.animations
        return Skin(
            name=skeleton.path.rpartition("/")[2],
            joints=np.array([nodes[token] for token in skeleton.tokens], dtype=np.int64),
            inverse_bind=inverse(skeleton.bind),
            stored=real,
            weigh=weigh if real else None,
            key=("skeleton" if real else "library", skeleton.path),
        )

    def _rig(self) -> Rig:
        count = len(self.names)
        matrix = np.array(self.matrices, dtype=np.float64).reshape(-1, 4, 4)
        has_matrix = np.ones(count, dtype=bool)
        with np.errstate(invalid="ignore"):
            translation, rotation, scale = decompose(matrix)
        # A frame that is flat or sheared has no rotation; the matrix holds all there is.
        whole = np.all(np.isfinite(rotation), axis=1, keepdims=True)
        rotation = np.where(whole, rotation, (0.0, 0, 0, 1))
        composed = compose(translation, rotation, scale)
        for node in self.own:
            has_matrix[node] = bool(np.abs(composed[node] - matrix[node]).max() > OWN_PLACE)
        up = (0.0, 0.0, 1.0) if UsdGeom.GetStageUpAxis(self.stage) == "Z" else (0.0, 1.0, 0.0)
        return Rig(
            names=tuple(self.names),
            parents=np.array(self.parents, dtype=np.int64),
            translation=translation,
            rotation=rotation,
            scale=scale,
            matrix=np.where(has_matrix[:, np.newaxis, np.newaxis], matrix, identity(count)),
            has_matrix=has_matrix,
            attachment=np.array(self.attachment, dtype=np.int64),
            keys=tuple(self.keys),
            labels=tuple(self.labels),
            metadata=dict(self.metadata),
            rules=FormatRules(fixed=dict(self.fixed), up=up, raw_quaternions=True),
        )


def _mirrored_as_keyed(rig: Rig) -> Rig:
    """The rig with joints mirrored at rest about the axes about which their keys mirror them.

    A matrix does not hold which; a pose may take the scale of a clip and the rotation of rest.
    """
    rotation, scale = rig.rotation.copy(), rig.scale.copy()
    scales = [track for clip in rig.clips for track in clip.tracks if track.path == "scale"]
    for track in reversed(scales):
        node, keyed = track.node, np.where(track.values[0] < 0, -1.0, 1.0)
        flip = np.where(rig.scale[node] < 0, -1.0, 1.0) * keyed
        if rig.has_matrix[node] and flip.prod() > 0:
            rotation[node], scale[node] = rig.rotation[node], rig.scale[node] * flip
            if (flip < 0).any():
                rotation[node] = from_axes(to_axes(rig.rotation[node]) * flip[:, np.newaxis])
    return replace(rig, rotation=rotation, scale=scale)


def _moment(xformable: Any) -> Any:
    """When a prim is at rest: at the Default time, or at its start where it has only time samples."""
    attributes = [op.GetAttr() for op in xformable.GetOrderedXformOps()]
    return mesh_reader.EARLIEST if any(at.Get(DEFAULT) is None for at in attributes) else DEFAULT


def _shows(prim: Any) -> bool:
    return bool(
        prim.IsA(UsdGeom.Gprim)
        or prim.IsA(UsdGeom.Camera)
        or prim.IsA(UsdGeom.PointInstancer)
        or prim.GetTypeName().endswith("Light")
    )
