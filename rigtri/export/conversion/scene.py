"""What glTF and USD have in common: a rig with what its nodes show, independent of either format."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from typing import Any, Literal

import numpy as np

from rigtri.model.animation import Clip
from rigtri.model.dataclass import dataclass
from rigtri.model.mesh import Mesh, Surface
from rigtri.model.rig import Rig
from rigtri.operations.bake.unbaked import unbaked
from rigtri.report import Notice
from rigtri.text import and_more

Slot = Literal["base", "metal_rough", "normal", "occlusion", "emissive", "coat", "coat_rough"]
Colour = tuple[float, float, float]


# File systems have 255 bytes for a name; a part that is being written has more in its name than the file.
_STEM_BYTES = 160


def short_stem(stem: str) -> str:
    """As much of the name of an image as a file system surely allows: prompts can be names, too.

    >>> short_stem("skin"), len(short_stem("手" * 100))
    ('skin', 53)
    """
    return stem.encode("utf-8", "replace")[:_STEM_BYTES].decode("utf-8", "ignore")


@dataclass(frozen=True)
class Image:
    """An image file. name: a plain file name with its suffix, unique in the scene."""

    name: str
    content: bytes


@dataclass(frozen=True)
class Texture:
    """An image on a surface, in glTF's terms: v runs downwards.

    texcoord: the number of the texture coordinates. wrap: ``repeat``, ``clamp`` or ``mirror`` for u and v.
    offset, rotation (radians), scale: KHR_texture_transform.
    """

    image: Image
    texcoord: int = 0
    wrap: tuple[str, str] = ("repeat", "repeat")
    offset: tuple[float, float] = (0.0, 0.0)
    rotation: float = 0.0
    scale: tuple[float, float] = (1.0, 1.0)

    @property
    def is_transformed(self) -> bool:
        return (self.offset, self.rotation, self.scale) != ((0.0, 0.0), 0.0, (1.0, 1.0))


@dataclass(frozen=True)
class Material:
    """A metallic-roughness material, in glTF's terms; each texture is multiplied by its factor."""

    name: str
    base: tuple[float, float, float, float] = (1.0, 1.0, 1.0, 1.0)
    metallic: float = 1.0
    roughness: float = 1.0
    emissive: Colour = (0.0, 0.0, 0.0)
    alpha: Literal["OPAQUE", "MASK", "BLEND"] = "OPAQUE"
    cutoff: float = 0.5
    double_sided: bool = False
    unlit: bool = False
    normal_scale: float = 1.0
    occlusion_strength: float = 1.0
    clearcoat: float = 0.0
    clearcoat_roughness: float = 0.0
    ior: float = 1.5
    textures: Mapping[Slot, Texture] = field(default_factory=dict)
    extras: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Camera:
    """A camera that looks along −z. height: yfov in radians, or the whole height of what an orthographic one
    shows; aspect: width by height, None for the viewport's; far: None for infinite."""

    name: str
    orthographic: bool
    height: float
    aspect: float | None
    near: float
    far: float | None


@dataclass(frozen=True)
class Light:
    """A light that shines along −z: ``directional`` in lux, ``point`` or ``spot`` in candela; angles in
    radians.
    """

    name: str
    kind: str
    colour: Colour = (1.0, 1.0, 1.0)
    intensity: float = 1.0
    inner: float = 0.0
    outer: float = 0.7853981633974483


@dataclass(frozen=True, eq=False)
class Primitive:
    """A mesh of one material. material: its number in the scene. shared: equal where two nodes show the
    same.
    """

    mesh: Mesh
    surface: Surface
    name: str
    material: int | None = None
    shared: Any = None


@dataclass(eq=False)
class Scene:
    """All that is converted; what is not, is in ``lost``, in words for users. notices: what else to know.

    primitives, cameras, lights, extras: by node. hidden: nodes that are not shown. omitted: those that are
    left out. up: ``Y`` or ``Z``; unit: the metres of one length unit. per_second: the time units of
    clips in a second. played: clips by name as the source's own library plays them, as far as the other
    format can say it, and where that is less also as they are. grains: how far that
    library rounds the angles of nodes, in radians.
    """

    rig: Rig
    name: str
    primitives: dict[int, list[Primitive]] = field(default_factory=dict)
    materials: list[Material] = field(default_factory=list)
    cameras: dict[int, Camera] = field(default_factory=dict)
    lights: dict[int, Light] = field(default_factory=dict)
    extras: dict[int, Any] = field(default_factory=dict)
    hidden: set[int] = field(default_factory=set)
    omitted: set[int] = field(default_factory=set)
    copyright: str = ""
    up: Literal["Y", "Z"] = "Y"
    unit: float = 1.0
    per_second: float = 1.0
    played: dict[str, tuple[Clip, Clip | None]] = field(default_factory=dict)
    grains: dict[int, float] = field(default_factory=dict)
    lost: list[str] = field(default_factory=list)
    notices: list[Notice] = field(default_factory=list)

    def lose(self, what: str) -> None:
        """Note what the other format cannot store; the same words only once."""
        if what not in self.lost:
            self.lost.append(what)

    def omit_built(self) -> None:
        """Leave out what rigtri has added to the rig, but joints, and note what goes with it.

        What others have put below it stays, and what that stands below.
        """
        rig = self.rig
        joints = {*np.flatnonzero(rig.is_joint).tolist(), *(k for s in rig.skins for k in s.joints.tolist())}
        own = rig.own - joints
        others = {below for node in own for below in rig.below(node)} - own | rig.showing
        own -= rig.with_ancestors(joints | others)
        self.omitted.update(own)
        if own:
            self.lose(f"the rig that rigtri has added ({len(own)} nodes): build it again on the output")
        if motion := unbaked(rig) if own else "":
            self.lose(f"motion that only controls have. {motion}: rigtri bake --to joints first")
        if stored := [node for node in sorted(rig.metadata) if node not in own]:
            names = and_more([f"'{rig.title(node)}'" for node in stored], 6)
            self.lose(f"what rigtri has stored on {names}: plain nodes in the output")
