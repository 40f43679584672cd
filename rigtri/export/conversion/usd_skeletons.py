"""Which nodes of a glTF become joints of which Skeleton, and the bind poses that hold all of its skins.

A prim cannot stand below a joint, and a SkelAnimation moves joints alone. So what stands below a joint is a
joint too, and so is what a clip moves above one: each clip then is whole by itself.

Source: UsdSkel schemas (bindTransforms in world space at bind time, restTransforms joint-local).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from rigtri.export.conversion.scene import Scene
from rigtri.maths.matrices import determinant, from_frame, inverse, multiply
from rigtri.maths.trigonometry import Floats, cube_root
from rigtri.maths.vectors import length
from rigtri.model.rig import Rig

# Bind matrices of two skins are the same within this share: float32 files hold them with as much noise.
SAME_BIND = 1e-6
# A bind pose this share larger than its joints has their scale: nobody sees the difference.
SAME_SCALE = 1e-4


@dataclass(eq=False)
class Skeleton:
    """One Skeleton prim to be. parent: the node of the prim that it stands below, −1 for the root.

    joints: nodes, parents first; none where a mesh with morph targets alone asks for it, with itself as the
    one joint. bind: world matrices by node. skins: for each skin by number, the matrix that takes the points
    of its meshes into the bind pose. path, tokens: once they have names.
    """

    parent: int
    joints: list[int]
    name: str
    bind: dict[int, Floats] = field(default_factory=dict)
    skins: dict[int, Floats] = field(default_factory=dict)
    morphed: int = -1
    path: str = ""
    tokens: list[str] = field(default_factory=list)

    @cached_property
    def row(self) -> dict[int, int]:
        """The rows of joints by node."""
        return {joint: row for row, joint in enumerate(self.joints)}

    def add(self, skin: int, joints: list[int], inverse_bind: Floats) -> bool:
        """Take a skin up; False where it has another bind pose."""
        binds = inverse(inverse_bind)
        shared = [k for k, joint in enumerate(joints) if joint in self.bind]
        before = multiply(inverse_bind[shared[0]], self.bind[joints[shared[0]]]) if shared else np.eye(4)
        for k in shared:
            known = self.bind[joints[k]]
            off = np.abs(multiply(binds[k], before) - known).max()
            if not off <= SAME_BIND * np.abs(known).max():
                return False
        for k, joint in enumerate(joints):
            self.bind.setdefault(joint, multiply(binds[k], before))
        self.skins[skin] = before
        return True

    def unscale(self, rig: Rig, above: Floats) -> None:
        """Leave the scale that all bind poses have and joints do not to what takes points there.

        above: the matrix of the node above the joints. Programs that make bones of bind poses, such as
        Blender, give them no scale.
        """
        joints = list(self.bind)
        axes = length(above[:3, :3])
        # The length of axes below an uneven scale depends on where they point, and their volume does not.
        size = _size if axes.max() - axes.min() <= SAME_SCALE * axes.max() else _cubic_size
        binds, worlds = np.stack(list(self.bind.values())), rig.normalised_world[joints]
        with np.errstate(divide="ignore", invalid="ignore"):
            scales = size(binds) / (size(worlds) / size(above))
        scales = scales[np.isfinite(scales) & (scales > 0)]
        if len(scales):
            common = float(np.median(scales))
            self.bind = {joint: _smaller(bind, common) for joint, bind in self.bind.items()}
            self.skins = {skin: _smaller(before, common) for skin, before in self.skins.items()}


def _size(matrices: Floats) -> Floats:
    """The mean length of the axes, (..., 4, 4) → (...)."""
    x, y, z = np.moveaxis(length(matrices[..., :3, :3]), -1, 0)
    return np.asarray((x + y + z) / 3.0)


def _cubic_size(matrices: Floats) -> Floats:
    """The edge of the cube that has the volume of the axes, (..., 4, 4) → (...)."""
    return cube_root(np.abs(determinant(matrices)))


def _smaller(matrix: Floats, scale: float) -> Floats:
    """What a matrix takes to, so many times smaller; the same where that is noise."""
    if not scale or abs(scale - 1.0) <= SAME_SCALE:
        return matrix
    return multiply(matrix, from_frame(np.eye(3) / scale, np.zeros(3)))


def plan_skeletons(scene: Scene, rig: Rig, joints: set[int]) -> list[Skeleton]:
    """All Skeletons of a scene with its rig, or that with other scales. joints: `joints_of` it."""
    groups = _groups(rig, joints)
    skeletons: list[Skeleton] = []
    for parent, nodes, skins in groups:
        mine: list[Skeleton] = []
        for skin in skins or [-1]:
            if skin < 0:
                mine.append(Skeleton(parent, nodes, "Skeleton"))
                continue
            found = rig.skins[skin]
            own = found.joints.tolist()
            if not any(known.add(skin, own, found.inverse_bind) for known in mine):
                fresh = Skeleton(parent, nodes, found.name or "Skeleton")
                fresh.add(skin, own, found.inverse_bind)
                mine.append(fresh)
        for skeleton in mine:
            place = rig.normalised_world[parent] if parent >= 0 else np.eye(4)
            above = float(_size(place))
            skeleton.unscale(rig, place)
            for node in nodes:
                world = _smaller(rig.normalised_world[node], above)
                flat = not np.isfinite(inverse(world)).all()
                skeleton.bind.setdefault(node, np.eye(4) if flat else world)
        skeletons += mine
    for node, primitives in scene.primitives.items():
        if (
            node not in joints
            and any(len(p.mesh.morphs) for p in primitives)
            and primitives[0].mesh.skin is None
        ):
            skeletons.append(Skeleton(node, [], "Morphs", morphed=node))
    return skeletons


def joints_of(scene: Scene) -> set[int]:
    """The nodes that become joints of Skeletons."""
    rig = scene.rig
    marked = set(np.flatnonzero(rig.is_joint).tolist()) | {j for s in rig.skins for j in s.joints.tolist()}
    moved = {track.node for clip in rig.clips for track in clip.tracks if track.path != "weights"}
    marked |= {node for node in rig.with_ancestors(marked) if node in moved}
    found: set[int] = set()
    while marked - found:
        inside = np.zeros(len(rig), dtype=bool)
        inside[list(marked)] = True
        found.update(set(np.flatnonzero(rig.at_or_below(inside)).tolist()) - scene.omitted)
        # All roots of a Skeleton stand below one node; what is between that and them is a joint.
        for tops in _trees(rig, found):
            above = _above(rig, tops)
            for top in tops:
                parent = int(rig.parents[top])
                while parent != above and parent >= 0:
                    marked.add(parent)
                    parent = int(rig.parents[parent])
        marked |= found
        if marked == found:
            break
    return found


def _tops(rig: Rig, joints: set[int]) -> dict[int, int]:
    """The joint that each of ``joints`` is or stands below with only joints between; parents first."""
    parents, tops = rig.parents.tolist(), dict[int, int]()
    for node in sorted(joints):
        tops[node] = tops.get(parents[node], node)
    return tops


def _above(rig: Rig, nodes: Iterable[int]) -> int:
    """The lowest node that all nodes stand below; −1 where there is none."""
    parents = rig.parents.tolist()
    places = {parents[node] for node in nodes}
    above: int = min(places)
    for place in places:
        while above >= 0 and not rig.is_below(place, above):
            above = parents[above]
    return above


def _trees(rig: Rig, joints: set[int]) -> dict[tuple[int, ...], list[int]]:
    """The joints of trees by their roots, as one where a skin has joints of both."""
    owner: dict[int, int] = {}

    def root(node: int) -> int:
        while owner.setdefault(node, node) != node:
            node = owner[node]
        return node

    top = _tops(rig, joints)
    for skin in rig.skins:
        tops = [root(top[joint]) for joint in skin.joints.tolist()]
        for other in tops[1:]:
            owner[root(other)] = root(tops[0])
    members: dict[int, list[int]] = {}
    for node in top:
        members.setdefault(root(top[node]), []).append(node)
    return {tuple(dict.fromkeys(top[node] for node in nodes)): nodes for nodes in members.values()}


def _groups(rig: Rig, joints: set[int]) -> list[tuple[int, list[int], list[int]]]:
    """For each of `_trees` the node above it, its joints, and its skins."""
    trees = _trees(rig, joints)
    tree_of = {node: number for number, nodes in enumerate(trees.values()) for node in nodes}
    skins: list[list[int]] = [[] for _ in trees]
    for number, skin in enumerate(rig.skins):
        skins[tree_of[int(skin.joints[0])]].append(number)
    return [(_above(rig, tops), nodes, own) for (tops, nodes), own in zip(trees.items(), skins, strict=True)]
