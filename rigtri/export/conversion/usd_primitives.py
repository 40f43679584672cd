"""The primitives of nodes as prims of the stage: bound, named, and once where several nodes show the same."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Hashable, Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np
from pxr import UsdGeom, UsdShade, UsdSkel, Vt

from rigtri.export.conversion import usd_meshes
from rigtri.export.conversion.scene import Primitive, Scene
from rigtri.export.conversion.usd_joint_scales import scalings
from rigtri.export.conversion.usd_names import Names, name_prim
from rigtri.export.conversion.usd_skeletons import Skeleton
from rigtri.maths.arrays import Integers
from rigtri.maths.matrices import multiply
from rigtri.maths.trigonometry import Floats
from rigtri.model.mesh import Mesh
from rigtri.model.rig import Rig


def hide(prim: Any, scene: Scene, node: int, above: Mapping[int, str]) -> None:
    """Hide what a node shows that is hidden and has no prim of its own: a joint, or below one."""
    if node in scene.hidden and node not in above:
        UsdGeom.Imageable(prim).MakeInvisible()


class PrimitiveWriter:
    """bound: the paths of materials by their numbers; of the stage's other writers."""

    def __init__(
        self,
        stage: Any,
        scene: Scene,
        rig: Rig,
        sizes: Floats,
        skeletons: Sequence[Skeleton],
        joints: set[int],
        names: Names,
        root: str,
    ) -> None:
        self.stage, self.scene, self.rig, self.sizes = stage, scene, rig, sizes
        self.skeletons, self.joints, self.names, self.root = skeletons, joints, names, root
        self.bound: dict[int, str] = {}
        self._prototypes: dict[Hashable, str] = {}

    def write(self, node: int, primitive: Primitive, above: Mapping[int, str]) -> str:
        """The path of the prim that a node's primitive has become; "" where it cannot be said."""
        skeleton = self._moved_by(node, primitive.mesh)
        holder = above[node] if skeleton is None or node in above else above[skeleton.parent]
        path = f"{holder}/{self.names.unique(primitive.name, 'Mesh')}"
        key = self._sharing(node, primitive)
        if self._sharers[key] > 1 and skeleton is not None and key not in self._prototypes:
            # A later edit of one character's mesh is none of another's, so all refer to a prim of nobody.
            base = f"{self._classes}/{path.rpartition('/')[2]}"
            if self._define(base, node, primitive, skeleton) is None:
                return ""
            self._prototypes[key] = base
        if key in self._prototypes:
            first = self.stage.GetPrimAtPath(self._prototypes[key])
            prim = self.stage.DefinePrim(path, first.GetTypeName())
            prim.GetReferences().AddInternalReference(first.GetPath())
        else:
            prim = self._define(path, node, primitive, skeleton)
            if prim is None:
                return ""
            if skeleton is None:
                self._prototypes[key] = path
        name_prim(prim, primitive.name, prim.GetName())
        hide(prim, self.scene, node, above)
        if primitive.material is not None:
            material = UsdShade.Material.Get(self.stage, self.bound[primitive.material])
            UsdShade.MaterialBindingAPI.Apply(prim).Bind(material)
        if skeleton is not None:
            self._bind(prim, primitive, node, skeleton)
        return path

    def shapes_of(self, skeleton: Skeleton) -> dict[tuple[int, int], str]:
        """The blend shapes of the meshes of a skeleton, by node and number of the morph target."""
        return self._shapes_of[id(skeleton)]

    @cached_property
    def _shapes_of(self) -> defaultdict[int, dict[tuple[int, int], str]]:
        found = defaultdict[int, dict[tuple[int, int], str]](dict)
        for key, name in self._shapes.items():
            for one in self.scene.primitives[key[0]]:
                if len(one.mesh.morphs):
                    found[id(self._moved_by(key[0], one.mesh))][key] = name
        return found

    @cached_property
    def _sharers(self) -> Counter[Hashable]:
        """How many nodes show each primitive in the same way."""
        every = self.scene.primitives.items()
        return Counter(self._sharing(node, one) for node, some in every for one in some)

    @cached_property
    def _classes(self) -> Any:
        """The prim that holds what several nodes show, and shows nothing itself."""
        return self.stage.CreateClassPrim(f"{self.root}/{self.names.unique('Meshes')}").GetPath()

    def _sharing(self, node: int, primitive: Primitive) -> Hashable:
        """What prims have in common that can be one: points, and the rows of the joints that move them."""
        skeleton = self._moved_by(node, primitive.mesh)
        if skeleton is None or primitive.mesh.skin is None:
            return primitive.shared, skeleton if skeleton is None else node
        return primitive.shared, self._rows(primitive.mesh.skin, skeleton).tobytes()

    def _rows(self, skin: int, skeleton: Skeleton) -> Integers:
        """The rows of a skin's joints in a skeleton."""
        return np.array(
            [skeleton.row[joint] for joint in self.rig.skins[skin].joints.tolist()], dtype=np.int64
        )

    def _define(self, path: str, node: int, primitive: Primitive, skeleton: Skeleton | None) -> Any:
        """A prim with the points of a primitive, and what moves them; None for what cannot be said."""
        mesh = primitive.mesh
        sided = primitive.material is not None and self.scene.materials[primitive.material].double_sided
        made = usd_meshes.define(self.stage, path, primitive, self.scene, double_sided=sided)
        if made is None or skeleton is None:
            return made and made.GetPrim()
        if mesh.skin is not None:
            usd_meshes.influence(made, *usd_meshes.influences(mesh, self._rows(mesh.skin, skeleton)))
        else:
            usd_meshes.influence(made, np.full((1, 1), skeleton.row.get(node, 0)), np.ones((1, 1)))
        if len(mesh.morphs):
            usd_meshes.blend_shapes(self.stage, made, mesh, primitive.surface, self._tokens(node, mesh))
        return made.GetPrim()

    def _bind(self, prim: Any, primitive: Primitive, node: int, skeleton: Skeleton) -> None:
        mesh = primitive.mesh
        place = skeleton.skins[mesh.skin] if mesh.skin is not None else None
        if place is None:
            place = multiply(scalings(self.sizes[node]), skeleton.bind.get(node, np.eye(4)))
        usd_meshes.bind(prim, skeleton.path, place)
        tokens, binding = self._tokens(node, mesh), UsdSkel.BindingAPI(prim)
        if tokens and list(binding.GetBlendShapesAttr().Get()) != tokens:
            binding.CreateBlendShapesAttr(Vt.TokenArray(tokens))
            targets = binding.GetBlendShapeTargetsRel().GetTargets()
            for target, name, token in zip(targets, mesh.morph_names, tokens, strict=False):
                name_prim(self.stage.GetPrimAtPath(target), name, token)

    def _tokens(self, node: int, mesh: Mesh) -> list[str]:
        return [self._shapes[node, k] for k in range(len(mesh.morphs))]

    def _moved_by(self, node: int, mesh: Mesh) -> Skeleton | None:
        """The Skeleton that moves a mesh of a node, None for none."""
        if mesh.skin is not None:
            return self._movers["skin", mesh.skin]
        if node in self.joints:
            return self._movers["joint", node]
        return self._movers["morphs", node] if len(mesh.morphs) else None

    @cached_property
    def _movers(self) -> dict[tuple[str, int], Skeleton]:
        """The Skeletons of skins, joints, and nodes with morph targets alone: of each the first."""
        found: dict[tuple[str, int], Skeleton] = {}
        for skeleton in reversed(self.skeletons):
            found.update({("skin", skin): skeleton for skin in skeleton.skins})
            found.update({("joint", joint): skeleton for joint in skeleton.joints})
            found["morphs", skeleton.morphed] = skeleton
        return found

    @cached_property
    def _shapes(self) -> dict[tuple[int, int], str]:
        """The blend shapes of all meshes, by node and number of the morph target: each once in a Skeleton."""
        names, found = defaultdict[int, Names](Names), {}
        for node, primitives in self.scene.primitives.items():
            mesh = primitives[0].mesh
            for k in range(max(len(p.mesh.morphs) for p in primitives)):
                name = mesh.morph_names[k] if k < len(mesh.morph_names) else f"target_{k}"
                found[node, k] = names[id(self._moved_by(node, mesh))].unique(name, "target")
        return found
