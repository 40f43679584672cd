"""What pose readers and rivets drive in Blender once a script of export-blender has set them up.

Exporters write keys of it, a key a frame; they are no edit, and bake makes those of RIG anew.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field

from rigtri.model.animation import PATHS
from rigtri.model.dataclass import dataclass
from rigtri.model.metadata import PoseReaderRecord, PoseWeightRecord, RivetRecord
from rigtri.model.rig import Rig
from rigtri.operations.add_posereader.corrective_joints import driven_joints
from rigtri.operations.take_clips.morph_targets import morph_targets


@dataclass(frozen=True, eq=False)
class Driven:
    """channels: nodes and paths. morphs: by the node of a mesh the columns of its morph targets."""

    channels: frozenset[tuple[int, str]] = frozenset()
    morphs: Mapping[int, frozenset[int]] = field(default_factory=dict)

    @property
    def nodes(self) -> frozenset[int]:
        """The nodes with such channels."""
        return frozenset(node for node, _ in self.channels)


def driven_channels(rig: Rig) -> Driven:
    """What all pose readers and rivets of a rig drive."""
    own = (*rig.records(RivetRecord), *rig.records(PoseWeightRecord))
    channels = {(node, path) for node in own for path in PATHS}
    channels |= {(node, path) for node, paths in driven_joints(rig).items() for path in paths}
    shapes, morphs = morph_targets(rig), dict[int, frozenset[int]]()
    for record in rig.records(PoseReaderRecord).values():
        for output in record.outputs:
            node = rig.known(output.mesh) if output.mesh else None
            if node in shapes:
                names = shapes[node].names
                words = (names[k] if k < len(names) else "" for k in range(len(shapes[node].rest)))
                found = {k for k, name in enumerate(words) if output.morph in (name, str(k))}
                morphs[node] = morphs.get(node, frozenset()) | found
    return Driven(frozenset(channels), morphs)
