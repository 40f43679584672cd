"""A rig: joints and everything bound to them, as immutable arrays. It knows no file.

Nodes come parents first, so that one pass from front to back visits every
parent before its children and a cycle is impossible. ``n`` is the number of
nodes; matrices are row-vector matrices (`rigtri.maths.matrices`).
"""

from __future__ import annotations

import re
from collections.abc import Collection, Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fnmatch import fnmatchcase
from functools import cached_property
from typing import Any

import numpy as np

from rigtri.errors import AmbiguousNameError, NameNotFoundError
from rigtri.maths.arrays import Booleans, Integers
from rigtri.maths.matrices import compose, multiply
from rigtri.maths.quaternions import normalise
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Track
from rigtri.model.bindings import Bound, NodeConstraint
from rigtri.model.content import Content, RigSource
from rigtri.model.format_rules import FormatRules
from rigtri.model.mesh import Mesh
from rigtri.model.pending_edits import PendingEdits
from rigtri.model.skin import Skin

# A node with more nodes above it has its label for a path: the paths of a chain of n nodes
# would need n² characters.
DEEPEST_PATH = 256
# Notes on nodes that are there only because rigtri has added them.
ADDED = (
    "constraint",
    "control",
    "group",
    "limb",
    "offset",
    "poleVector",
    "poseReader",
    "poseWeight",
    "rivet",
    "twist",
)
# The version of the description of notes that is read and written, and the types that it has.
VERSION, KNOWN = 1, (*ADDED, "frame")
# The child that shows the lines of a control in formats that keep what is drawn apart.
_DRAWING = "shape"
# What the script of export-blender puts below an IK end, as Blender numbers its names.
SWITCH = re.compile(r"rigtri_ik([._]\d+)?")


def illegible(note: Mapping[str, Any]) -> str:
    """Why this version cannot read a note, which stays as it is then; "" where it can."""
    if note.get("v") != VERSION:
        return f"its version is {note.get('v')!r}, and this rigtri reads {VERSION}"
    return "" if note.get("type") in KNOWN else f"its type {note.get('type')!r} is not known to this rigtri"


