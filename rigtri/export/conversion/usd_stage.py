"""A scene as one USD layer: prims for its nodes, Skeletons, clips, materials, cameras and lights.

Source: UsdGeom, UsdSkel, UsdShade and UsdLux schemas; docs/convert.md says what becomes what, and why.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import field, replace
from functools import cached_property
from typing import Any

import numpy as np
from pxr import Kind, Sdf, Usd, UsdGeom, UsdSkel, Vt

from rigtri.evaluation.sampling import Motion, key_times, worlds
from rigtri.export.conversion import usd_clips
from rigtri.export.conversion import usd_values as values
from rigtri.export.conversion.scene import Image, Scene
from rigtri.export.conversion.usd_cameras_lights import define_camera, define_light
from rigtri.export.conversion.usd_joint_scales import (
    half_scales,
    lost_scales,
    with_half_scales,
    without_steady_scales,
)
from rigtri.export.conversion.usd_materials import MaterialWriter
from rigtri.export.conversion.usd_names import Names, clip_titles, distinct, name_prim, node_identifiers
from rigtri.export.conversion.usd_primitives import PrimitiveWriter, hide
from rigtri.export.conversion.usd_samples import frame_times, rate_of
from rigtri.export.conversion.usd_skeletons import Skeleton, joints_of, plan_skeletons
from rigtri.formats.usd.codeless_schemas import register_usd_schemas
from rigtri.formats.usd.composition import layers
from rigtri.formats.usd.identifiers import identifier
from rigtri.frames.rig_size import sizes_of
from rigtri.maths.matrices import decompose, identity, looking_frames, skew
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Path, Track
from rigtri.model.dataclass import dataclass
from rigtri.progress import counted
from rigtri.report import Notice
from rigtri.text import and_more

# How far a baked camera or light may be off between samples, as a share of the size of the model and of its
# scale, and in radians: half of what verification sees at corners of a frame, which are farther away.
BAKED = 5e-7
# Frames with less skew than this stand and look as without it.
_SHEARED = 1e-6


@dataclass(frozen=True)
class UsdLook:
    """What a stage is like. rate: frames a second, None to choose. up: ``Y`` or ``Z``; unit: in metres."""

    rate: float | None = None
    up: str = "Y"
    unit: float = 1.0


@dataclass(eq=False)
class WrittenStage:
    """A layer, and where what it was made of is in it.

    nodes: by node of the scene, the prim's path, or a Skeleton's and the joint's token. primitives: by
    node, the paths of their prims, "" for one that is not there. clips: by clip, the SkelAnimations by
    Skeleton. halves: by clip, the joints whose scales half floats do not hold. rate: time codes a second.
    images: by asset path. sheared: nodes whose cameras and lights stand and look as they do, without their
    shear.
    """

    layer: Any
    rate: float
    nodes: dict[int, tuple[str, ...]] = field(default_factory=dict)
    primitives: dict[int, list[str]] = field(default_factory=dict)
    clips: list[dict[str, str]] = field(default_factory=list)
    halves: list[set[int]] = field(default_factory=list)
    images: dict[str, Image] = field(default_factory=dict)
    sheared: set[int] = field(default_factory=set)


def write_stage(scene: Scene, look: UsdLook, place: Callable[[Image], str]) -> WrittenStage:
    """The layer of a scene. place: the asset path of an image."""
    return _Writer(scene, look, place).write()


class _Writer:
    """One pass over a scene."""

    def __init__(self, scene: Scene, look: UsdLook, place: Callable[[Image], str]) -> None:
        self.scene, self.look = scene, look
        self.rate = look.rate or rate_of(scene.rig.clips)
        layer = layers.empty()
        register_usd_schemas()
        self.stage = Usd.Stage.Open(layer)
        self.result = WrittenStage(layer, self.rate)
        self.joints = joints_of(scene)
        self.rig, self.sizes = without_steady_scales(scene.rig, self.joints)
        self._judged_by = sizes_of(scene.rig, scene.rig.meshes).tolist()
        self.clip: Clip | None = self.rig.clips[0] if self.rig.clips else None
        self.skeletons = plan_skeletons(scene, self.rig, self.joints)
        self.words = node_identifiers(self.rig.names, self.rig.labels)
        self.root = f"/{identifier(scene.name, 'Root')}"
        self.names = Names([*self.words, self.root[1:], "Materials", "Animations", "Looks"])
        self._place = place
        self.primitives = PrimitiveWriter(
            self.stage, scene, self.rig, self.sizes, self.skeletons, self.joints, self.names, self.root
        )

    def write(self) -> WrittenStage:
        self._metadata()
        above = self._xforms()
        self._skeletons(above)
        self._materials()
        for node, primitives in self.scene.primitives.items():
            self.result.primitives[node] = [self.primitives.write(node, one, above) for one in primitives]
        self._lenses(above)
        self._clips()
        return self.result

    def _metadata(self) -> None:
        stage, rig = self.stage, self.rig
        skinned = bool(self.skeletons)
        root = (UsdSkel.Root if skinned else UsdGeom.Xform).Define(stage, self.root)
        stage.SetDefaultPrim(root.GetPrim())
        Usd.ModelAPI(root.GetPrim()).SetKind(Kind.Tokens.component)
        UsdGeom.SetStageUpAxis(stage, self.look.up)
        UsdGeom.SetStageMetersPerUnit(stage, self.look.unit)
        if rig.clips:
            stage.SetTimeCodesPerSecond(self.rate)
            stage.SetFramesPerSecond(self.rate)
            times = key_times(self.clip) if self.clip else np.zeros(1)
            ends = [keys[-1] for clip in rig.clips if len(keys := key_times(clip))]
            last = float(max(ends, default=0.0))
            stage.SetStartTimeCode(float(min(times[0], 0.0) * self.rate) if len(times) else 0.0)
            stage.SetEndTimeCode(float(np.ceil(last * self.rate - 1e-6)))
        if self.scene.copyright:
            stage.GetRootLayer().customLayerData = {"copyright": self.scene.copyright}
        turned = conversion_matrix(self.look)
        if (turned != np.eye(4)).any():
            root.AddTransformOp().Set(values.matrix(turned))

    def _xforms(self) -> dict[int, str]:
        """The prims of all nodes that are no joints, by node; −1 for the root."""
        paths, rig = {-1: self.root}, self.rig
        moved = {t.node for clip in rig.clips[1:] for t in clip.tracks if t.path != "weights"} - self.joints
        if moved - self.scene.omitted:
            self.scene.lose(f"motion of {len(moved)} nodes that are not joints, in all clips but the first")
        uneven: dict[int, float] = {}
        tracks = usd_clips.tracks_of(self.clip)
        nodes = [n for n in range(len(rig)) if n not in self.joints and n not in self.scene.omitted]
        # A stage that sees prims one by one looks at all of their siblings each time.
        with Sdf.ChangeBlock():
            for node in nodes:
                parent = int(rig.parents[node])
                above, word = self.result.layer.GetPrimAtPath(paths[parent]), self.words[node]
                spec = Sdf.PrimSpec(above, word, Sdf.SpecifierDef, "Xform")
                paths[node] = f"{paths[parent]}/{word}"
                uneven[node] = usd_clips.write_xform(spec, rig, node, tracks.get(node, {}), self.rate)
                if rig.names[node] not in ("", word):
                    spec.SetInfo("displayName", rig.names[node])
                if node in self.scene.hidden and parent not in self.scene.hidden:
                    visible = Sdf.AttributeSpec(spec, "visibility", Sdf.ValueTypeNames.Token)
                    visible.default = UsdGeom.Tokens.invisible
                self.result.nodes[node] = (paths[node],)
        for node in set(nodes).intersection(self.scene.extras):
            extras = values.dictionary({"of": self.scene.extras[node]})["of"]
            self.stage.GetPrimAtPath(paths[node]).SetCustomDataByKey("extras", extras)
        slow = [rig.title(node) for node, off in uneven.items() if off > usd_clips.EVEN]
        if slow:
            self.scene.lose(
                f"slow rotations of {and_more(slow, 3)}, less than 0.51° between keys: OpenUSD plays them "
                f"up to {max(uneven.values()):.1e} rad off"
            )
        return paths

    def _skeletons(self, above: Mapping[int, str]) -> None:
        for skeleton in self.skeletons:
            word = self.names.unique(skeleton.name, "Skeleton")
            skeleton.path = f"{above[skeleton.parent]}/{word}"
            prim = UsdSkel.Skeleton.Define(self.stage, skeleton.path)
            if not skeleton.joints:
                skeleton.tokens = [self.words[skeleton.morphed]]
                bind = rest = np.eye(4)[np.newaxis]
            else:
                # Each once in its skeleton: characters of a crowd have the same, and so share animations.
                named = (
                    [each[node] for node in skeleton.joints] for each in (self.rig.names, self.rig.labels)
                )
                words, token = node_identifiers(*named), dict[int, str]()
                for node, word in zip(skeleton.joints, words, strict=True):
                    parent = token.get(int(self.rig.parents[node]))
                    token[node] = f"{parent}/{word}" if parent else word
                skeleton.tokens = [token[node] for node in skeleton.joints]
                bind = np.stack([skeleton.bind[node] for node in skeleton.joints])
                rest = self.rig.normalised_local[skeleton.joints]
                self._joint_names(prim, skeleton, words)
                for node in skeleton.joints:
                    self.result.nodes.setdefault(node, (skeleton.path, token[node]))
            prim.CreateJointsAttr(Vt.TokenArray(skeleton.tokens))
            prim.CreateBindTransformsAttr(values.matrices(bind))
            prim.CreateRestTransformsAttr(values.matrices(rest))

    def _joint_names(self, prim: Any, skeleton: Skeleton, words: list[str]) -> None:
        """The names that joints have in glTF, where they are others, and their extras."""
        names = [self.rig.names[node] or word for node, word in zip(skeleton.joints, words, strict=True)]
        if names != words:
            unique = distinct(names)
            some = sorted({f"'{old}'" for old, new in zip(names, unique, strict=True) if old != new})
            if some:
                self.scene.lose(f"that several joints are called {and_more(some, 3)}: they get numbers")
            prim.CreateJointNamesAttr(Vt.TokenArray(unique))
        extras = {
            token: self.scene.extras[node]
            for node, token in zip(skeleton.joints, skeleton.tokens, strict=True)
            if node in self.scene.extras
        }
        if extras:
            prim.GetPrim().SetCustomDataByKey("extras", values.dictionary(extras))

    def _materials(self) -> None:
        every = [one for some in self.scene.primitives.values() for one in some]
        used = {one.material for one in every if one.material is not None}
        coloured = {one.material for one in every if "COLOR_0" in one.surface.values}
        unused = [one.name for k, one in enumerate(self.scene.materials) if k not in used]
        if unused:
            self.scene.lose(f"materials that no mesh has ({and_more(unused, 3)})")
        if not used:
            return
        UsdGeom.Scope.Define(self.stage, f"{self.root}/Materials")
        writer = MaterialWriter(self.stage, self.scene, self._asset)
        names = Names()
        for number in sorted(used):
            material = self.scene.materials[number]
            word = names.unique(material.name, "Material")
            prim = writer.write(material, f"{self.root}/Materials/{word}", coloured=number in coloured)
            name_prim(prim.GetPrim(), material.name, word)
            self.primitives.bound[number] = str(prim.GetPath())

    def _asset(self, image: Image) -> str:
        path = self._place(image)
        self.result.images[path] = image
        return path

    def _clips(self) -> None:
        rig, names = self.rig, Names()
        holder = f"{self.root}/Animations"
        titles = clip_titles([clip.name for clip in rig.clips])
        for title, clip in counted([*zip(titles, rig.clips, strict=True)], "clips"):
            if clip.name and title != clip.name:
                self.scene.lose(f"that several clips are called '{clip.name}': one is '{title}'")
            found: dict[str, str] = {}
            known: dict[Any, str] = {}
            spare = ""
            played = usd_clips.played_scales(rig, self.skeletons, clip)
            self.result.halves.append(set(half_scales(rig, self.joints, clip, played)))
            tracks = usd_clips.tracks_of(clip)
            for skeleton in self.skeletons:
                shapes = self.primitives.shapes_of(skeleton)
                word, spare = spare or names.unique(title, "clip"), ""
                path = f"{holder}/{word}"
                if usd_clips.write_animation(self.stage, path, rig, skeleton, tracks, shapes, self.rate):
                    content = usd_clips.content_of(self.stage.GetPrimAtPath(path))
                    found[skeleton.path] = known.setdefault(content, path)
                    if found[skeleton.path] != path:  # that of another character of a crowd
                        self.stage.RemovePrim(path)
                        spare = word
                        continue
                    many = usd_clips.many_samples(self.stage.GetPrimAtPath(path), rig, clip)
                    self.scene.notices += [Notice("many-samples", many)] if many else []
                    name_prim(self.stage.GetPrimAtPath(path), title if clip.name else "", word)
            self.result.clips.append(found)
        for words in lost_scales(rig, self.joints, self.result.halves):
            self.scene.lose(words)
        for skeleton in self.skeletons:
            source = next((c[skeleton.path] for c in self.result.clips[:1] if skeleton.path in c), "")
            shapes = self.primitives.shapes_of(skeleton)
            resting = any(p.mesh.morph_weights.any() for k, _ in shapes for p in self.scene.primitives[k])
            if not source and shapes and resting:
                source = f"{holder}/{names.unique('rest')}"
                prim = UsdSkel.Animation.Define(self.stage, source)
                usd_clips.write_weights(prim, {}, shapes, rig, self.rate)
            if source:
                prim = UsdSkel.BindingAPI.Apply(self.stage.GetPrimAtPath(skeleton.path))
                prim.CreateAnimationSourceRel().SetTargets([source])
        if self.stage.GetPrimAtPath(holder):
            UsdGeom.Scope.Define(self.stage, holder)

    def _lenses(self, above: Mapping[int, str]) -> None:
        """Cameras and lights: below their nodes, or where these are joints baked to their motion."""
        kinds: Any = ((self.scene.cameras, define_camera), (self.scene.lights, define_light))
        for lenses, define in kinds:
            for node, lens in lenses.items():
                word = self.names.unique(lens.name or f"{self.words[node]}_lens", "lens")
                holder = above.get(node)
                prim = define(self.stage, f"{holder or self.root}/{word}", lens, self.scene)
                if prim is not None:
                    name_prim(prim.GetPrim(), lens.name, word)
                    if lenses is self.scene.lights:  # what is hidden can be looked from
                        hide(prim.GetPrim(), self.scene, node, above)
                    self.result.primitives.setdefault(node, []).append(str(prim.GetPath()))
                    if holder is None:
                        self._bake(prim, node)

    @cached_property
    def _half_scales(self) -> tuple[list[int], dict[int, Track]]:
        """The joints that half floats do not hold in the first clip, and how scales of joints play there."""
        clip = self.rig.clips[0]
        played = usd_clips.played_scales(self.rig, self.skeletons, clip)
        return half_scales(self.rig, self.joints, clip, played), played

    def _bake(self, prim: Any, node: int) -> None:
        rig = self.scene.rig
        if len(rig.clips) > 1:
            self.scene.lose(f"motion of {rig.title(node)}'s camera or light in clips but the first")
        small, place = rig.subset(rig.path_to_root(node))
        clip = small.clips[0] if small.clips else None
        if clip is None or not clip.tracks:
            frames = rig.normalised_world[node][np.newaxis]
            times = np.zeros(0)
        else:
            # Where the joints that it is on go, whose scales are half floats.
            halved, scales = self._half_scales
            joints = {place[joint] for joint in halved if joint in place}
            tracks = (replace(t, node=place[joint]) for joint, t in scales.items() if joint in place)
            small, clip = with_half_scales(small, clip, joints, {track.node: track for track in tracks})
            motion = Motion(small, clip)

            def sampled(times: Floats) -> Floats:
                return worlds(small, motion.locals_at(times))[:, place[node]]

            def looking(times: Floats) -> Floats:
                return looking_frames(sampled(times))

            # Where keys are sheared, what lies between them is not looked at as it is first.
            times, within = key_times(clip), (BAKED, self._judged_by[node])
            if not (skew(sampled(times)) > _SHEARED).any():
                times = frame_times(sampled, times, *within)
            if (skew(sampled(times)) > _SHEARED).any():
                times = frame_times(looking, times, *within)
            frames = sampled(times)
        rest = rig.normalised_world[node]
        # Shear comes of a scale and a rotation below it, and neither a camera nor a light has a size.
        if (skew(np.concatenate([frames, rest[np.newaxis]])) > _SHEARED).any():
            self.result.sheared.add(node)
            frames, rest = looking_frames(frames), looking_frames(rest)
            if node in self.scene.cameras:
                self.scene.lose(f"the shear of {rig.title(node)}'s camera, which stands and looks as before")
        parts = decompose(frames)
        names: tuple[Path, ...] = ("translation", "rotation", "scale")
        samples = {name: (times, part[:, np.newaxis]) for name, part in zip(names, parts, strict=True)}
        spec = self.result.layer.GetPrimAtPath(prim.GetPath())
        usd_clips.place_by(spec, samples, self.rate, dict(zip(names, decompose(rest), strict=True)))


def conversion_matrix(look: UsdLook) -> Floats:
    """What takes metres with y up to a stage's unit and axis, (4, 4)."""
    turned = identity()
    if look.up == "Z":
        turned = np.array([[1.0, 0, 0, 0], [0, 0, 1.0, 0], [0, -1.0, 0, 0], [0, 0, 0, 1.0]])
    scaled = turned / look.unit
    scaled[3, 3] = 1.0
    return np.asarray(scaled)
