"""How exact a file can be: how far its points move when every stored number moves by its last bit.

A correct program practically never refuses its own result, so each refusal (exit 6)
is a finding unless the source explains it: new axes give new numbers, rounded to float32 like
the old ones. Four things in a source explain one:

* Scales or numbers far beyond the size of what is seen blow those last bits up to a good part of the
  tolerance: no program could write the file exactly enough.
* Scales that differ by noise are taken for one number (`nonuniform_scale.SAME_SCALE`); where much hangs
  on such a joint, that noise is seen.
* A scale that is next to nothing beside the others of its joint: what is turned out of that direction
  is lost in the last bits of the others.
* Rotations of USD that are off unit length: OpenUSD makes scaled and sheared axes of them, which no
  rotation in other axes has.

And strip gives the weight of twist joints back to their bones, which moves points elsewhere where a skin
binds the two otherwise than they stand: no weights look the same there.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from rigtri.formats import Document
from rigtri.frames.nonuniform_scale import SAME_SCALE
from rigtri.limits import TOLERANCE
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Track
from rigtri.model.mesh import Mesh
from rigtri.model.metadata import TwistRecord
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin
from rigtri.verification.compare.compare import self_check
from rigtri.verification.compare.scene_facts import SceneFacts

# Half a step of float32, relative to the largest number beside it: new axes mix the three of a vector.
STEP = 2.0**-24
# Rounding goes on along a chain, and one draw of it is not the worst. Sound files stay below 1.2e-6.
ENOUGH = TOLERANCE / 4
DRAWS = 3
# A draw adds up the roundings of a chain of joints as chance has it; the worst edit as they come, of what it
# read and of what it wrote: of twelve joints some twelve times as much. More has another cause.
ROOM = 16.0
# Bind poses are products of chains of float32, so a share of the way along the bone may be noise.
BOUND_NEAR = 1e-3


def explains(document: Document, *, off: float = 0.0, own_nodes: bool = False) -> bool:
    """Whether the last bits of the numbers in a file are so large that no result can be exact enough.

    off: how far off the result was that was refused; inf where it was otherwise than by a distance.
    own_nodes: also the bits of what rigtri has added, which is compared where a command moves joints.
    """
    if _flat(document.rig) or ENOUGH < off <= ROOM * _not_unit(document.rig):
        return True
    for draw in range(DRAWS):
        shaken = _Shaken(document, np.random.default_rng(draw))
        found = self_check(document, shaken, own_nodes=own_nodes)
        if not found.largest_deviation <= max(ENOUGH, off / ROOM):
            return True
    return False


def binds_twist_joints_elsewhere(rig: Rig) -> bool:
    """Whether a skin binds a twist joint at another place on its bone than where it stands."""
    for node, twist in rig.records(TwistRecord).items():
        bone = rig.known(twist.joint)
        for skin in rig.skins:
            rows = {int(joint): row for row, joint in enumerate(skin.joints)}
            if bone is not None and rig.parents[node] == bone and {node, bone} <= rows.keys():
                bound = skin.bind[rows[node]] @ skin.inverse_bind[rows[bone]]
                off = np.abs(bound[3, :3] - rig.translation[node]).max()
                if not off <= BOUND_NEAR * np.abs(rig.translation[node]).max():
                    return True
    return False


class _Shaken:
    """A document whose numbers are off by half a step of float32."""

    def __init__(self, document: Document, random: np.random.Generator) -> None:
        self._document = document
        self.rig = _shaken(document.rig, random)

    def meshes(self) -> Sequence[Mesh]:
        return self._document.meshes()

    def outlines(self, *, closely: bool = False) -> Sequence[Mesh]:
        return self._document.outlines(closely=closely)

    def scene_facts(self) -> SceneFacts:
        return self._document.scene_facts()


def _flat(rig: Rig) -> bool:
    """Whether a scale that is not zero is less than the last bit of its node's largest, at rest or keyed."""
    tracks = [track for clip in rig.clips for track in clip.tracks if track.path == "scale"]
    scales = [rig.scale, *(track.values.reshape(-1, 3) for track in tracks)]
    rows = np.abs(np.concatenate(scales))
    return bool(((rows > 0.0) & (rows < STEP * rows.max(axis=1, keepdims=True))).any())


def _not_unit(rig: Rig) -> float:
    """How far lengths of rotations are from 1 in a format that plays them as stored, at rest or keyed."""
    if not rig.rules.raw_quaternions:
        return 0.0
    keyed = [track.values for clip in rig.clips for track in clip.tracks if track.path == "rotation"]
    rows = np.concatenate([rig.rotation, *(values.reshape(-1, 4) for values in keyed)])
    return float(np.abs(np.linalg.norm(rows, axis=1) - 1.0).max(initial=0.0))


def _shaken(rig: Rig, random: np.random.Generator) -> Rig:
    return replace(
        rig,
        translation=_off(rig.translation, random),
        rotation=_off(rig.rotation, random),
        scale=_off(_noisy(rig.scale, random), random),
        matrix=_matrices_off(rig.matrix, random),
        skins=tuple(_skin(skin, random) for skin in rig.skins),
        clips=tuple(_clip(clip, random) for clip in rig.clips),
    )


def _skin(skin: Skin, random: np.random.Generator) -> Skin:
    return replace(skin, inverse_bind=_matrices_off(skin.inverse_bind, random)) if skin.stored else skin


def _clip(clip: Clip, random: np.random.Generator) -> Clip:
    tracks: list[Track] = []
    for track in clip.tracks:
        kept = track.path == "weights"
        values = _noisy(track.values, random) if track.path == "scale" else track.values
        tracks.append(track if kept else replace(track, values=_off(values, random)))
    return replace(clip, tracks=tuple(tracks))


def _noisy(scales: Floats, random: np.random.Generator) -> Floats:
    """Scales that are off by their noise, where it is noise by which their components differ."""
    largest = np.abs(scales).max(axis=-1, keepdims=True, initial=0.0)
    spread = np.ptp(scales, axis=-1)[..., np.newaxis]
    noise = np.where(spread <= SAME_SCALE * largest, spread, 0.0)
    return np.asarray(scales + noise * random.uniform(-1.0, 1.0, scales.shape))


def _matrices_off(values: Floats, random: np.random.Generator) -> Floats:
    """Matrices, (..., 4, 4), off as `_off` has it but for their last columns, which are 0, 0, 0, 1."""
    rows = _off(values[..., :3], random)
    return np.concatenate([rows, values[..., 3:]], axis=-1)


def _off(values: Floats, random: np.random.Generator) -> Floats:
    """Rows of numbers, each off by up to STEP of the largest of its row."""
    largest = np.abs(values).max(axis=-1, keepdims=True, initial=0.0)
    return np.asarray(values + STEP * largest * random.uniform(-1.0, 1.0, values.shape))