@dataclass(frozen=True, eq=False)
class Rig:
    """Nodes, their rest pose as stored, and all that is bound to them.

    names: "" where a node has none. parents: (n,), −1 for a root, each smaller
    than its own index. translation (n, 3), rotation xyzw (n, 4), scale (n, 3):
    the rest pose as stored, signs and unnormalised quaternions included; a node
    with ``has_matrix`` keeps its rest in ``matrix`` (n, 4, 4) instead.
    payload: (n,), the node whose mesh, camera or light a node shows, −1 for none.
    keys: what only the format understands; None for a node that is new. labels: ``#index`` in the file.
    bound: vectors that the format keeps in the frame of a node. humanoid: VRM bone names.
    notes: what rigtri has stored on a node. rules: what the format prescribes. pending: what is to be done
    to the file when the rig is written. content: what the file draws, read when needed.
    source: the file, of a rig that `rigtri.read` gave.
    """

    names: tuple[str, ...]
    parents: Integers
    translation: Floats
    rotation: Floats
    scale: Floats
    matrix: Floats
    has_matrix: Booleans
    payload: Integers
    keys: tuple[Hashable, ...]
    labels: tuple[str, ...]
    skins: tuple[Skin, ...] = ()
    clips: tuple[Clip, ...] = ()
    bound: tuple[Bound, ...] = ()
    constraints: tuple[NodeConstraint, ...] = ()
    humanoid: Mapping[str, int] = field(default_factory=dict)
    notes: Mapping[int, Mapping[str, Any]] = field(default_factory=dict)
    rules: FormatRules = field(default_factory=FormatRules)
    pending: PendingEdits = field(default_factory=PendingEdits)
    content: Content = field(default_factory=Content)
    source: RigSource | None = None

    def __len__(self) -> int:
        return len(self.names)

    @property
    def meshes(self) -> Sequence[Mesh]:
        """All that is drawn and can be read; none for a rig that no file was read for."""
        return self.content.meshes

    @cached_property
    def local(self) -> Floats:
        """Rest matrices seen from the parents, (n, 4, 4); shared, so not to be changed."""
        return self._locals(self.rotation)

    @cached_property
    def world(self) -> Floats:
        """Rest matrices seen from the world, (n, 4, 4); shared, so not to be changed."""
        return self._worlds(self.local)

    @cached_property
    def shown(self) -> Floats:
        """`local` with rotations as they are meant, unit, (n, 4, 4); shared, so not to be changed."""
        return self._locals(normalise(self.rotation))

    @cached_property
    def shown_world(self) -> Floats:
        """`normalise` seen from the world, (n, 4, 4); shared, so not to be changed."""
        return self._worlds(self.shown)

    def _worlds(self, local: Floats) -> Floats:
        world = local.copy()
        for level in self.levels[1:]:
            world[level] = multiply(local[level], world[self.parents[level]])
        world.flags.writeable = False
        return world

    def _locals(self, rotation: Floats) -> Floats:
        composed = compose(self.translation, rotation, self.scale)
        found = np.where(self.has_matrix[:, np.newaxis, np.newaxis], self.matrix, composed)
        found.flags.writeable = False
        return found

    @cached_property
    def posed(self) -> dict[Skin, Floats]:
        """The bind poses that `rigtri.evaluation.sampling.bind_worlds` has found."""
        return {}

    @cached_property
    def levels(self) -> tuple[Integers, ...]:
        """Node indices by depth, roots first: each level's parents lie in the level before."""
        levels: list[list[int]] = [[] for _ in range(max(self.depth, default=-1) + 1)]
        for node, depth in enumerate(self.depth):
            levels[depth].append(node)
        return tuple(np.array(level, dtype=np.int64) for level in levels)

    @cached_property
    def depth(self) -> list[int]:
        """How many nodes are above each node."""
        depth: list[int] = []
        for parent in self.parents.tolist():
            depth.append(depth[parent] + 1 if parent >= 0 else 0)
        return depth

    @cached_property
    def children(self) -> tuple[tuple[int, ...], ...]:
        """The children of every node, in the file's order."""
        lists: list[list[int]] = [[] for _ in range(len(self))]
        for node, parent in enumerate(self.parents.tolist()):
            if parent >= 0:
                lists[parent].append(node)
        return tuple(map(tuple, lists))

    @cached_property
    def is_joint(self) -> Booleans:
        """Which nodes are joints of a skin, (n,); one that only holds another's axes is not one more."""
        mask = np.zeros(len(self), dtype=bool)
        for skin in self.skins:
            mask[skin.joints] = True
        mask[list(self.holders)] = False
        return mask

    @cached_property
    def own(self) -> frozenset[int]:
        """Nodes that rigtri has added, with what shows the lines of controls and holds joints of ours."""
        made = {node for node, note in self.notes.items() if note.get("type") in ADDED}
        drawings = (
            child
            for node in made
            for child in self.children[node]
            if self.names[child] == _DRAWING and self.payload[child] == child and not self.children[child]
        )
        # A skeleton that holds none but joints of ours is a prim between them and the group.
        between = (
            child
            for node in made
            for child in self.children[node]
            if self.payload[child] < 0 and made.issuperset(self.children[child] or (-1,))
        )
        # What the script of export-blender puts below IK ends.
        switches = (
            child
            for node in made
            for child in self.children[node]
            if SWITCH.fullmatch(self.names[child]) and self.payload[child] < 0 and not self.children[child]
        )
        return frozenset(made.union(drawings, between, switches))

    def below(self, node: int) -> list[int]:
        """A node and everything under it, parents first."""
        inside = [node]
        for k in inside:  # it grows as it is walked
            inside += self.children[k]
        return sorted(inside)

    def is_below(self, node: int, other: int) -> bool:
        """Whether ``node`` is ``other`` or anywhere under it."""
        first, count = self._walk
        return first[other] <= first[node] < first[other] + count[other]

    @cached_property
    def _walk(self) -> tuple[list[int], list[int]]:
        """Where each node comes in a walk branch by branch, and how many nodes its branch has."""
        parents = self.parents.tolist()
        count = [1] * len(self)
        for node in range(len(self) - 1, -1, -1):
            if parents[node] >= 0:
                count[parents[node]] += count[node]
        first, free, after = [0] * len(self), [0] * len(self), 0
        for node, parent in enumerate(parents):
            first[node] = free[parent] if parent >= 0 else after
            free[node] = first[node] + 1
            if parent >= 0:
                free[parent] += count[node]
            else:
                after += count[node]
        return first, count

    def path(self, node: int) -> str:
        """The names from the root down to a node, ``/root/hips/spine``; ``#index`` for a nameless one.

        The label alone for a node deeper than `DEEPEST_PATH`. A node that holds the axes of a joint
        is no step on the way to what is below it, so that paths stay what they were before the
        joint was split.
        """
        return self._path(node, self.holders)

    def _path(self, node: int, without: Collection[int] = ()) -> str:
        if self.depth[node] > DEEPEST_PATH:
            return self.labels[node]
        parts = [self.names[node] or self.labels[node]]
        above = int(self.parents[node])
        while above >= 0:
            if above not in without:
                parts.append(self.names[above] or self.labels[above])
            above = int(self.parents[above])
        return "/" + "/".join(reversed(parts))

    def address(self, node: int) -> str:
        """What finds a node again, in this file and in others like it: name, path or label.

        The first of the three that no other node shares.
        """
        name = self.names[node]
        if name and len(self._by_name[name]) == 1:
            return name
        path = self.path(node)
        return path if len(self._by_address[path]) == 1 else self.labels[node]

    def title(self, node: int) -> str:
        """What to call a node in a message: its name, with its label where several share it."""
        name = self.names[node]
        if not name:
            return self.labels[node]
        return f"{name} ({self.labels[node]})" if len(self._by_name[name]) > 1 else name

    @cached_property
    def _by_name(self) -> dict[str, list[int]]:
        found: dict[str, list[int]] = {}
        for node, name in enumerate(self.names):
            found.setdefault(name, []).append(node)
        return found

    @cached_property
    def _by_address(self) -> dict[str, list[int]]:
        found: dict[str, list[int]] = {}
        for node, label in enumerate(self.labels):
            whole = {self._path(node): None} if self.holders else {}
            for way in {label: None, self.path(node): None, **whole}:
                found.setdefault(way, []).append(node)
        for bone, node in self.humanoid.items():
            found.setdefault(f"vrm:{bone}", []).append(node)
        return found

    @property
    def _hints(self) -> list[str]:
        """What nodes may be called, without the labels of those that no file has yet."""
        return [*self._by_name, *(way for way in self._by_address if not way.startswith("+"))]

    def find(self, name: str, kind: str = "joint") -> int:
        """The one node called ``name``: its name, its label (``#3``), its path, or ``vrm:head``.

        Raises NameNotFoundError, or AmbiguousNameError where several share the name.
        """
        found = self._by_name.get(name, []) if name else []
        if len(found) > 1:
            # A joint wins over a mesh node of the same name; nothing else is guessed.
            joints = [node for node in found if self.is_joint[node]]
            found = joints if len(joints) == 1 else found
        found = found or self._by_address.get(name, [])
        if not found:
            raise NameNotFoundError(kind, name, self._hints)
        if len(found) > 1:
            raise AmbiguousNameError(kind, name, [self.labels[node] for node in found])
        return found[0]

    def has(self, name: str) -> bool:
        """Whether any node is called so, by name, label, path or VRM bone."""
        return bool(name and (self._by_name.get(name) or self._by_address.get(name)))

    def known(self, name: object) -> int | None:
        """The one node called so, as `find` has it; None where there is none, or several, or no name."""
        if not isinstance(name, str):
            return None
        try:
            return self.find(name)
        except (NameNotFoundError, AmbiguousNameError):
            return None

    def match(self, pattern: str, among: Iterable[int] | None = None) -> list[int]:
        """All nodes that a glob such as ``*_L`` matches by name, label or path.

        An exact name wins over a pattern, so names with ``*`` or ``[`` in them can
        be given as they are. Raises NameNotFoundError when nothing matches.
        """
        exact = self._by_name.get(pattern) or self._by_address.get(pattern)
        nodes = range(len(self)) if among is None else among
        if exact:
            return sorted(exact)
        found = [
            node
            for node in nodes
            if any(
                fnmatchcase(text, pattern)
                for text in (self.names[node], self.labels[node], self.path(node))
                if text
            )
        ]
        if not found:
            raise NameNotFoundError("joint", pattern, self._hints, pattern=True)
        return found

    def part(self, nodes: Sequence[int]) -> tuple[Rig, dict[int, int]]:
        """Some nodes alone, parents first as here, with the tracks that drive them; and their new indices.

        Nodes whose parents are left out become roots. Skins, notes and the like stay behind:
        this is for posing a fraction of the whole.
        """
        keep = sorted(set(nodes))
        place = {old: new for new, old in enumerate(keep)}
        clips = tuple(
            replace(
                clip,
                tracks=tuple(replace(t, node=place[node]) for node in keep for t in by_node.get(node, ())),
            )
            for clip, by_node in zip(self.clips, self._tracks_of, strict=True)
        )
        small = Rig(
            names=tuple(self.names[node] for node in keep),
            parents=np.array([place.get(int(p), -1) for p in self.parents[keep]], dtype=np.int64),
            translation=self.translation[keep],
            rotation=self.rotation[keep],
            scale=self.scale[keep],
            matrix=self.matrix[keep],
            has_matrix=self.has_matrix[keep],
            payload=np.full(len(keep), -1),
            keys=tuple(self.keys[node] for node in keep),
            labels=tuple(self.labels[node] for node in keep),
            clips=clips,
        )
        return small, place

    @cached_property
    def _tracks_of(self) -> list[dict[int, list[Track]]]:
        """The tracks of each clip by the node that they drive."""
        found: list[dict[int, list[Track]]] = []
        for clip in self.clips:
            by_node: dict[int, list[Track]] = {}
            for track in clip.tracks:
                by_node.setdefault(track.node, []).append(track)
            found.append(by_node)
        return found

    def clip(self, name: str) -> Clip:
        """The clip called ``name`` (or ``#index``). Raises NameNotFoundError."""
        for number, clip in enumerate(self.shown_clips):
            if name in (clip.name, f"#{number}") and clip in self.clips:  # or its joints stand still
                return clip
        raise NameNotFoundError("clip", name, [clip.name for clip in self.shown_clips])

    @property
    def shown_clips(self) -> tuple[Clip, ...]:
        """The clips that move anything, without what is idle in them."""
        return tuple(clip.played for clip in self.clips if not clip.idle or clip.played.tracks)

    @cached_property
    def frame_of(self) -> dict[int, int]:
        """Joints whose axes a node of their own above them holds (``type: frame`` with ``joint``)."""
        return {
            child: node
            for node, note in self.notes.items()
            if note.get("type") == "frame" and "joint" in note
            for child in self.children[node][:1]
        }

    @cached_property
    def holders(self) -> frozenset[int]:
        """The nodes that hold the axes of a joint below them."""
        return frozenset(self.frame_of.values())

    def insert_above(self, above: Mapping[int, str]) -> Rig:
        """This rig with new nodes (key None) between nodes and their parents, at the nodes' places.

        above: nodes, each with the name of the new one. It stands on the parent; what it is to
        hold is the caller's to say. Node k comes to k + the number of such nodes up to k, k
        included; its new one stands right before it.
        """
        places = np.array(sorted(above), dtype=np.int64)
        count, names = len(self), [above[node] for node in places.tolist()]
        new = count + np.arange(len(names))
        rest = np.zeros((len(names), 3)), np.tile([0.0, 0.0, 0.0, 1.0], (len(names), 1))
        grown = self.with_nodes(names, self.parents[places].tolist(), *rest)
        parents = grown.parents.copy()
        parents[places] = new
        return replace(grown, parents=parents).reordered(np.insert(np.arange(count), places, new).tolist())

    def reordered(self, order: Sequence[int]) -> Rig:
        """This rig with its nodes in another order: the k-th is what was ``order[k]``.

        Parents must still come first; rows of skins keep their order. A node may be left out that is no
        parent, no joint, and moved by no track.
        """
        old = np.asarray(order, dtype=np.int64)
        place = np.full(len(self), -1)
        place[old] = np.arange(len(old))
        new = place.tolist()

        def moved(nodes: Integers) -> Integers:
            return np.where(nodes >= 0, place[nodes], nodes)

        return replace(
            self,
            names=tuple(self.names[k] for k in order),
            parents=moved(self.parents[old]),
            translation=self.translation[old],
            rotation=self.rotation[old],
            scale=self.scale[old],
            matrix=self.matrix[old],
            has_matrix=self.has_matrix[old],
            payload=moved(self.payload[old]),
            keys=tuple(self.keys[k] for k in order),
            labels=tuple(self.labels[k] for k in order),
            skins=tuple(replace(skin, joints=place[skin.joints]) for skin in self.skins),
            clips=tuple(
                replace(clip, tracks=tuple(replace(t, node=new[t.node]) for t in clip.tracks))
                for clip in self.clips
            ),
            bound=tuple(replace(b, node=new[b.node]) for b in self.bound),
            constraints=tuple(replace(c, node=new[c.node], source=new[c.source]) for c in self.constraints),
            humanoid={bone: new[k] for bone, k in self.humanoid.items()},
            notes={new[k]: note for k, note in self.notes.items()},
            rules=self.rules.reordered(new),
            pending=self.pending.reordered(new),
            content=self.content.reordered(new),
        )

    def with_nodes(
        self,
        names: Sequence[str],
        parents: Sequence[int],
        translation: Floats,
        rotation: Floats,
        payload: Sequence[int] | None = None,
    ) -> Rig:
        """This rig with new nodes (scale 1) appended; their keys are None."""
        count = len(names)
        return replace(
            self,
            names=(*self.names, *names),
            parents=np.append(self.parents, np.asarray(parents, dtype=np.int64)),
            translation=np.concatenate([self.translation, translation]),
            rotation=np.concatenate([self.rotation, rotation]),
            scale=np.concatenate([self.scale, np.ones((count, 3))]),
            matrix=np.concatenate([self.matrix, np.broadcast_to(np.eye(4), (count, 4, 4))]),
            has_matrix=np.append(self.has_matrix, np.zeros(count, dtype=bool)),
            payload=np.append(self.payload, [-1] * count if payload is None else payload),
            keys=(*self.keys, *[None] * count),
            labels=(*self.labels, *(f"+{name}" for name in names)),
        )
