"""Data that a glTF file shows and no pose is made of, as plain facts: one digest for each.

Source: EXT_mesh_gpu_instancing; KHR_draco_mesh_compression; KHR_animation_pointer.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from hashlib import sha256
from typing import Any

import numpy as np

from rigtri.errors import FileError
from rigtri.formats.gltf.accessors import Accessors
from rigtri.formats.gltf.animation_reader import pointer_of, target_of
from rigtri.formats.gltf.mesh_reader import DRACO
from rigtri.formats.gltf.structure import INSTANCING
from rigtri.formats.json_values import object_at, object_in
from rigtri.model.scene_facts import IN_CLIP

# No pose needs these numbers, so that what is wrong with them costs neither an edit nor a comparison.
_UNREADABLE = "cannot be read"
_OF_NODE = re.compile(r"/nodes/([0-9]{1,9})/")


class StoredData:
    """Facts of instances, of compressed primitives, and of keys that drive something else than poses."""

    def __init__(self, gltf: Mapping[str, Any], accessors: Accessors) -> None:
        self._gltf, self._accessors = gltf, accessors

    def of(self, node: int) -> dict[str, Any]:
        """What a node of the file shows."""
        raw = self._gltf["nodes"][node]
        used = object_in(object_in(object_in(raw, "extensions"), INSTANCING), "attributes")
        facts = {f"{name} of the instances": self._numbers(index) for name, index in used.items()}
        mesh = object_at(self._gltf.get("meshes"), raw.get("mesh")) or {}
        primitives = mesh.get("primitives")
        for number, primitive in enumerate(primitives if isinstance(primitives, list) else ()):
            packed = object_in(object_in(object_in({"": primitive}, ""), "extensions"), DRACO)
            if packed:
                facts[f"compressed data of primitive {number}"] = self._bytes(packed.get("bufferView"))
        return facts

    def _driven(self) -> Iterator[tuple[int | None, str, Any]]:
        """Node or None, name and value of what clips drive besides poses, such as colours and lights."""
        for number, animation in enumerate(self._gltf.get("animations") or ()):
            samplers = animation.get("samplers")
            for channel in animation.get("channels") or ():
                pointer = pointer_of(object_in(channel, "target"))
                if pointer is None or target_of(channel) is not None:
                    continue
                sampler = object_at(samplers, channel.get("sampler")) or {}
                kind = str(sampler.get("interpolation", "LINEAR"))
                keys = self._numbers(sampler.get("input")), self._numbers(sampler.get("output"))
                found = _OF_NODE.match(pointer)
                what = pointer[found.end() :] if found else pointer
                clip = f"{what}{IN_CLIP}'{animation.get('name', f'#{number}')}'"
                yield int(found[1]) if found else None, clip, (kind, *keys)

    def with_driven(
        self, whole: Mapping[str, Any], own: Mapping[int, Mapping[str, Any]], place: Sequence[int]
    ) -> dict[str, Any]:
        """Facts of the whole file and of nodes, by their places, with what clips drive of each."""
        all_of: dict[str, Any] = dict(whole)
        of_nodes: dict[int, dict[str, Any]] = {node: dict(facts) for node, facts in own.items()}
        for node, name, value in self._driven():
            if node is None:
                all_of[name] = value
            elif node < len(place):
                of_nodes.setdefault(place[node], {})[name] = value
        return {"whole": all_of, "own": of_nodes}

    def _numbers(self, index: Any) -> str | None:
        if type(index) is not int or not 0 <= index < len(self._accessors):
            return None
        try:
            values = self._accessors.read(index).astype(np.float32)
        except FileError:
            return _UNREADABLE
        return sha256(values.tobytes()).hexdigest()[:12]

    def _bytes(self, view: Any) -> str | None:
        if type(view) is not int:
            return None
        try:
            buffer, start, end = self._accessors.span(view)
            content = self._accessors.buffers.content(buffer)[start:end]
        except FileError:
            return _UNREADABLE
        return sha256(content).hexdigest()[:12]
