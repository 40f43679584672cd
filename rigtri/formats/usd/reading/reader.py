"""A USD stage as a rig: prims that have a place, the joints of skeletons, and what drives them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence, Set
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from rigtri.errors import FileError
from rigtri.formats.document import ReadOptions
from rigtri.formats.usd.composition.animation_binding import bound_animation
from rigtri.formats.usd.composition.shared_instances import SharedInstances
from rigtri.formats.usd.composition.stage import DEFAULT, quiet
from rigtri.formats.usd.reading import mesh_reader
from rigtri.formats.usd.reading.animation_reader import (
    PROPERTIES,
    Animation,
    clips,
    interpolation_of,
    read_animation,
)
from rigtri.formats.usd.reading.loose_animations import (
    BoundInVariants,
    decided,
    fitting,
    of_other_variants,
    stand_in,
)
from rigtri.formats.usd.reading.node_references import resolved
from rigtri.formats.usd.reading.nodes import Nodes
from rigtri.formats.usd.reading.sampled_xforms import notice_shear, sampled_tracks
from rigtri.formats.usd.reading.skeleton_reader import (
    Skeleton,
    outside_of_scene,
    read_skeleton,
)
from rigtri.formats.usd.reading.source import Source, animations_of_instances, blocked_times
from rigtri.formats.usd.reading.xform_hierarchy import XFORMS, read_transform, rooted, xform_tracks
from rigtri.maths.matrices import inverse
from rigtri.maths.quaternions import from_axes, to_axes
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Track
from rigtri.model.animation import Path as PathName
from rigtri.model.format_rules import Resting
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin
from rigtri.report import Notice
from rigtri.text import and_more


def read_source(
    path: Path,
    options: ReadOptions,
    stage: Any,
    warnings: Sequence[Notice] = (),
    *,
    one_state: bool = False,
    twins: Mapping[Any, Any] | None = None,
    loose: Set[str] | None = None,
) -> Source:
    """Read the rig of a file. FileError where UsdSkel's rules are broken or there is no skeleton.

    warnings: what was noticed when the stage was opened. one_state: variants that are not selected are read
    by themselves. twins: instances of another stage, see `SharedInstances`. loose: the animations
    that count where no skeleton plays them, by path; None for all.
    """
    with quiet(f"{path}: USD cannot read it"):
        shared = SharedInstances(stage, twins)
        return _Reader(path, stage, options, list(warnings), shared, one_state=one_state, loose=loose).read()


# What is said of animations that no skeleton plays.
_IDLE = (
    "No skeleton plays {}{}. Names, axes, rest and size of joints change in them, too; new motion, such as "
    "that of controls, they do not get."
)
_OF_NONE = (
    "No skeleton uses {}{}: left as they were{}. What joints or controls get they do not, axes or motion. To "
    "edit one along, bind a skeleton to it (skel:animationSource) and run again from the source."
)
_OF_VARIANTS = (
    "Variants that are not selected have {}, which no skeleton uses there: left as they were. To edit one "
    "along, bind a skeleton to it in its variant (skel:animationSource) and run again from the source."
)


class _Reader:
    """One pass over a stage."""

    def __init__(
        self,
        path: Path,
        stage: Any,
        options: ReadOptions,
        warnings: list[Notice],
        instances: SharedInstances,
        *,
        one_state: bool,
        loose: Set[str] | None,
    ) -> None:
        self.path, self.stage, self.options, self.warnings = path, stage, options, warnings
        self.one_state, self.loose = one_state, loose
        self.instances = instances
        self.nodes = Nodes(stage, self.instances, self.warnings)
        self.skeletons: dict[str, Skeleton] = {}
        self.animations: dict[str, Animation] = {}
        self.bindings = mesh_reader.Bindings(self.instances)
        self.interpolation = interpolation_of(stage)

    def read(self) -> Source:
        prims = self.nodes.add_prims()
        self._skeletons(prims)
        self._animations(prims)
        if not self.skeletons and self.options.root is None:
            self._library(prims)
        if not self.skeletons and self.options.root is None and not self.options.empty:
            raise FileError(f"{self.path}: there is no skeleton in it{self._excuse()}{self._remedy()}")
        rig = self.nodes.rig()
        skins = tuple(self._skin(skeleton) for skeleton in self.skeletons.values())
        rig = _mirrored_as_keyed(replace(rig, clips=tuple(self._clips()), skins=skins))
        rig = resolved(rig, self.stage)
        if self.options.root is not None:
            rig = rooted(rig, self.stage, self.options.root, self.interpolation, self.warnings)
        rules = replace(
            rig.rules,
            group_parent=self._group_parent(rig),
            group_name="rigtri",
            resting=self._resting(rig.clips),
            per_second=float(self.stage.GetTimeCodesPerSecond()),
            played=self._played(),
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
            self.instances,
            self.one_state,
        )

    def _played(self) -> dict[int, dict[str, Any]]:
        found: dict[int, dict[str, Any]] = {}
        nodes = self.nodes.node_of
        for node, at, _, path in animations_of_instances(self.instances, self.skeletons, nodes):
            found.setdefault(node, {})[at] = ("samples", path) if path else None
        return found

    def _with_moving_prims(self, rig: Rig) -> Rig:
        """The rig with what moves its prims, to be measured; joints of --root have their own tracks."""
        joints = set() if self.options.root is None else set(rig.skins[-1].joints.tolist())
        prims = {node: prim for node, prim in self.nodes.animated.items() if node not in joints}
        held = self._tracks_of_ops(rig, prims)
        others = {node: prim for node, prim in prims.items() if node not in held}
        skeletons = map(self.nodes.node_of.__getitem__, self.skeletons)
        tracks = xform_tracks(rig, skeletons, others, self.interpolation, self.warnings)
        tracks += [track for node in held for track in held[node]]
        if not tracks:
            return rig
        clips = tuple(clip for clip in rig.clips if clip.key != XFORMS.key)
        known = [track for clip in rig.clips if clip.key == XFORMS.key for track in clip.tracks]
        return replace(rig, clips=(*clips, replace(XFORMS, tracks=(*known, *tracks))))

    def _tracks_of_ops(self, rig: Rig, prims: Mapping[int, Any]) -> dict[int, list[Track]]:
        """The keys of prims as they are in their ops, where tracks hold these; what is mirrored goes by its
        matrices. So what rigtri has built reads the same where an exporter has dropped its metadata."""
        found: dict[int, list[Track]] = {}
        own = set(self.nodes.own)
        for node, prim in prims.items():
            made_otherwise = node in own and bool(rig.has_matrix[node])
            if not made_otherwise and (rig.scale[node] <= 0).any():
                continue
            stand = None if made_otherwise else read_transform(prim, node, self.interpolation)
            if stand is not None:
                found[node] = stand[1]
            elif node in own and (tracks := sampled_tracks(prim, node, self.interpolation)) is not None:
                found[node] = tracks
                notice_shear(prim, tracks, self.interpolation, self.warnings)
        return found

    def _group_parent(self, rig: Rig) -> int:
        """The top-level prim that holds the first skeleton, where our Scope can stand below it."""
        about = list(self.skeletons) or [
            str(skin.key[1]) for skin in rig.skins if isinstance(skin.key, tuple)
        ]
        top = "/" + about[0].split("/")[1] if about else ""
        prim = self.stage.GetPrimAtPath(top) if top else None
        return self.nodes.node_of.get(top, -1) if prim and not prim.IsInstance() else -1

    def _excuse(self) -> str:
        codes = ("unresolved", "animation-ignored")
        missing = [notice.text for notice in self.warnings if notice.code in codes]
        return f" ({missing[0].rstrip('.')})" if missing else ""

    def _remedy(self) -> str:
        """What to do where there is no skeleton; nothing where there is nothing that could be one."""
        if outside := outside_of_scene(self.stage):
            return f". {outside}"
        if not self.nodes.labels:
            return ", nor any prim that has a place"
        if self.options.beside:
            return ". Of plain Xform prims keys alone can be taken: take-clips RIG --from EDITED --root PRIM"
        text = "If its joints are plain Xform prims, name the topmost with --root, e.g. --root"
        return f". {text} {self.nodes.labels[0]}"

    def _skeletons(self, others: list[Any]) -> None:
        prims = [prim for prim in others if prim.GetTypeName() == "Skeleton"]
        if not prims:
            return
        world = self.nodes.rig().world
        for prim in prims:
            path = str(prim.GetPath())
            animations = self._animations_of(path)
            place, bound = world[self.nodes.node_of[path]], partial(self._bound, path, world)
            skeleton = read_skeleton(prim, animations, place, bound, self.warnings)
            if skeleton is not None:
                self.skeletons[path] = skeleton
        self.nodes.add_joints(self.skeletons.values())

    def _bound(self, skeleton: str, world: Floats) -> list[tuple[Floats, Floats]]:
        """Where each mesh of a skeleton is bound, and where it stands."""
        queries = [query for query in self.bindings.of({skeleton}) if query.HasJointInfluences()]
        owners = [self.nodes.owner(str(query.GetPrim().GetPath())) for query in queries]
        return [
            (np.array(query.GetGeomBindTransform(DEFAULT), dtype=np.float64), world[owner])
            for query, owner in zip(queries, owners, strict=True)
        ]

    def _animations_of(self, skeleton: str) -> list[Any]:
        """The SkelAnimation prims that drive a skeleton in any instance that it stands for."""
        prims, demanded = self.instances.skeletons[skeleton], not self.one_state
        bound = (bound_animation(prim, self.warnings, demanded=demanded) for prim in prims)
        paths = {self.instances.stands_for(prim.GetPath()): None for prim in bound if prim is not None}
        return [self.stage.GetPrimAtPath(path) for path in paths]

    def _library(self, others: list[Any]) -> None:
        """Animations without any skeleton, as skeletons of their own; only the animations are written."""
        world = self.nodes.rig().world
        for prim in (prim for prim in others if prim.GetTypeName() == "SkelAnimation"):
            path = str(prim.GetPath())
            animation = read_animation(prim, self.warnings)
            if animation is not None and animation.properties:
                owner = self.nodes.owner(path)
                place = world[owner] if owner >= 0 else np.eye(4)
                self.animations[path] = animation
                self.skeletons[path] = stand_in(prim, animation, place)
        if self.skeletons:
            shown = and_more([f"<{path}>" for path in self.skeletons], 3)
            text = (
                f"There is no skeleton; joints stand as {shown} poses them first, and their rest pose and "
                "what is above them are not known. Take the motion to the skeleton as it is now with "
                "take-clips, or give joints its new axes with orient-joints --save-frames and --frames."
            )
            self.warnings.append(Notice("no-skeleton", text))
            self.nodes.add_joints(self.skeletons.values())

    def _animations(self, others: list[Any]) -> None:
        bound = {path for skeleton in self.skeletons.values() for path in skeleton.animations}
        for path in sorted(bound):
            animation = read_animation(self.stage.GetPrimAtPath(path), self.warnings)
            if animation is not None:
                self.animations[path] = animation
        loose = [p for p in others if p.GetTypeName() == "SkelAnimation" and str(p.GetPath()) not in bound]
        if self.skeletons:
            self._unbound([p for p in loose if self.loose is None or str(p.GetPath()) in self.loose])

    def _unbound(self, prims: Sequence[Any]) -> None:
        """Read the animations that no skeleton plays with those whose joints they list."""
        joined: list[str] = []
        left: list[str] = []
        elsewhere = BoundInVariants(self.stage)
        known = {path: frozenset(skeleton.tokens) for path, skeleton in self.skeletons.items()}
        for prim in prims:
            path = str(prim.GetPath())
            try:
                animation = read_animation(prim, [])
            except FileError:  # nobody plays it
                animation = None
            tokens = animation.tokens if animation is not None else ()
            users = fitting(path, tokens, known)
            if not self.one_state and any(elsewhere.has(user, path) for user in users):
                continue  # it is edited with the Skeleton of the variant that binds it
            (joined if users else left).append(f"<{path}>")
            if users and animation is not None:
                self.animations[path] = replace(animation, idle=True)
            for user in users:
                skeleton = self.skeletons[user]
                varied = (path,) if not self.one_state and decided(self.stage, user, path) else ()
                self.skeletons[user] = replace(
                    skeleton, unbound=(*skeleton.unbound, path), decided=(*skeleton.decided, *varied)
                )
        known_paths = {str(prim.GetPath()) for prim in prims}
        if self.one_state:
            return
        others = of_other_variants(self.stage, self.instances, known_paths, known)
        shown = [f"<{path}> ({where})" for path, (where, users) in others.items() if not users]
        joined += [f"<{path}> ({where})" for path, (where, users) in others.items() if users]
        for path, (_, users) in others.items():
            for user in users:
                skeleton = self.skeletons[user]
                self.skeletons[user] = replace(skeleton, decided=(*skeleton.decided, path))
        is_varied = any(prim.HasVariantSets() for prim in self.instances.prims())
        there = (" in the selected variants", ", unless a skeleton of another variant uses them")
        where = there if is_varied else ("", "")
        for text, found in ((_IDLE, joined), (_OF_NONE, left), (_OF_VARIANTS, shown)):
            if found:
                self.warnings.append(Notice("unbound-animation", text.format(and_more(found, 3), *where)))

    def _resting(self, clips: Sequence[Clip]) -> dict[int, Resting]:
        """What animations have no value for at times, when UsdSkel shows rest poses and no blend shapes."""
        found: dict[int, Resting] = {}
        sampled = {clip.key: clip for clip in clips}
        for path, animation in self.animations.items():
            users = [s.path for s in self.skeletons.values() if path in s.animations]
            joints = [node for user in users for node in self.nodes.joint_nodes[user].values()]
            if animation.idle:
                why = f"UsdSkel does not play <{path}>, which has no {' and no '.join(animation.lacks)}"
                found = dict.fromkeys(joints if animation.lacks else (), Resting(why, {})) | found
                joints = []
            clip = sampled.get(("samples", path))
            meshes = [track.node for track in (clip.tracks if clip else ()) if track.path == "weights"]
            for user in users if meshes and not animation.idle else ():
                if not self.nodes.joint_nodes[user].keys() & set(animation.tokens):
                    why = f"UsdSkel plays the blend shapes of <{path}>, which has no values for its joints"
                    found |= dict.fromkeys(self.nodes.joint_nodes[user].values(), Resting(why, {}))
            blocked = blocked_times(self.stage, animation)
            weights = {"blendShapeWeights": blocked.pop("blendShapeWeights", ())}
            for nodes, arrays in ((joints, blocked), (meshes, weights)):
                for name, times in arrays.items():
                    why = f"<{path}>.{name} is blocked at {times[0]:g}" if times else ""
                    found |= dict.fromkeys(nodes if times else (), Resting(why, _by_path(arrays)))
        return found

    def _clips(self) -> list[Clip]:
        names = Counter(animation.name for animation in self.animations.values())
        found = []
        for path, animation in self.animations.items():
            users = [s.path for s in self.skeletons.values() if path in s.animations]
            name = animation.name if names[animation.name] == 1 else path
            prim, weights = self.stage.GetPrimAtPath(path), []
            if users and prim.IsActive() and prim.GetAttribute("blendShapeWeights").HasAuthoredValue():
                queries = self.bindings.of(users)
                weights = mesh_reader.blend_tracks(prim, queries, self.nodes.node_of, self.interpolation)
            listed = [s.path for s in self.skeletons.values() if path in s.every_animation]
            driven = [self.nodes.joint_nodes[user] for user in listed]
            found += clips(animation, name, driven, weights, self.interpolation)
        return found

    def _skin(self, skeleton: Skeleton) -> Skin:
        def weigh() -> np.ndarray:
            return mesh_reader.weighted(self.bindings.of({skeleton.path}), skeleton.tokens)

        nodes = self.nodes.joint_nodes[skeleton.path]
        real = skeleton.path not in self.animations
        return Skin(
            name=skeleton.path.rpartition("/")[2],
            joints=np.array([nodes[token] for token in skeleton.tokens], dtype=np.int64),
            inverse_bind=inverse(skeleton.bind),
            stored=real,
            weigh=weigh if real else None,
            key=("skeleton" if real else "library", skeleton.path),
        )


def _mirrored_as_keyed(rig: Rig) -> Rig:
    """The rig with joints mirrored at rest about the axes about which their keys mirror them.

    A matrix does not hold which; a pose may take the scale of a clip and the rotation of rest.
    """
    rotation, scale = rig.rotation.copy(), rig.scale.copy()
    scales = (track for clip in rig.clips for track in clip.tracks if track.path == "scale")
    done = set(np.flatnonzero(~rig.has_matrix).tolist())
    for track in scales:
        if (node := track.node) in done:
            continue
        keyed = np.where(track.values[0] < 0, -1.0, 1.0)
        flip = np.where(rig.scale[node] < 0, -1.0, 1.0) * keyed
        if flip.prod() > 0:
            done.add(node)
            rotation[node], scale[node] = rig.rotation[node], rig.scale[node] * flip
            if (flip < 0).any():
                rotation[node] = from_axes(to_axes(rig.rotation[node]) * flip[:, np.newaxis])
    return replace(rig, rotation=rotation, scale=scale)


def _by_path(arrays: Mapping[str, tuple[float, ...]]) -> dict[PathName, tuple[float, ...]]:
    """The blocked times of arrays by what they drive."""
    return {PROPERTIES.get(name, "weights"): times for name, times in arrays.items()}
