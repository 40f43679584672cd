"""A scene as the JSON and the buffer of a glTF: nodes in the order of the rig, skins, clips, meshes.

Source: glTF 2.0; KHR_lights_punctual.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

import numpy as np

from rigtri.errors import GeometryError
from rigtri.evaluation.skinning import normalised_weights
from rigtri.export.conversion.gltf_buffers import ARRAY, BufferBuilder
from rigtri.export.conversion.gltf_materials import MaterialWriter
from rigtri.export.conversion.scene import Camera, Image, Light, Primitive, Scene
from rigtri.formats.gltf.scene_facts import LIGHTS, VISIBILITY
from rigtri.maths.matrices import compose, decompose, multiply
from rigtri.maths.quaternions import from_axes, unit
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import length, normalise
from rigtri.model.animation import Clip
from rigtri.model.mesh import Mesh
from rigtri.model.skin_weights import added_up

# A matrix that translation, rotation and scale give back to this share of its largest number is theirs:
# exporters that multiply in float32 leave as much.
SAME = 1e-6
# Of x, y, z with z up: what they are with y up.
Z_UP = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])


class GltfWriter:
    """Makes the file of a scene. index: the node of the file for each of the rig, −1 for those left out."""

    def __init__(self, scene: Scene, place: Callable[[Image], str] | None) -> None:
        """place: the URI of an image; None to have all in the buffer."""
        self.scene, self.rig = scene, scene.rig
        self.buffer = BufferBuilder()
        self.gltf: dict[str, Any] = {"asset": {"version": "2.0", "generator": "rigtri"}}
        self.materials = MaterialWriter(self.buffer, place)
        self.index = np.cumsum([k not in scene.omitted for k in range(len(self.rig))]) - 1
        self.index[sorted(scene.omitted)] = -1
        self.primitives: dict[int, int] = {}  # rig node → how many primitives its node shows
        self._meshes: dict[str, int] = {}
        self._skins: dict[tuple[int, bytes], int] = {}
        self._used: set[str] = set()
        self._animated = {t.node for clip in self.rig.clips for t in clip.tracks if t.path != "weights"}

    def write(self) -> dict[str, Any]:
        """The JSON but for its buffers; the content of buffer 0 is in `buffer`."""
        gltf, scene = self.gltf, self.scene
        self._nodes()
        if scene.copyright:
            gltf["asset"]["copyright"] = scene.copyright
        for node, primitives in scene.primitives.items():
            self._mesh(node, primitives)
        self._lenses()
        clips = [found for clip in self.rig.clips if (found := self._clip(clip))["channels"]]
        materials = self.materials.write(scene.materials)
        self._used |= self.materials.extensions
        for key, value in (("animations", clips), *materials.items()):
            if value:
                gltf[key] = value
        gltf["accessors"], gltf["bufferViews"] = self.buffer.accessors, self.buffer.views
        if self._used:
            gltf["extensionsUsed"] = sorted(self._used)
        return {key: value for key, value in gltf.items() if value not in ([], {})}

    def _nodes(self) -> None:
        rig, scene = self.rig, self.scene
        nodes: list[dict[str, Any]] = []
        roots = []
        for k in range(len(rig)):
            if self.index[k] < 0:
                continue
            node: dict[str, Any] = {"name": rig.names[k]} if rig.names[k] else {}
            node |= self._transform(k)
            if k in scene.extras:
                node["extras"] = scene.extras[k]
            if k in scene.hidden and int(rig.parents[k]) not in scene.hidden:
                self._extend(node, VISIBILITY, {"visible": False})
            nodes.append(node)
            above = int(rig.parents[k])
            if above < 0:
                roots.append(len(nodes) - 1)
            else:
                nodes[self.index[above]].setdefault("children", []).append(len(nodes) - 1)
        if scene.up == "Z" or scene.unit != 1.0:
            root: dict[str, Any] = {"name": scene.name, "children": roots}
            if scene.unit != 1.0:
                root["scale"] = [scene.unit] * 3
            if scene.up == "Z":
                root["rotation"] = from_axes(Z_UP).tolist()
            nodes.append(root)
            roots = [len(nodes) - 1]
        self.gltf |= {"scene": 0, "scenes": [{"name": scene.name, "nodes": roots}], "nodes": nodes}

    def _extend(self, holder: dict[str, Any], name: str, value: dict[str, Any]) -> None:
        holder.setdefault("extensions", {})[name] = value
        self._used.add(name)

    def _transform(self, k: int) -> dict[str, Any]:
        """Translation, rotation and scale of a node; its matrix where it is none of these."""
        rig = self.rig
        parts = rig.translation[k], unit(rig.rotation[k]), rig.scale[k]
        if rig.has_matrix[k]:
            local = rig.local[k]
            near = SAME * float(np.abs(local).max())
            if not np.abs(compose(*parts) - local).max() <= near:
                parts = decompose(local)
            if not np.abs(compose(*parts) - local).max() <= near:
                self.scene.lose(f"the shear of {rig.title(k)}, which glTF forbids")
                if k not in self._animated:
                    return {"matrix": local.reshape(-1).tolist()}
                if not np.isfinite(parts[1]).all():
                    raise GeometryError(
                        f"The rest pose of '{rig.title(k)}' is flat: its axes span no space, so that no "
                        "rotation and scale say where it rests, as glTF needs for what clips move. Let it "
                        "rest as it is bound: rigtri set-rest --pose bind"
                    )
        none = [0.0] * 3, [0.0, 0.0, 0.0, 1.0], [1.0] * 3
        names = "translation", "rotation", "scale"
        parts = parts[0], np.clip(parts[1], -1.0, 1.0), parts[2]  # a unit one may round beyond
        found = {name: part.tolist() for name, part in zip(names, parts, strict=True)}
        return {name: found[name] for name, plain in zip(names, none, strict=True) if found[name] != plain}

    def _mesh(self, node: int, primitives: list[Primitive]) -> None:
        mesh = primitives[0].mesh
        found: dict[str, Any] = {"name": primitives[0].name}
        found["primitives"] = [self._primitive(one) for one in primitives]
        if len(mesh.morphs):
            found["weights"] = mesh.morph_weights.tolist()
            if mesh.morph_names:
                found["extras"] = {"targetNames": list(mesh.morph_names)}
        meshes = self.gltf.setdefault("meshes", [])
        holder = self.gltf["nodes"][self.index[node]]
        # Instances show one mesh, each with its own skin.
        holder["mesh"] = self._meshes.setdefault(json.dumps(found), len(meshes))
        if holder["mesh"] == len(meshes):
            meshes.append(found)
        if mesh.skin is not None:
            holder["skin"] = self._skin(mesh)

    def _primitive(self, primitive: Primitive) -> dict[str, Any]:
        mesh, surface = primitive.mesh, primitive.surface

        def points(rows: Floats, *, bounds: bool = False) -> int:
            return self.buffer.accessor(rows, target=ARRAY, bounds=bounds)

        attributes = {"POSITION": points(mesh.points, bounds=True)}
        if len(surface.normals):
            attributes["NORMAL"] = points(_normalised(surface.normals))
        for name, rows in surface.values.items():
            if " of " not in name:
                attributes[name] = points(rows)
        if mesh.skin is not None:
            attributes |= self._influences(mesh)
        found: dict[str, Any] = {"attributes": attributes, "indices": self.buffer.indices(surface.corners)}
        if primitive.material is not None:
            found["material"] = primitive.material
        if len(mesh.morphs):
            found["targets"] = []
            for k, offsets in enumerate(mesh.morphs):
                target = {"POSITION": points(offsets, bounds=True)}
                normals = surface.values.get(f"NORMAL of morph target {k}")
                if normals is not None:
                    target["NORMAL"] = points(normals)
                found["targets"].append(target)
        return found

    def _influences(self, mesh: Mesh) -> dict[str, int]:
        """Joints and weights in sets of four, weights summing to 1, the largest first.

        A joint that a point names twice, as USD allows, is there once.
        """
        weights = normalised_weights(added_up(mesh.joints, mesh.weights))
        order = np.argsort(-np.abs(weights), axis=1, kind="stable")
        weights = np.take_along_axis(weights, order, axis=1)
        joints = np.take_along_axis(mesh.joints, order, axis=1)
        used = max(1, int((weights != 0).any(axis=0).nonzero()[0].max(initial=0)) + 1)
        wide = -(-used // 4) * 4
        rows = np.zeros((2, len(weights), wide))
        count = min(wide, weights.shape[1])
        rows[0, :, :count] = np.where(weights == 0, 0, joints)[:, :count]
        rows[1, :, :count] = weights[:, :count]
        found = {}
        for k in range(wide // 4):
            found[f"JOINTS_{k}"] = self.buffer.accessor(rows[0, :, 4 * k : 4 * k + 4], "u2", target=ARRAY)
            found[f"WEIGHTS_{k}"] = self.buffer.accessor(rows[1, :, 4 * k : 4 * k + 4], target=ARRAY)
        return found

    def _skin(self, mesh: Mesh) -> int:
        """The skin of a mesh; meshes of a Skeleton share one where their geomBindTransform is the same."""
        assert mesh.skin is not None
        key = mesh.skin, mesh.bind.tobytes()
        if key not in self._skins:
            skin = self.rig.skins[mesh.skin]
            binds = multiply(mesh.bind, skin.inverse_bind)
            binds[..., :3, 3], binds[..., 3, 3] = 0.0, 1.0
            skins = self.gltf.setdefault("skins", [])
            skins.append(
                {
                    "name": skin.name,
                    "joints": self.index[skin.joints].tolist(),
                    "inverseBindMatrices": self.buffer.accessor(binds.reshape(-1, 16)),
                }
            )
            self._skins[key] = len(skins) - 1
        return self._skins[key]

    def _clip(self, clip: Clip) -> dict[str, Any]:
        samplers: dict[tuple[int, int, str], int] = {}
        channels = []
        for track in clip.tracks:
            node = int(self.index[track.node])
            values = unit(track.values) if track.path == "rotation" else track.values
            rows = np.clip(values.astype(np.float32), -1.0, 1.0) if track.path == "rotation" else values
            times = self.buffer.accessor(track.times, bounds=True)
            output = self.buffer.accessor(rows.reshape(-1) if track.path == "weights" else rows)
            number = samplers.setdefault((times, output, track.interpolation), len(samplers))
            channels.append({"sampler": number, "target": {"node": node, "path": track.path}})
        words = "input", "output", "interpolation"
        listed = [dict(zip(words, sampler, strict=True)) for sampler in samplers]
        return {"name": clip.name, "samplers": listed, "channels": channels}

    def _lenses(self) -> None:
        for node, camera in self.scene.cameras.items():
            cameras = self.gltf.setdefault("cameras", [])
            cameras.append(_camera(camera))
            self.gltf["nodes"][self.index[node]]["camera"] = len(cameras) - 1
        lights = [_light(light) for light in self.scene.lights.values()]
        for number, node in enumerate(self.scene.lights):
            self._extend(self.gltf["nodes"][self.index[node]], LIGHTS, {"light": number})
        if lights:
            self._extend(self.gltf, LIGHTS, {"lights": lights})


def _normalised(normals: Floats) -> Floats:
    """Unit normals; what has no length points up."""
    return np.where((length(normals) > 0)[:, np.newaxis], normalise(normals), [0.0, 1.0, 0.0])


def _camera(camera: Camera) -> dict[str, Any]:
    named = {"name": camera.name} if camera.name else {}
    far = {} if camera.far is None else {"zfar": camera.far}
    if not camera.orthographic:
        aspect = {} if camera.aspect is None else {"aspectRatio": camera.aspect}
        lens = {"yfov": camera.height, **aspect, "znear": camera.near, **far}
        return {**named, "type": "perspective", "perspective": lens}
    high = camera.height / 2.0
    lens = {"xmag": high * (camera.aspect or 1.0), "ymag": high, "znear": camera.near}
    return {**named, "type": "orthographic", "orthographic": {**lens, "zfar": camera.far or 1e6}}


def _light(light: Light) -> dict[str, Any]:
    found: dict[str, Any] = {"type": light.kind, "color": list(light.colour), "intensity": light.intensity}
    if light.name:
        found["name"] = light.name
    if light.kind == "spot":
        # glTF wants the inner cone narrower than the outer one.
        inner = min(light.inner, light.outer * (1.0 - 1e-6))
        found["spot"] = {"innerConeAngle": inner, "outerConeAngle": light.outer}
    return found
