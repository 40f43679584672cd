"""A USD document as a glTF file, and what of the one is what of the other once that is read again."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from rigtri.evaluation.skinning import sums_to_one
from rigtri.export.conversion.gltf_file import GltfWriter
from rigtri.export.conversion.scene import Scene
from rigtri.export.conversion.usd_scene import read_scene
from rigtri.formats.document import Companion, ReadOptions
from rigtri.formats.gltf.container import glb
from rigtri.formats.gltf.document import GltfDocument
from rigtri.formats.gltf.uris import escape
from rigtri.formats.usd.document import UsdDocument
from rigtri.model.mesh import Mesh
from rigtri.model.rig import Rig
from rigtri.model.skin_weights import added_up
from rigtri.verification.compare.across_formats import Converted


@dataclass(eq=False)
class ToGltf:
    """The conversion of one file."""

    document: UsdDocument
    name: str

    def __post_init__(self) -> None:
        self.scene: Scene = read_scene(self.document, self.name)

    @property
    def rig(self) -> Rig:
        """What there is to convert, clips in seconds."""
        return self.scene.rig

    def write(self, rig: Rig, part: Path, target: Path) -> list[Companion]:
        """Write ``rig``, that of this conversion with the clips that are wanted, to ``part``, for ``target``.

        Returns the buffer and the images, which lie beside a .gltf.
        """
        self.scene.rig = rig
        packed = target.suffix.lower() == ".glb"
        folder = f"{target.stem}_textures"
        self.writer = GltfWriter(
            self.scene, None if packed else lambda image: f"{escape(folder)}/{escape(image.name)}"
        )
        gltf, content = self.writer.write(), bytes(self.writer.buffer.content)
        if content:
            name = {} if packed else {"uri": escape(f"{target.stem}.bin")}
            gltf["buffers"] = [{**name, "byteLength": len(content)}]
        if packed:
            text = json.dumps(gltf, ensure_ascii=False, separators=(",", ":")).encode()
            part.write_bytes(glb(text, content or None))
            return []
        part.write_text(json.dumps(gltf, ensure_ascii=False, indent=2) + "\n", "utf-8")
        beside = [Companion(f"{target.stem}.bin", content)] if content else []
        images = self.writer.materials.images.values()
        return beside + [Companion(f"{folder}/{image.name}", image.content) for image in images]

    @property
    def lost(self) -> list[str]:
        """What glTF cannot say, in words."""
        return self.scene.lost

    def compared(self, part: Path) -> Converted:
        """What was written, read again, beside what it was made of: in the stage's unit and axes."""
        found = self._partners(GltfDocument.read(part, ReadOptions()))
        if all(_skinned_alike(mesh) for mesh, _ in found.meshes):
            return found
        linear = [(_as_in_gltf(mesh), other) for mesh, other in found.meshes]
        return replace(found, meshes=linear, source_meshes=found.meshes)

    @classmethod
    def known(cls, before: UsdDocument, after: GltfDocument) -> Converted:
        """What of a stage is what of a glTF that `convert` may have made of it: by the order it gives."""
        found = cls(before, "Root")
        found.writer = GltfWriter(found.scene, lambda image: image.name)
        found.writer.write()
        return found._partners(after)

    def _partners(self, document: GltfDocument) -> Converted:
        before, after = self.scene.rig, document.rig
        place = {key: node for node, key in enumerate(after.keys)}
        node = np.array([place.get(int(k), -1) for k in self.writer.index], dtype=np.int64)
        same = [
            k >= 0 and after.names[k] == name for k, name in zip(node.tolist(), before.names, strict=True)
        ]
        node = np.where(same, node, -1)
        lost = [f"node {before.title(k)}" for k in range(len(before)) if node[k] < 0 <= self.writer.index[k]]
        meshes: dict[int, list[object]] = {}
        for mesh in document.meshes():
            meshes.setdefault(mesh.node, []).append(mesh)
        pairs = []
        for k, primitives in self.scene.primitives.items():
            there = meshes.get(int(node[k]), [])
            if len(there) != len(primitives):
                lost.append(f"mesh {primitives[0].mesh.name}")
            pairs += [(one.mesh, other) for one, other in zip(primitives, there, strict=False)]
        known = {clip.name: clip for clip in after.clips}
        moved = self.scene.played
        clips = [(moved.get(c.name, (c, None))[0], known[c.name]) for c in before.clips if c.name in known]
        sources = [moved.get(clip.name, (clip, None))[1] for clip, _ in clips]
        lost += [f"clip {clip.name}" for clip in before.clips if clip.name not in known]
        return Converted(before, self._in_stage(after), node, node.copy(), pairs, clips, sources, lost=lost)  # type: ignore[arg-type]

    def _in_stage(self, rig: Rig) -> Rig:
        """The file's rig without the root that turns and scales it."""
        if self.scene.up == "Y" and self.scene.unit == 1.0:
            return rig
        root = int(rig.parents.argmin()) if len(rig) else 0
        rotation, scale = rig.rotation.copy(), rig.scale.copy()
        rotation[root], scale[root] = (0.0, 0.0, 0.0, 1.0), 1.0
        return replace(rig, rotation=rotation, scale=scale)


def _skinned_alike(mesh: Mesh) -> bool:
    """Whether glTF skins a mesh of USD as UsdSkel does."""
    return not mesh.dual_quaternion and sums_to_one(mesh)


def _as_in_gltf(mesh: Mesh) -> Mesh:
    """A mesh skinned as glTF does: linearly, with weights that are scaled to sum to 1."""
    if _skinned_alike(mesh):
        return mesh
    weights = added_up(mesh.joints, mesh.weights)
    return replace(mesh, weights=weights, dual_quaternion=False, raw_weights=False)
