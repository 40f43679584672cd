"""A rig: joints and everything bound to them, as immutable arrays. It knows no file.

Nodes come parents first, so that one pass from front to back visits every
parent before its children and a cycle is impossible. ``n`` is the number of
nodes; matrices are row-vector matrices (`rigtri.maths.matrices`).
"""

from __future__ import annotations

import re
from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from dataclasses import field, replace
from functools import cached_property
from typing import Any, NoReturn, TypeVar

import numpy as np

from rigtri.errors import GeometryError, NameNotFoundError
from rigtri.maths.arrays import Booleans, Integers
from rigtri.maths.matrices import compose, decompose, identity, multiply
from rigtri.maths.quaternions import normalise
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Tracks
from rigtri.model.bindings import Bound, NodeConstraint
from rigtri.model.content import Content, RigSource
from rigtri.model.dataclass import dataclass
from rigtri.model.format_rules import FormatRules
from rigtri.model.mesh import Mesh
from rigtri.model.metadata import ADDED, RECORDS, Place, Record, references, with_references
from rigtri.model.node_names import NodeNames
from rigtri.model.pending_edits import PendingEdits
from rigtri.model.script_nodes import script_nodes
from rigtri.model.skin import Skin

R = TypeVar("R", bound=Record)
T = TypeVar("T")

# The child that shows the lines of a control in formats that keep what is drawn apart, and its name with the
# number that a DCC may have put behind it.
DRAWING = "shape"
DRAWN = re.compile(rf"{DRAWING}([._]\d{{3}})?$")
# Of its largest number: what float32 leaves of a matrix of translation, rotation and scale.
_EXACT = 1e-6


_MOST_PARSED = 10_000


class _Parsed(dict[int, tuple[Any, T]]):
    """What was made of stored metadata, which rigs made of one another share, by its id, with itself."""

    def of(self, stored: Any, make: Callable[[Any], T]) -> T:
        known = self.get(id(stored))
        if known is None or known[0] is not stored:
            if len(self) >= _MOST_PARSED:
                self.clear()
            known = self[id(stored)] = stored, make(stored)
        return known[1]


_parsed: _Parsed[Record] = _Parsed()
# The addresses in what is stored.
_references: _Parsed[list[str]] = _Parsed()


