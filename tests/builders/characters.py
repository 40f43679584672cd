"""A character in code: skinned, rigid and morphed meshes, a camera, and a clip of every kind."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from rigs import rig_of

from rigtri.maths.matrices import inverse
from rigtri.maths.quaternions import unit
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Track
from rigtri.model.mesh import Mesh
from rigtri.model.rig import Rig
from rigtri.model.skin import Skin
from rigtri.report import Notice
from rigtri.verification.compare.scene_facts import SceneFacts

NAMES = ["hips", "spine", "arm", "hand", "sword", "camera", "body", "face"]
PARENTS = [-1, 0, 1, 2, 3, 3, -1, 1]
HIPS, SPINE, ARM, HAND, SWORD, CAMERA, BODY, FACE = range(8)


@dataclass(frozen=True)
class Held:
    """A document that was never a file."""

    rig: Rig
    drawn: tuple[Mesh, ...] = ()
    warnings: Sequence[Notice] = ()

    shows: SceneFacts = field(default_factory=SceneFacts)

    def meshes(self) -> Sequence[Mesh]:
        return self.drawn

    def outlines(self, *, closely: bool = False) -> Sequence[Mesh]:
        return self.drawn

    def scene_facts(self, *, closely: bool = False) -> SceneFacts:
        return self.shows


def character(seed: int = 0) -> Held:
    """Four joints in a row; a sword and a camera in the hand, a face with a morph on the spine."""
    random = np.random.default_rng(seed)
    rig = rig_of(
        NAMES,
        PARENTS,
        random.normal(size=(8, 3)),
        unit(random.normal(size=(8, 4))),
        attachment=np.array([-1, -1, -1, -1, SWORD, CAMERA, BODY, FACE]),
    )
    joints = np.array([SPINE, HIPS, HAND, ARM])
    skin = Skin("skin", joints, inverse(rig.world[joints]), key=0)
    rig = replace(rig, skins=(skin,), clips=(Clip("walk", _tracks(random), key=0),))
    return Held(rig, _meshes(random))


def many(count: int) -> Held:
    """Characters beside each other, each with a clip that moves it alone."""
    size, found = len(NAMES), [character(seed) for seed in range(count)]
    rigs = [held.rig for held in found]
    rig = rig_of(
        [f"{name}{k}" for k in range(count) for name in NAMES],
        [parent + (size * k if parent >= 0 else 0) for k in range(count) for parent in PARENTS],
        np.concatenate([one.translation for one in rigs]),
        np.concatenate([one.rotation for one in rigs]),
        attachment=np.concatenate(
            [np.where(one.attachment < 0, -1, one.attachment + size * k) for k, one in enumerate(rigs)]
        ),
    )
    skins = [
        replace(one.skins[0], joints=one.skins[0].joints + size * k, key=k) for k, one in enumerate(rigs)
    ]
    clips = [
        Clip(f"clip {k}", tuple(replace(t, node=t.node + size * k) for t in one.clips[0].tracks), key=k)
        for k, one in enumerate(rigs)
    ]
    drawn = [
        replace(
            mesh, name=f"{mesh.name}{k}", node=mesh.node + size * k, skin=None if mesh.skin is None else k
        )
        for k, held in enumerate(found)
        for mesh in held.drawn
    ]
    return Held(replace(rig, skins=tuple(skins), clips=tuple(clips)), tuple(drawn))


def _tracks(random: np.random.Generator) -> tuple[Track, ...]:
    times, own = np.array([0.0, 0.5, 1.25, 2.0]), np.array([0.25, 1.0])
    steps = unit(random.normal(size=(4, 4)))
    tangents = random.normal(size=(4, 3, 4))
    tangents[:, 1] = unit(tangents[:, 1])
    return (
        Track(HIPS, "translation", "LINEAR", times, random.normal(size=(4, 3)), 0),
        Track(HIPS, "rotation", "LINEAR", times, unit(random.normal(size=(4, 4))), 1),
        Track(SPINE, "rotation", "CUBICSPLINE", times, tangents, 2),
        Track(ARM, "rotation", "STEP", times, steps, 3),
        Track(HAND, "rotation", "LINEAR", own, unit(random.normal(size=(2, 4))), 4),
        Track(FACE, "weights", "LINEAR", own, np.array([[0.0], [1.0]]), 5),
    )


def _meshes(random: np.random.Generator) -> tuple[Mesh, ...]:
    joints = np.array([random.permutation(4)[:3] for _ in range(40)])
    weights = random.random((40, 3))
    weights[::5, 1] = 0.0
    body = Mesh("body", BODY, random.normal(size=(40, 3)), 0, joints, weights)
    sword = Mesh("sword", SWORD, random.normal(size=(6, 3)))
    face = Mesh(
        "face",
        FACE,
        random.normal(size=(5, 3)),
        morphs=random.normal(size=(1, 5, 3)),
        morph_weights=np.zeros(1),
    )
    return body, sword, face


def stored(rig: Rig) -> Rig:
    """The rig as a file gives it back: inverse binds and keys rounded to float32."""
    skins = tuple(replace(s, inverse_bind=_single(s.inverse_bind)) for s in rig.skins)
    clips = tuple(
        replace(c, tracks=tuple(replace(t, values=_single(t.values)) for t in c.tracks)) for c in rig.clips
    )
    return replace(rig, skins=skins, clips=clips)


def with_track(rig: Rig, node: int, path: str, **changes: object) -> Rig:
    """The rig with something else in one track of its first clip that has it."""
    for number, clip in enumerate(rig.clips):
        if any(t.node == node and t.path == path for t in clip.tracks):
            tracks = tuple(
                replace(t, **changes) if (t.node, t.path) == (node, path) else t  # type: ignore[arg-type]
                for t in clip.tracks
            )
            clips = list(rig.clips)
            clips[number] = replace(clip, tracks=tracks)
            return replace(rig, clips=tuple(clips))
    raise LookupError(f"no clip drives the {path} of {rig.title(node)}")


def without_track(rig: Rig, node: int, path: str) -> Rig:
    """The rig with one track gone from every clip."""
    clips = tuple(
        replace(c, tracks=tuple(t for t in c.tracks if (t.node, t.path) != (node, path))) for c in rig.clips
    )
    return replace(rig, clips=clips)


def _single(values: Floats) -> Floats:
    return values.astype(np.float32).astype(np.float64)
