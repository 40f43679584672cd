"""What the format of a rig's file prescribes for its nodes."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import field, replace

from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Path
from rigtri.model.dataclass import dataclass


@dataclass(frozen=True)
class Resting:
    """A node that shows its rest pose in the midst of a clip.

    why: what makes it. since: from when, for each path: until the next key of that.
    """

    why: str
    since: Mapping[Path, Sequence[float]]


@dataclass(frozen=True)
class FormatRules:
    """What may change in a file, and how it is to be read.

    fixed: nodes whose axes mean something in themselves, with the reason. orient_locked: why no joint
    of this file may have axes of its own, "" where they may; then ``world_aligned`` are the nodes that
    may be aligned with the world's axes, all of them together. data_nodes: nodes of ``fixed`` whose
    transform is data and places nothing, so that they are never joints. swinging: nodes that springs of the
    file swing about how they rest. split_locked: why no joint of
    this file may be split, "" where they may.
    facing: the direction the character looks in, where the format prescribes one. up: the scene's up axis.
    raw_quaternions: viewers of this format do not normalise rotations (UsdSkel). linear: it has no splines.
    group_parent: the parent of a group that rigtri adds, −1 where the group is a root; group_name: its name.
    named: nodes that extensions of the file refer to.
    unread_extensions: those of the file that are not known, which may hold something in the axes of joints.
    metres_per_unit: the length of the scene's unit. sized_binding: bind matrices are to have scale 1, and the
    points of a skin may be bound in another size instead.
    resting: nodes that show their rest pose in the midst of a clip. unread: nodes whose motion no track can
    hold, with the reason. unlisted: joints of clips without a skeleton whose parent no clip lists, and which
    that is: nothing says how it stands.
    instances: nodes that show what another shows, which is read there alone: by each of them, that one.
    played: what moves each of several instances of a character: the key of a clip, None for none, by the
    instance's node and the skeleton's path below that.
    skeletons: nodes whose joints have names of their own, which joints of others may have, too.
    elsewhere: nodes of rigtri, or with its metadata, that no edit of this file can take out, and which other
    file has them. overlaid: those of them, nodes of rigtri all, of which this file says more.
    rigid: nodes that show a mesh which a child of theirs could show instead, so that they may be joints.
    lines: nodes that show lines and nothing else, as controls do.
    others: nodes of other characters while one is edited: a name that several nodes share does not mean them.
    per_second: units of clips' time in a second. valid_name: a name as this format can have it; `str`: any.
    """

    fixed: Mapping[int, str] = field(default_factory=dict)
    orient_locked: str = ""
    world_aligned: frozenset[int] = frozenset()
    data_nodes: frozenset[int] = frozenset()
    swinging: frozenset[int] = frozenset()
    split_locked: str = ""
    facing: tuple[float, float, float] | None = None
    up: tuple[float, float, float] = (0.0, 1.0, 0.0)
    raw_quaternions: bool = False
    linear: bool = False
    group_parent: int = -1
    group_name: str = "rigtri_controls"
    named: frozenset[int] = frozenset()
    unread_extensions: tuple[str, ...] = ()
    metres_per_unit: float = 1.0
    sized_binding: bool = False
    per_second: float = 1.0
    resting: Mapping[int, Resting] = field(default_factory=dict)
    unread: Mapping[int, str] = field(default_factory=dict)
    unlisted: Mapping[int, str] = field(default_factory=dict)
    instances: Mapping[int, int] = field(default_factory=dict)
    played: Mapping[int, Mapping[str, Hashable]] = field(default_factory=dict)
    skeletons: frozenset[int] = frozenset()
    elsewhere: Mapping[int, str] = field(default_factory=dict)
    overlaid: frozenset[int] = frozenset()
    rigid: frozenset[int] = frozenset()
    lines: frozenset[int] = frozenset()
    others: frozenset[int] = frozenset()
    valid_name: Callable[[str], str] = str

    def reordered(self, new: Sequence[int]) -> FormatRules:
        """The rules with node k called ``new[k]``."""
        return replace(
            self,
            fixed={new[k]: reason for k, reason in self.fixed.items()},
            resting={new[k]: why for k, why in self.resting.items()},
            unread={new[k]: why for k, why in self.unread.items()},
            unlisted={new[k]: parent for k, parent in self.unlisted.items()},
            world_aligned=frozenset(new[k] for k in self.world_aligned),
            data_nodes=frozenset(new[k] for k in self.data_nodes),
            swinging=frozenset(new[k] for k in self.swinging),
            named=frozenset(new[k] for k in self.named),
            skeletons=frozenset(new[k] for k in self.skeletons),
            elsewhere={new[k]: name for k, name in self.elsewhere.items()},
            overlaid=frozenset(new[k] for k in self.overlaid),
            rigid=frozenset(new[k] for k in self.rigid),
            lines=frozenset(new[k] for k in self.lines),
            others=frozenset(new[k] for k in self.others),
            instances={new[k]: new[first] for k, first in self.instances.items()},
            played={new[k]: played for k, played in self.played.items()},
            group_parent=new[self.group_parent] if self.group_parent >= 0 else self.group_parent,
        )

    def shared(self, values: Floats) -> Floats:
        """Values of nodes, (n, …), with those of one for all that show what it shows."""
        found = values.copy() if self.instances else values
        for node, first in self.instances.items():
            found[node] = values[first]
        return found
