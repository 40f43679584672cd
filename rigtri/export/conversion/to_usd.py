"""A glTF document as a USD file, and what of the one is what of the other once that is read again."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from pxr import UsdGeom, UsdSkel

from rigtri.export.conversion.gltf_scene import read_scene
from rigtri.export.conversion.scene import Scene
from rigtri.export.conversion.usd_names import clip_titles
from rigtri.export.conversion.usd_stage import UsdLook, WrittenStage, conversion_matrix, write_stage
from rigtri.formats.document import Companion, ReadOptions
from rigtri.formats.gltf.document import GltfDocument
from rigtri.formats.usd import usdz
from rigtri.formats.usd.composition import layers
from rigtri.formats.usd.document import UsdDocument
from rigtri.formats.usd.reading.loose_animations import tracks_of
from rigtri.maths.matrices import inverse, multiply
from rigtri.model.animation import Clip, Track
from rigtri.model.mesh import Mesh
from rigtri.model.rig import Rig
from rigtri.verification.compare.across_formats import Converted, at_keys_of


@dataclass(eq=False)
class ToUsd:
    """The conversion of one file. look: what the stage is to be like."""

    document: GltfDocument
    look: UsdLook

    @property
    def rig(self) -> Rig:
        """What there is to convert."""
        return self.document.rig

    def write(self, rig: Rig, part: Path, target: Path) -> list[Companion]:
        """Write ``rig``, the document's with the clips that are wanted, to ``part``, which will be
        ``target``.

        Returns the images, which lie in a folder beside it unless it is a package.
        """
        packed = target.suffix.lower() == ".usdz"
        folder = "textures" if packed else f"{target.stem}_textures"
        self.scene: Scene = read_scene(self.document, rig, target.stem)
        self.written: WrittenStage = write_stage(
            self.scene, self.look, lambda image: f"./{folder}/{image.name}"
        )
        content = layers.to_bytes(self.written.layer, "usda" if target.suffix.lower() == ".usda" else "usdc")
        images = {path.removeprefix("./"): image.content for path, image in self.written.images.items()}
        if packed:
            usdz.write_new({usdz.layer_name(target): content, **images}, part)
            return []
        part.write_bytes(content)
        return [Companion(name, image) for name, image in images.items()]

    @classmethod
    def known(cls, before: GltfDocument, after: UsdDocument) -> Converted:
        """What of a glTF is what of a stage that `convert` may have made of it: by the paths it gives."""
        stage = after.source.stage
        up = "Z" if UsdGeom.GetStageUpAxis(stage) == UsdGeom.Tokens.z else "Y"
        look = UsdLook(stage.GetTimeCodesPerSecond(), up, UsdGeom.GetStageMetersPerUnit(stage))
        there = {p.GetDisplayName() or p.GetName() for p in stage.Traverse() if p.IsA(UsdSkel.Animation)}
        rig = before.rig
        titles = zip(clip_titles([clip.name for clip in rig.clips]), rig.clips, strict=True)
        clips = tuple(clip for title, clip in titles if title in there) or rig.clips[:1]
        gone = [f"clip {clip.name}" for clip in rig.clips if there and clip not in clips]
        found = cls(before, look)
        root = stage.GetDefaultPrim()
        found.scene = read_scene(before, replace(rig, clips=clips), root.GetName() if root else "Root")
        found.written = write_stage(found.scene, look, lambda image: image.name)
        pair = _Partners(found, after).found()
        return replace(pair, lost=[*pair.lost, *gone])

    @property
    def lost(self) -> list[str]:
        """What USD cannot say, in words."""
        return self.scene.lost

    def compared(self, part: Path) -> Converted:
        """What was written, read again, beside what it was made of."""
        document = UsdDocument.read(part, ReadOptions(empty=True))
        return _Partners(self, document).found()


class _Partners:
    """What of a scene is what of a stage, by where it was written."""

    def __init__(self, conversion: ToUsd, document: UsdDocument) -> None:
        self.scene, self.written, self.document = conversion.scene, conversion.written, document
        self.look = conversion.look
        self.rig = self.scene.rig
        self.source = document.source
        keys = document.rig.keys
        self.prims = {label: k for k, label in enumerate(document.rig.labels) if keys[k][0] == "prim"}  # type: ignore[index]
        self.joints = {place: node for node, place in self.source.joints.items()}

    def found(self) -> Converted:
        node, shown = np.full(len(self.rig), -1), np.full(len(self.rig), -1)
        for k, place in self.written.nodes.items():
            node[k] = shown[k] = self._there(place)
        lenses = {*self.scene.cameras, *self.scene.lights}
        for k, paths in self.written.primitives.items():
            if k in lenses and paths:
                shown[k] = self.prims.get(paths[-1], -1)
        # Of a mesh that cannot be read nothing is written, so the scale above it may be elsewhere.
        meshless = set(np.flatnonzero(self.rig.attachment >= 0).tolist()) - lenses - {*self.scene.primitives}
        shown[sorted(meshless)] = -1
        baked = frozenset(k for k in lenses if len(self.written.nodes.get(k, ())) == 2)
        lost = [
            f"node {self.rig.title(k)}"
            for k in np.flatnonzero(node < 0).tolist()
            if k not in self.scene.omitted
        ]
        meshes = {mesh.name: mesh for mesh in self.document.meshes()}
        pairs, gone = self._meshes(meshes)
        clips, sources = self._clips()
        return Converted(
            self.rig,
            self._after(),
            node,
            shown,
            pairs,
            clips,
            sources,
            lost=[*lost, *gone],
            of_first=baked,
            looking=frozenset(self.written.sheared),
        )

    def _there(self, place: tuple[str, ...]) -> int:
        if len(place) == 1:
            return self.prims.get(place[0], -1)
        return self.joints.get((place[0], place[-1]), -1)

    def _meshes(self, there: Mapping[str, Mesh]) -> tuple[list[tuple[Mesh, Mesh]], list[str]]:
        pairs, lost = [], []
        for node, primitives in self.scene.primitives.items():
            for primitive, path in zip(primitives, self.written.primitives[node], strict=False):
                mesh = there.get(path)
                if mesh is None or len(mesh.points) != len(primitive.mesh.points):
                    if path:
                        lost.append(f"mesh {primitive.mesh.name}")
                else:
                    pairs.append((primitive.mesh, mesh))
        return pairs, lost

    def _after(self) -> Rig:
        """The stage's rig in metres, with y up."""
        rig, prim = self.document.rig, self.source.stage.GetDefaultPrim()
        root = self.prims.get(str(prim.GetPath()), -1) if prim else -1
        if root < 0:
            return rig
        matrix = rig.matrix.copy()
        matrix[root] = multiply(rig.local[root], inverse(conversion_matrix(self.look)))
        has_matrix = rig.has_matrix.copy()
        has_matrix[root] = True
        return replace(rig, matrix=matrix, has_matrix=has_matrix)

    def _clips(self) -> tuple[list[tuple[Clip, Clip]], list[Clip | None]]:
        """Each clip with all that plays where it is bound; of prims what plays with the first.

        And the clips as they were, where the stage has scales as half floats that are others.
        """
        xforms = [
            track
            for clip in self.document.rig.clips
            if clip.key[0] == "xforms"  # type: ignore[index]
            for track in clip.tracks
        ]
        pairs: list[tuple[Clip, Clip]] = []
        sources: list[Clip | None] = []
        for number, (clip, places) in enumerate(zip(self.rig.clips, self.written.clips, strict=True)):
            tracks = list(xforms) if number == 0 else []
            for skeleton, path in places.items():
                tracks += tracks_of(self.source, path, skeleton)
            played = Clip(clip.name, tuple(map(self._in_seconds, tracks)))
            meant = clip if number == 0 else self._of_skeletons(clip)
            rounded = self._rounded(meant, played, self.written.halves[number])
            pairs.append((rounded, played))
            sources.append(None if rounded is meant else meant)
        return pairs, sources

    def _rounded(self, clip: Clip, played: Clip, joints: set[int]) -> Clip:
        """A clip with the scales of some joints as they are played."""
        if not joints:
            return clip
        places = {joint: self.written.nodes[joint] for joint in joints}
        there = {self.joints.get((place[0], place[-1]), -1): joint for joint, place in places.items()}
        kept = [t for t in clip.tracks if t.path != "scale" or t.node not in joints]
        # At the clip's own times: beside a step, rounding would put another value.
        played = at_keys_of(played, clip)
        now = [replace(t, node=there[t.node]) for t in played.tracks if t.path == "scale" and t.node in there]
        return replace(clip, tracks=(*kept, *now))

    def _in_seconds(self, track: Track) -> Track:
        return replace(track, times=track.times / self.written.rate)

    def _of_skeletons(self, clip: Clip) -> Clip:
        """A clip as a stage has it that is not the first: what moves prims is in `Scene.lost`."""
        nodes = self.written.nodes
        tracks = [t for t in clip.tracks if t.path == "weights" or len(nodes.get(t.node, ())) == 2]
        return replace(clip, tracks=tuple(tracks))
