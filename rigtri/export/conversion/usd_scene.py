"""A USD stage as a scene: clips in seconds, meshes as triangles, materials, cameras, lights and extras."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from pxr import UsdGeom, UsdLux, UsdSkel

from rigtri.errors import FileError
from rigtri.evaluation.bind_pose import unit_rotations
from rigtri.evaluation.timelines import as_played
from rigtri.export.conversion.scene import Primitive, Scene
from rigtri.export.conversion.usd_cameras_lights import read_camera, read_light
from rigtri.export.conversion.usd_deformation import lost_deformations
from rigtri.export.conversion.usd_instances import without_instances
from rigtri.export.conversion.usd_joint_scales import unshown_scales
from rigtri.export.conversion.usd_material_reader import MaterialReader, shows_colours
from rigtri.export.conversion.usd_motion import PrimMotion
from rigtri.export.conversion.usd_triangles import Faces, colour_of, materials_of, read_faces, with_points
from rigtri.export.conversion.usd_unread import Unread
from rigtri.export.conversion.usd_values import HereOrAbove, json_value, rest_value
from rigtri.formats.usd.composition.stage import quiet
from rigtri.formats.usd.composition.value_types import integers, vectors
from rigtri.formats.usd.document import UsdDocument
from rigtri.formats.usd.reading.loose_animations import nearest, tracks_of
from rigtri.formats.usd.reading.mesh_reader import at_start, drives_shapes
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Track
from rigtri.model.mesh import Mesh, Surface
from rigtri.model.rig import Rig
from rigtri.text import and_more

# Float32 seconds that are farther apart, in time codes, move keys by more than a hundredth of a frame.
_SAME_TIME = 0.02
# The first float32 time after 0.
_SMALLEST = np.nextafter(np.float32(0), np.float32(1))


def read_scene(document: UsdDocument, name: str) -> Scene:
    """All of a stage that glTF can say; the rest is in `Scene.lost`. Its rig has clips in seconds."""
    with quiet(f"{document.source.path}: USD cannot read what it shows"):
        expanded, lost = without_instances(document)
        scene = _Reader(expanded, name, document.image).read()
        for words in lost:
            scene.lose(words)
        return scene


def _is_invisible(prim: Any) -> bool:
    shown = prim.IsA(UsdGeom.Imageable) and rest_value(UsdGeom.Imageable(prim).GetVisibilityAttr())
    return bool(shown == UsdGeom.Tokens.invisible)


class _Reader:
    """One pass over a stage."""

    def __init__(self, document: UsdDocument, name: str, images: Callable[[Any], bytes]) -> None:
        self.document, self.source = document, document.source
        self.stage = self.source.stage
        self.scene = Scene(document.rig, name)
        self.materials = MaterialReader(self.scene, images)
        self.motion = PrimMotion()
        self.hidden = HereOrAbove(_is_invisible)

    def read(self) -> Scene:
        scene, stage = self.scene, self.stage
        scene.up = "Z" if UsdGeom.GetStageUpAxis(stage) == UsdGeom.Tokens.z else "Y"
        scene.unit = float(UsdGeom.GetStageMetersPerUnit(stage))
        scene.per_second = float(stage.GetTimeCodesPerSecond())
        for field, value in (("metersPerUnit", scene.unit), ("timeCodesPerSecond", scene.per_second)):
            if value <= 0.0:
                layer = stage.GetRootLayer().identifier
                raise FileError(
                    f"{layer}: {field} is {value:g}; glTF is in metres and seconds. Set it above 0"
                )
        copyright = stage.GetRootLayer().customLayerData.get("copyright")
        scene.copyright = copyright if isinstance(copyright, str) else ""
        self._omit()
        for mesh in self.document.meshes():
            if mesh.node not in scene.omitted:
                self._mesh(mesh)
        for node, key in enumerate(scene.rig.keys):
            if key[0] == "prim" and node not in scene.omitted:  # type: ignore[index]
                self._prim(node, stage.GetPrimAtPath(scene.rig.labels[node]))
        self._unread()
        scene.rig = replace(scene.rig, names=self._names(), clips=tuple(self._clips()))
        return scene

    def _unread(self) -> None:
        """Report what is authored and not read, but for what is reported as a whole."""
        omitted = {self.scene.rig.labels[node] for node in self.scene.omitted}
        unread = Unread(self.materials.unused)
        unread.add_layer(self.stage)
        unread.add(self.source.instances.prims(), HereOrAbove(lambda prim: str(prim.GetPath()) in omitted))
        for what in unread.lines():
            self.scene.lose(what)

    def _omit(self) -> None:
        """Leave out rigtri's own rig, guides and what is not there for everybody."""
        scene, rig, guides = self.scene, self.scene.rig, 0
        scene.omit_built()
        for node, key in enumerate(rig.keys):
            prim = self.stage.GetPrimAtPath(rig.labels[node]) if key[0] == "prim" else None  # type: ignore[index]
            if prim and (prim.IsAbstract() or not prim.IsDefined() or not prim.IsActive()):
                scene.omitted.add(node)
            elif prim and prim.IsA(UsdGeom.PointInstancer) and node not in scene.omitted:
                # What is below it is shown where it has instances, and nowhere else.
                scene.omitted.update([node, *rig.below(node)])
                scene.lose(f"PointInstancer <{prim.GetPath()}> with its prototypes")
            elif prim and prim.IsA(UsdGeom.Gprim) and node not in scene.omitted:
                if UsdGeom.Imageable(prim).ComputePurpose() in ("guide", "proxy"):
                    scene.omitted.add(node)
                    guides += 1
                elif not prim.IsA(UsdGeom.Mesh):
                    scene.lose(f"{prim.GetTypeName()} <{prim.GetPath()}>")
        if guides:
            scene.lose(f"{guides} prims of purpose guide or proxy")
        keep = rig.with_ancestors(k for k in range(len(rig)) if rig.is_joint[k] or k not in scene.omitted)
        scene.omitted -= keep

    def _prim(self, node: int, prim: Any) -> None:
        scene = self.scene
        if prim.IsA(UsdGeom.Camera):
            scene.cameras[node] = read_camera(prim, scene.unit)
        elif prim.HasAPI(UsdLux.LightAPI):
            light = read_light(prim, scene)
            if light is not None:
                scene.lights[node] = light
        extras = prim.GetCustomDataByKey("extras")
        if extras and not prim.IsA(UsdSkel.Skeleton):
            scene.extras[node] = json_value(extras)
        if self.hidden(prim):
            scene.hidden.add(node)

    def _mesh(self, mesh: Mesh) -> None:
        prim = self.stage.GetPrimAtPath(mesh.name)
        if not prim.IsA(UsdGeom.Mesh):
            return
        faces = read_faces(prim, len(mesh.points), self.scene.lose)
        if faces is None or not len(faces.triangles):
            self.scene.lose(f"mesh {mesh.name}, which has no faces that make sense")
            return
        self._unsaid(prim, mesh)
        found = replace(with_points(mesh, faces), morph_names=self._morph_names(prim, mesh))
        values = {name: each for name, each in faces.values.items() if name != "NORMAL"}
        if "NORMAL" in faces.values:
            values |= dict(self._normal_offsets(prim, mesh, faces))
        sided = UsdGeom.Mesh(prim).GetDoubleSidedAttr().Get() is True
        count = int(faces.face[-1]) + 1
        name = prim.GetDisplayName() or prim.GetName()
        for material, some in materials_of(prim, count):
            chosen = np.isin(faces.face, some)
            corners = faces.triangles.reshape(-1, 3)[chosen].reshape(-1)
            normals = faces.values.get("NORMAL", np.zeros((0, 3)))
            drawn = dict(values)
            if "COLOR_0" in values and not shows_colours(material):  # glTF would multiply them
                del drawn["COLOR_0"]
                self.scene.lose("displayColor of meshes with a material that does not show it")
            elif "COLOR_0" not in values and material is not None and shows_colours(material):
                colour = colour_of(prim)
                if colour is not None:
                    drawn["COLOR_0"] = np.tile(np.array(colour[:3]), (len(found.points), 1))
            surface = Surface("triangles", np.zeros(0, dtype=np.int64), corners, normals, drawn)
            if material is None:
                number = self.materials.coloured(colour_of(prim), double_sided=sided)
            else:
                shown = {each: of[corners] for each, of in faces.values.items()}
                number = self.materials.number(material, faces.coordinates, shown, double_sided=sided)
            if len(corners):
                self.scene.primitives.setdefault(mesh.node, []).append(
                    Primitive(found, surface, name, number)
                )

    def _unsaid(self, prim: Any, mesh: Mesh) -> None:
        if UsdGeom.Mesh(prim).GetPointsAttr().GetNumTimeSamples() > 1:
            self.scene.lose(f"points of mesh {mesh.name} over time")
        shapes = [UsdSkel.BlendShape(one) for one in self._blend_shapes(prim) if one]
        for text in lost_deformations(mesh, shapes):
            self.scene.lose(text)

    def _blend_shapes(self, prim: Any) -> list[Any]:
        """The prims of the blend shapes of a mesh."""
        relation = UsdSkel.BindingAPI(prim).GetBlendShapeTargetsRel()
        targets = relation.GetForwardedTargets() if relation else []
        return [self.stage.GetPrimAtPath(target) for target in targets]

    def _morph_names(self, prim: Any, mesh: Mesh) -> tuple[str, ...]:
        """The names of morph targets, as BlendShapes are shown."""
        shown = [(one and one.GetDisplayName()) or "" for one in self._blend_shapes(prim)]
        if len(shown) != len(mesh.morph_names):
            return mesh.morph_names
        return tuple(new or old for new, old in zip(shown, mesh.morph_names, strict=True))

    def _normal_offsets(self, prim: Any, mesh: Mesh, faces: Faces) -> dict[str, Floats]:
        found = {}
        for number, one in enumerate(self._blend_shapes(prim)[: len(mesh.morphs)]):
            if not one:
                continue
            shape = UsdSkel.BlendShape(one)
            given = vectors(at_start(shape.GetNormalOffsetsAttr()))
            where = integers(at_start(shape.GetPointIndicesAttr()))
            rows = where if len(where) else np.arange(len(mesh.points))
            if len(given) and len(given) == len(rows) and rows.max(initial=0) < len(mesh.points):
                offsets = np.zeros((len(mesh.points), 3))
                offsets[rows] = given
                found[f"NORMAL of morph target {number}"] = offsets[faces.points]
        return found

    def _names(self) -> tuple[str, ...]:
        """The names that prims are shown with, and those of joints where a Skeleton has any."""
        rig = self.scene.rig
        names = list(rig.names)
        for node, key in enumerate(rig.keys):
            if key[0] == "prim":  # type: ignore[index]
                names[node] = self.stage.GetPrimAtPath(rig.labels[node]).GetDisplayName() or names[node]
        joints: dict[str, list[tuple[int, str]]] = {}
        for node, (owner, token) in self.source.joints.items():
            joints.setdefault(owner, []).append((node, token))
        for path, skeleton in self.source.skeletons.items():
            prim = self.stage.GetPrimAtPath(path)
            shown = UsdSkel.Skeleton(prim).GetJointNamesAttr().Get() if prim.IsA(UsdSkel.Skeleton) else None
            extras = prim.GetCustomDataByKey("extras") if prim.IsA(UsdSkel.Skeleton) else None
            for node, token in joints.get(path, ()):
                if shown and len(shown) == len(skeleton.tokens):
                    names[node] = str(shown[skeleton.tokens.index(token)])
                if extras and token in extras:
                    self.scene.extras[node] = json_value(extras[token])
        return tuple(names)

    def _clips(self) -> list[Clip]:
        """What the stage plays, as one clip, and each animation that it does not play as one of its own."""
        rig = self.scene.rig
        # Of an animation that lacks an array of joints UsdSkel plays the blend shapes.
        shown = rig.shown_clips
        sampled = {clip.key[1] for clip in shown if clip.key[0] == "samples"}  # type: ignore[index]
        playing = [
            clip
            for clip in shown
            if clip.key[0] in ("samples", "xforms")  # type: ignore[index]
            # An animation without samples shows its defaults at all times.
            or (clip.key[0] == "default" and clip.key[1] not in sampled)  # type: ignore[index]
        ]
        tracks = [track for clip in playing for track in self._followed(clip)]
        found: dict[str, list[Track]] = {}
        if tracks:
            bound = next((clip for clip in playing if clip.key[0] != "xforms"), playing[0])  # type: ignore[index]
            prim = self.stage.GetPrimAtPath(bound.key[1]) if bound.key[0] != "xforms" else None  # type: ignore[index]
            name = ((prim and prim.GetDisplayName()) or bound.name) if prim else self.scene.name
            name = name.removesuffix("@default")
            found[name] = tracks
        taken = {name: {(t.node, t.path) for t in some} for name, some in found.items()}
        for path, skeleton in self._loose():
            prim = self.stage.GetPrimAtPath(path)
            called = prim.GetDisplayName() or prim.GetName()
            moved = tracks_of(self.source, path, skeleton)
            name, number, places = called, 1, {(t.node, t.path) for t in moved}
            while not places.isdisjoint(taken.get(name, ())):
                name, number = f"{called}_{number}", number + 1
            taken.setdefault(name, set()).update(places)
            found.setdefault(name, []).extend(moved)
        clips = []
        for name, some in found.items():
            start = min([0.0, *(float(track.times[0]) for track in some)])
            if start < 0:
                self.scene.lose(f"that clip '{name}' begins {-start:g} time codes before 0: it begins at 0")
            written = [track for track in some if self._is_written(track)]
            if not written:
                self.scene.lose(f"clip '{name}', which moves only what is not converted")
            self._check_times(name, written, start)
            kept = [self._in_seconds(track, rig, start) for track in written]
            clips.append(self._unit(Clip(name, tuple(track for track in kept if track is not None))))
        for words in unshown_scales(rig, self.source.joints, clips):
            self.scene.lose(words)
        if tracks and clips[0].tracks:
            self._say_how_it_is_played(clips[0])
        return [clip for clip in clips if clip.tracks]

    def _unit(self, clip: Clip) -> Clip:
        """The clip with rotations of length 1, which glTF demands, where UsdSkel shows others as a scale."""
        tracks, worst = unit_rotations(clip.tracks)
        if not worst:
            return clip
        self.scene.lose(
            f"what UsdSkel shows of rotations in clip '{clip.name}' that are not unit, by up to {worst:.2g}"
        )
        found = replace(clip, tracks=tracks)
        self.scene.played[clip.name] = found, clip
        return found

    def _is_written(self, track: Track) -> bool:
        """Whether what a track moves is converted: its node, or the mesh with its morph targets."""
        if track.path == "weights":
            return track.node in self.scene.primitives
        return track.node not in self.scene.omitted

    def _followed(self, clip: Clip) -> list[Track]:
        """The tracks of a clip, those of prims as USD moves them."""
        if clip.key[0] != "xforms":  # type: ignore[index]
            return list(as_played(self.scene.rig, clip.tracks))
        rig = self.scene.rig
        prims = {track.node: self.stage.GetPrimAtPath(rig.labels[track.node]) for track in clip.tracks}
        found = self.motion.follow(rig, self.document.meshes(), prims, clip.tracks)
        self.scene.grains |= self.motion.grains
        return found

    def _say_how_it_is_played(self, clip: Clip) -> None:
        motion = self.motion
        for words in motion.lost(self.scene.rig.labels):
            self.scene.lose(words)
        if motion.codes:
            meant = motion.played(clip.name, clip.tracks, upright=True)
            was = self.scene.played.get(clip.name, (clip, clip if motion.sheared else None))[1]
            source = motion.played(clip.name, was.tracks, upright=False) if was else None
            self.scene.played[clip.name] = meant, source

    def _loose(self) -> list[tuple[str, str]]:
        """SkelAnimations that nothing plays, each with the Skeleton that has all of its joints.

        One of blend shapes alone goes with a Skeleton whose meshes have some of them.
        """
        bound = {path for each in self.source.skeletons.values() for path in each.animations}
        tokens = {path: set(known.tokens) for path, known in self.source.skeletons.items()}
        used: set[tuple[str, str]] = set()  # clips of one name are one, of several skeletons
        found, other = [], []
        for prim in self.source.instances.prims():
            if not prim.IsA(UsdSkel.Animation) or str(prim.GetPath()) in bound or not prim.IsActive():
                continue
            joints = set(UsdSkel.Animation(prim).GetJointsAttr().Get() or ())
            name = prim.GetDisplayName() or prim.GetName()
            fits = [
                skeleton
                for skeleton, known in tokens.items()
                if (joints or drives_shapes(prim, self.source.bindings.of([skeleton])))
                and joints <= known
                and (name, skeleton) not in used
            ]
            if fits:
                path, (fit, *_) = str(prim.GetPath()), nearest(str(prim.GetPath()), fits)
                used.add((name, fit))
                found.append((path, fit))
            else:
                other.append(f"<{prim.GetPath()}>")
        if other:
            self.scene.lose(f"{and_more(other, 3)}: animations of no skeleton")
        return found

    def _check_times(self, name: str, tracks: Sequence[Track], start: float) -> None:
        """Note where glTF's float32 seconds move keys; FileError where they hold none of them."""
        last = max((float(track.times[-1]) - start for track in tracks), default=0.0)
        seconds = last / self.scene.per_second
        if seconds > np.finfo(np.float32).max:
            raise FileError(
                f"{self.document.source.path}: clip '{name}' has a key {last:g} time codes after its start, "
                f"{seconds:g} s: more than the float32 seconds of glTF hold. Remove that sample"
            )
        step = float(np.spacing(np.float32(seconds)))
        if step > _SAME_TIME / self.scene.per_second:
            self.scene.lose(
                f"exact times of clip '{name}': at {seconds:.6g} s the float32 seconds of glTF are "
                f"{step:.2g} s apart"
            )

    def _in_seconds(self, track: Track, rig: Rig, start: float) -> Track | None:
        """A track as float32 seconds, rising; None for one that stands still as its node does at rest."""
        times = ((track.times - start) / self.scene.per_second).astype(np.float32)
        for k in range(len(times) - 2, -1, -1):
            if times[k] >= times[k + 1]:  # a step, whose samples are nearer than float32 can say
                times[k] = np.nextafter(times[k + 1], np.float32(-np.inf))
        # Such a step at the start begins at 0 as any clip, and its keys rise from there.
        times = np.maximum(times, np.arange(len(times), dtype=np.float32) * _SMALLEST)
        self.motion.note(track, times.astype(np.float64))
        values = track.values
        if track.path != "weights" and (values == values[0]).all():
            rest = {"translation": rig.translation, "rotation": rig.rotation, "scale": rig.scale}[track.path]
            if not rig.has_matrix[track.node] and (values[0] == rest[track.node]).all():
                return None
            times, values = times[:1], values[:1]
        return Track(track.node, track.path, track.interpolation, times.astype(np.float64), values)
