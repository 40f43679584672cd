"""A stage as it was read: its rig, and what of the stage its nodes, skins and clips stand for."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from pxr import UsdSkel

from rigtri.formats.usd.composition.shared_instances import SharedInstances
from rigtri.formats.usd.composition.stage import quiet
from rigtri.formats.usd.composition.time_samples import time_samples
from rigtri.formats.usd.reading import mesh_reader
from rigtri.formats.usd.reading.animation_reader import Animation
from rigtri.formats.usd.reading.node_keys import kind, parts
from rigtri.formats.usd.reading.skeleton_reader import Skeleton
from rigtri.model.dataclass import dataclass
from rigtri.model.mesh import Mesh
from rigtri.model.rig import Rig
from rigtri.report import Notice


@dataclass(frozen=True, eq=False)
class Source:
    """What a writer compares with and takes values from.

    skeletons, animations: by path. one_state: see `reader.read_source`.
    """

    path: Path
    stage: Any
    rig: Rig
    skeletons: Mapping[str, Skeleton]
    animations: Mapping[str, Animation]
    warnings: list[Notice]
    bindings: mesh_reader.Bindings
    instances: SharedInstances
    one_state: bool

    @property
    def layer(self) -> Any:
        return self.stage.GetRootLayer()

    @cached_property
    def joints(self) -> Mapping[int, tuple[str, str]]:
        """The skeleton's path and the token of each joint that an animation can move, by node."""
        skins = [skin for skin in self.rig.skins if kind(skin.key) in ("skeleton", "library")]
        return {
            node: (path, token)
            for path, skin in ((parts(skin.key)[1], skin) for skin in skins)
            for node, token in zip(skin.joints.tolist(), self.skeletons[path].tokens, strict=True)
        }

    @cached_property
    def joint_nodes(self) -> Mapping[str, Mapping[str, int]]:
        """The nodes of `joints`, by the skeleton's path and their tokens."""
        found: dict[str, dict[str, int]] = {path: {} for path in self.skeletons}
        for node, (path, token) in self.joints.items():
            found[path][token] = node
        return found

    @cached_property
    def labelled(self) -> Mapping[str, int]:
        """Nodes by their labels."""
        return {label: node for node, label in enumerate(self.rig.labels)}


def animations_of_instances(
    instances: SharedInstances, skeletons: Mapping[str, Skeleton], nodes: Mapping[str, int]
) -> Iterator[tuple[int, str, Skeleton, str]]:
    """What the instances of one character play: node, the skeleton's path below it, skeleton, animation.

    An instance with no node at or above it counts at the one that is read in its place. Animations are paths
    as they are read; "" for none. nodes: by label.
    """
    for path, skeleton in skeletons.items():
        prims = instances.skeletons.get(path, ())
        for prim in prims if len(prims) > 1 else ():
            played = UsdSkel.BindingAPI(prim).GetInheritedAnimationSource()
            known = str(instances.stands_for(played.GetPath())) if played else ""
            above = next((at for at in prim.GetPath().GetAncestorsRange() if str(at) in nodes), None)
            shown = prim.GetPath() if above is None else prim.GetPath().MakeRelativePath(above)
            node = nodes[path if above is None else str(above)]
            yield node, str(shown), skeleton, known if known in skeleton.animations else ""


def played_by_instances(source: Source) -> dict[int, dict[str, str]]:
    """Which animations instances of one character play, by their nodes.

    Numbers in the order of the first that plays each, because an edit may give an animation another name.
    """
    found: dict[int, dict[str, str]] = {}
    for node, shown, skeleton, played in animations_of_instances(
        source.instances, source.skeletons, source.labelled
    ):
        number = skeleton.animations.index(played) + 1 if played else 0
        found.setdefault(node, {})[f"animation of '{shown}'"] = str(number)
    return found


def blocked_times(stage: Any, animation: Animation) -> dict[str, tuple[float, ...]]:
    """When arrays of an animation are blocked, by their names; without those that never are."""
    found = {name: item.blocked for name, item in animation.properties.items()}
    weights = stage.GetPrimAtPath(animation.path).GetAttribute("blendShapeWeights")
    if weights:
        found["blendShapeWeights"] = tuple(t for t, value in time_samples(weights) if value is None)
    return {name: times for name, times in found.items() if times}


def blocked_samples(source: Source) -> dict[str, tuple[float, ...]]:
    """When arrays of the animations that play are blocked, by their paths."""
    return {
        f"<{path}>.{name}": times
        for path, animation in source.animations.items()
        for name, times in blocked_times(source.stage, animation).items()
    }


def read_meshes(source: Source, notices: list[Notice]) -> list[Mesh]:
    """The meshes of a source; those that cannot be measured are noticed."""
    rig = source.rig
    nodes = {label: node for node, label in enumerate(rig.labels) if kind(rig.keys[node]) == "prim"}
    skins = {parts(skin.key)[1]: k for k, skin in enumerate(rig.skins) if kind(skin.key) == "skeleton"}
    tokens = {path: skeleton.tokens for path, skeleton in source.skeletons.items()}
    with quiet(f"{source.path}: USD cannot read its meshes"):
        playing = {
            path: source.stage.GetPrimAtPath(skeleton.animations[0])
            for path, skeleton in source.skeletons.items()
            if skeleton.animations
        }
        prims = source.instances.prims()
        found = mesh_reader.read_meshes(prims, source.bindings.every, nodes, skins, tokens, playing)
    for mesh in found:
        if mesh.skin is not None and not np.isfinite(mesh.weights).all():
            text = f"mesh '{mesh.name}' has weights that are not numbers; how it looks was not measured"
            if (notice := Notice("mesh-unread", text)) not in notices:
                notices.append(notice)
    return found