@dataclass(frozen=True, eq=False)
class Rig(NodeNames):
    """Nodes, their rest pose as stored, and all that is bound to them.

    names: "" where a node has none. parents: (n,), −1 for a root, each smaller
    than its own index. translation (n, 3), rotation xyzw (n, 4), scale (n, 3):
    the rest pose as stored, signs and unnormalised quaternions included; a node
    with ``has_matrix`` keeps its rest in ``matrix`` (n, 4, 4) instead.
    attachment: (n,), the node whose mesh, camera or light a node shows, −1 for none.
    keys: what only the format understands; None for a node that is new. labels: ``#index`` in the file.
    bound: vectors that the format keeps in the frame of a node. humanoid: VRM bone names.
    metadata: what rigtri has stored on a node. rules: what the format prescribes. pending: what is to be done
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
    attachment: Integers
    keys: tuple[Hashable, ...]
    labels: tuple[str, ...]
    skins: tuple[Skin, ...] = ()
    clips: tuple[Clip, ...] = ()
    bound: tuple[Bound, ...] = ()
    node_constraints: tuple[NodeConstraint, ...] = ()
    humanoid: Mapping[str, int] = field(default_factory=dict)
    metadata: Mapping[int, Mapping[str, Any]] = field(default_factory=dict)
    rules: FormatRules = field(default_factory=FormatRules)
    pending: PendingEdits = field(default_factory=PendingEdits)
    content: Content = field(default_factory=Content)
    source: RigSource | None = None

    def __repr__(self) -> str:
        joints = int(np.count_nonzero(self.is_joint))
        counts = {"node": len(self), "joint": joints, "skin": len(self.skins), "clip": len(self.clips)}
        words = (f"{count} {word}" + "s" * (count != 1) for word, count in counts.items())
        return f"<Rig: {', '.join(words)}>"

    def __copy__(self) -> Rig:
        return self

    def __deepcopy__(self, known: dict[int, Any]) -> Rig:
        """This rig: nothing can change it."""
        return self

    def __reduce__(self) -> NoReturn:
        """TypeError: what is bound to a rig is read from its file when needed."""
        raise TypeError("a Rig cannot be pickled: write it to a file, and read that in the other process")

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
    def normalised_local(self) -> Floats:
        """`local` with rotations made unit, (n, 4, 4); shared, so not to be changed."""
        return self._locals(normalise(self.rotation))

    @cached_property
    def normalised_world(self) -> Floats:
        """`normalised_local` seen from the world, (n, 4, 4); shared, so not to be changed."""
        return self._worlds(self.normalised_local)

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
    def bind_poses(self) -> dict[Skin, Floats]:
        """The bind poses that `rigtri.evaluation.bind_pose.bind_worlds` has found."""
        return {}

    @cached_property
    def is_joint(self) -> Booleans:
        """Which nodes are joints of a skin, (n,); one that only holds another's axes is not one more.

        Nor are controls of a skin that draws nothing: an armature of controls, as Blender exports it.
        """
        mask = np.zeros(len(self), dtype=bool)
        unseen = [skin for skin in self.skins if skin.drawn is False]
        for skin in unseen:
            mask[skin.joints] = True
        if unseen:
            mask[self.nodes_of("control", "offset", "poleVector")] = False
        for skin in self.skins:
            if skin.drawn is not False:
                mask[skin.joints] = True
        mask[list(self.holders)] = False
        return mask

    def type_of(self, node: int) -> str:
        """The type of what rigtri has stored on a node, e.g. ``control``; "" where there is nothing."""
        kind = self.metadata[node].get("type") if node in self.metadata else ""
        return kind if isinstance(kind, str) else ""

    def kind_of(self, node: int) -> str:
        """What a node is to a rigger: what rigtri has added it as, else ``joint`` or ``node``."""
        return self.type_of(node) or ("joint" if self.is_joint[node] else "node")

    def named_by(self, stored: Any) -> set[int]:
        """The nodes that stored metadata is about; of each address that there is one node for."""
        found = map(self.known, _references.of(stored, references))
        return {node for node in found if node is not None}

    def lost_by(self, record: Record) -> list[str]:
        """What a record is about that no one node is: the addresses of none, or of several, each once."""
        return [name for name in dict.fromkeys(references(record.to_dict())) if self.known(name) is None]

    def with_addresses(self) -> Rig:
        """This rig with metadata that call nodes by their `address`, as operations look them up.

        A name that was enough when it was stored has company in a file that was edited since.
        """

        return self._with_references_of(self, range(len(self)))

    def _with_references_of(self, before: Rig, place: Sequence[int]) -> Rig:
        """This rig with metadata that mean the nodes that they meant before; place: which those are now."""

        def address(_: Place, name: str) -> str:
            node = before.known(name)
            return name if node is None else self.address(place[node])

        found = {node: with_references(stored, address) for node, stored in self.metadata.items()}
        return replace(self, metadata=found) if found != self.metadata else self

    def shared(self, values: Floats) -> Floats:
        """Values of frames, (n, …), with one for all that share it: instances; a group and what it is in.

        A group of rigtri has no transform of its own in USD: what has one is none, whatever its metadata say.
        """
        found = self.rules.shared(values)
        at_parent = [node for node in self.nodes_of("group") if (self.local[node] == identity()).all()]
        if groups := [node for node in at_parent if self.parents[node] >= 0]:
            found = found.copy()
            found[groups] = found[self.parents[groups]]
        return found

    def nodes_of(self, *types: str) -> list[int]:
        """The nodes with metadata of these types."""
        return [node for node in self.metadata if self.type_of(node) in types]

    def record(self, node: int) -> Record | None:
        """What rigtri has stored on a node; None where there is nothing, or nothing that can be used."""
        kind = RECORDS.get(self.type_of(node))
        if kind is None:
            return None
        stored = self.metadata[node]
        record = _parsed.of(stored, kind.from_dict)
        return None if record.problems else record

    def records(self, kind: type[R]) -> dict[int, R]:
        """What is stored in records of one type, by node; without those that cannot be used."""
        if kind not in self._records:
            found = {node: self.record(node) for node in self.nodes_of(kind.type)}
            self._records[kind] = {node: one for node, one in found.items() if isinstance(one, kind)}
        return self._records[kind]

    @cached_property
    def _records(self) -> dict[type[Any], dict[int, Any]]:
        return {}

    @cached_property
    def own(self) -> frozenset[int]:
        """Nodes that rigtri has added, with what shows the lines of controls and holds joints of ours."""
        made = set(self.nodes_of(*ADDED))
        if not made:
            return frozenset()
        # A skeleton that holds none but joints of ours is a prim between them and the group.
        between = (
            child
            for node in made
            for child in self.children[node]
            if self.attachment[child] < 0 and made.issuperset(self.children[child] or (-1,))
        )
        # What the script of export-blender adds, as long as nobody has hung anything there.
        scripted = (
            node
            for node in script_nodes(self.names, self, made)
            if self.attachment[node] < 0 and not self.children[node]
        )
        return frozenset(made.union(self.drawings, between, scripted))

    @cached_property
    def drawings(self) -> frozenset[int]:
        """Nodes that show the lines of what rigtri has added, each below it: USD has them so.

        Blender puts each of them below a node of its own, which has the same name.
        """
        found, made = set[int](), self.nodes_of(*ADDED)
        for child in {child for node in made for child in self.children[node]}.difference(made):
            below = [child, *self.children[child]]
            shown = [node for node in below if self.attachment[node] == node]
            if len(below) < 3 and shown == below[-1:] and not self.children[below[-1]]:
                found.update(below if all(DRAWN.search(self.names[node]) for node in below) else ())
        return frozenset(found)

    @cached_property
    def showing(self) -> frozenset[int]:
        """Nodes of `own` that show what others have made: metadata was copied there, or a mesh given."""
        shown = np.flatnonzero(self.attachment == np.arange(len(self))).tolist()
        return self.own.intersection(shown) - self.drawings - self.rules.lines

    def subset(self, nodes: Sequence[int]) -> tuple[Rig, dict[int, int]]:
        """Some nodes alone, parents first as here, with the tracks that drive them; and their new indices.

        Nodes whose parents are left out become roots. Skins, metadata and the like stay behind:
        this is for posing a fraction of the whole.
        """
        keep = sorted(set(nodes))
        place = {old: new for new, old in enumerate(keep)}
        new = np.full(len(self), -1)
        new[keep] = np.arange(len(keep))
        clips = tuple(
            replace(clip, tracks=Tracks(filter(None, (column.moved(new) for column in clip.columns))))
            for clip in self.clips
        )
        small = Rig(
            names=tuple(self.names[node] for node in keep),
            parents=np.where(self.parents[keep] < 0, -1, new[self.parents[keep]]),
            translation=self.translation[keep],
            rotation=self.rotation[keep],
            scale=self.scale[keep],
            matrix=self.matrix[keep],
            has_matrix=self.has_matrix[keep],
            attachment=np.full(len(keep), -1),
            keys=tuple(self.keys[node] for node in keep),
            labels=tuple(self.labels[node] for node in keep),
            clips=clips,
        )
        return small, place

    def clip(self, name: str) -> Clip:
        """The clip called ``name`` (or ``#index``). Raises NameNotFoundError."""
        name = self.clip_name(name)
        for number, clip in enumerate(self.shown_clips):
            if name in (clip.name, f"#{number}") and clip in self.clips:  # or its joints stand still
                return clip
        raise NameNotFoundError("clip", name, self.clip_titles)

    def clip_name(self, name: str) -> str:
        """The name of the clip whose path ends so, where one alone that moves joints at hand does."""
        ends = [
            clip.name
            for clip in self.clips
            if clip.name[:1] == "/"
            and clip.name.endswith(f"/{name}")
            and any(self.is_joint[track.node] for track in clip.tracks)
        ]
        return ends[0] if len(ends) == 1 else name

    @property
    def clip_titles(self) -> list[str]:
        """What clips are called in a message; of a character that is edited alone its own, by the ends of
        their paths where `clip_name` knows them so."""
        shown = self.shown_clips
        if self.rules.others:
            shown = tuple(clip for clip in shown if any(self.is_joint[track.node] for track in clip.tracks))
        ends = {clip.name: clip.name.rpartition("/")[2] for clip in shown}
        return [end if self.clip_name(end) == name else name for name, end in ends.items()]

    @cached_property
    def shown_clips(self) -> tuple[Clip, ...]:
        """The clips that move anything, without what is idle in them."""
        return tuple(clip.without_idle for clip in self.clips if not clip.idle or clip.without_idle.tracks)

    @cached_property
    def frame_of(self) -> dict[int, int]:
        """Joints whose axes a node of their own above them holds (``type: frame`` with ``joint``)."""
        return {
            child: node
            for node, stored in self.metadata.items()
            if self.type_of(node) == "frame" and "joint" in stored
            for child in self.children[node][:1]
        }

    @cached_property
    def holders(self) -> frozenset[int]:
        """The nodes that hold the axes of a joint below them."""
        return frozenset(self.frame_of.values())

    @property
    def others(self) -> frozenset[int]:
        """Nodes that a name which several share does not mean."""
        return self.rules.others

    def with_parts(self, nodes: Iterable[int]) -> Rig:
        """This rig with translation, rotation and scale of nodes in place of their matrices.

        No clip of glTF can move a node with a matrix; a joint of USD has its parts beside its matrix.
        GeometryError for a matrix that is none of the three.
        """
        own = [node for node in nodes if self.has_matrix[node] and not self.rules.raw_quaternions]
        if not own:
            return self
        translation, rotation, scale = self.translation.copy(), self.rotation.copy(), self.scale.copy()
        has_matrix = self.has_matrix.copy()
        translation[own], rotation[own], scale[own] = decompose(self.matrix[own])
        again = compose(translation[own], rotation[own], scale[own])
        off = np.abs(again - self.matrix[own]).max(axis=(1, 2))
        for node, far, matrix in zip(own, off.tolist(), self.matrix[own], strict=True):
            if not far <= _EXACT * np.abs(matrix).max():
                raise GeometryError(
                    f"'{self.title(node)}' has a matrix that is sheared or flat: no clip can move it, and "
                    "translation, rotation and scale cannot replace it; export the file with these three"
                )
        has_matrix[own] = False
        return replace(self, translation=translation, rotation=rotation, scale=scale, has_matrix=has_matrix)

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
        order = np.insert(np.arange(count), places, new)
        moved = replace(grown, parents=parents).reordered(order.tolist())
        return moved._with_references_of(self, np.argsort(order)[:count].tolist())

    def with_parents(self, parents: Integers) -> Rig:
        """This rig with other parents, (n,), each before its children; metadata mean the same nodes."""
        return replace(self, parents=parents)._with_references_of(self, range(len(self)))

    def with_labels(self, labels: Sequence[str]) -> Rig:
        """This rig with other labels, of n nodes; metadata mean the same nodes."""
        return replace(self, labels=tuple(labels))._with_references_of(self, range(len(self)))

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
            attachment=moved(self.attachment[old]),
            keys=tuple(self.keys[k] for k in order),
            labels=tuple(self.labels[k] for k in order),
            skins=tuple(skin.renumbered(place) for skin in self.skins),
            clips=tuple(
                replace(clip, tracks=tuple(replace(t, node=new[t.node]) for t in clip.tracks))
                for clip in self.clips
            ),
            bound=tuple(replace(b, node=new[b.node]) for b in self.bound),
            node_constraints=tuple(
                replace(c, node=new[c.node], source=new[c.source]) for c in self.node_constraints
            ),
            humanoid={bone: new[k] for bone, k in self.humanoid.items()},
            metadata={new[k]: stored for k, stored in self.metadata.items()},
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
        attachment: Sequence[int] | None = None,
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
            attachment=np.append(self.attachment, [-1] * count if attachment is None else attachment),
            keys=(*self.keys, *[None] * count),
            labels=(*self.labels, *(f"+{name}" for name in names)),
        )
