"""A USD file as Blender writes it after an import with guides: names, prims and metadata as they come back.

An Xform above one thing that is no Xform goes, and that has its transform; a name that is taken
gets a number; what an object shows is a prim of its name below it; of metadata, relationships and lists are
dropped; all stands below an Xform called root.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from pathlib import Path
from typing import Any

from pxr import Sdf, Usd, UsdGeom, UsdSkel


def through_blender(source: Path, target: Path) -> Path:
    """What Blender writes of a file, at the place of target."""
    flat = Usd.Stage.Open(Usd.Stage.Open(str(source)).Flatten())
    made = Usd.Stage.CreateNew(str(target))
    for name in ("upAxis", "metersPerUnit", "timeCodesPerSecond", "startTimeCode", "endTimeCode"):
        if flat.HasAuthoredMetadata(name):
            made.SetMetadata(name, flat.GetMetadata(name))
    UsdGeom.Xform.Define(made, "/root")
    written = _Written(flat, made)
    for prim in _shown(flat.GetPseudoRoot()):
        written.object(prim, Sdf.Path("/root"))
    written.bind()
    made.SetDefaultPrim(made.GetPrimAtPath("/root"))
    made.Save()
    return target


def _shown(prim: Any) -> Iterator[Any]:
    """What are objects in Blender of what is below a prim."""
    for child in prim.GetChildren():
        if child.IsA(UsdGeom.Imageable) and child.GetTypeName() != "GeomSubset":
            yield child


class _Written:
    def __init__(self, flat: Any, made: Any) -> None:
        self.flat, self.made = flat, made
        self.taken: set[str] = set()
        self.at: dict[Any, Any] = {}

    def _name(self, name: str) -> str:
        free = name
        number = 0
        while free in self.taken:
            number += 1
            free = f"{name}_{number:03}"
        self.taken.add(free)
        return free

    def object(self, prim: Any, parent: Any) -> None:
        """One object and what is below it."""
        merged, inside = [prim], list(_shown(prim))
        if prim.GetTypeName() == "Xform" and len(inside) == 1 and inside[0].GetTypeName() != "Xform":
            merged.append(prim := inside[0])
            inside = list(_shown(prim))
        path = parent.AppendChild(self._name(prim.GetName()))
        kind = "SkelRoot" if prim.GetTypeName() == "Skeleton" else "Xform"
        xform = self.made.DefinePrim(path, kind)
        for each in merged:
            self._stand(each, xform)
            _copy(each, xform, ("rigtri:", "userProperties:rigtri"))
            self.at[each.GetPath()] = path
        if prim.GetTypeName() not in ("Xform", "Scope", "SkelRoot", ""):
            self._data(prim, path.AppendChild(path.name))
        for child in inside:
            skeleton = UsdSkel.BindingAPI(child).GetInheritedSkeleton()
            bound = child.GetTypeName() == "Mesh" and skeleton
            self.object(child, self.at[skeleton.GetPath()] if bound else path)

    def _stand(self, prim: Any, xform: Any) -> None:
        """The transform of a prim; merged ones have no more than one."""
        ours = UsdGeom.Xformable(prim)
        if ours and ours.GetOrderedXformOps():
            assert not UsdGeom.Xformable(xform).GetOrderedXformOps()
            _copy(prim, xform, ("xformOp",))

    def _data(self, prim: Any, path: Any) -> None:
        data = self.made.DefinePrim(path, prim.GetTypeName())
        _copy(prim, data, ("",), without=("xformOp", "rigtri:", "userProperties:rigtri"))
        if prim.HasAuthoredMetadata("apiSchemas"):
            data.SetMetadata("apiSchemas", prim.GetMetadata("apiSchemas"))
        self.at[prim.GetPath(), "data"] = path

    def bind(self) -> None:
        """Skeletons with their animations below them, and meshes below their skeletons' prims."""
        for prim in self.flat.Traverse():
            new = self.at.get((prim.GetPath(), "data"))
            if new is None:
                continue
            binding = UsdSkel.BindingAPI(prim)
            made = UsdSkel.BindingAPI(self.made.GetPrimAtPath(new))
            if prim.GetTypeName() == "Skeleton":
                self._animate(binding.GetInheritedAnimationSource(), new, made)
            elif skeleton := binding.GetInheritedSkeleton():
                made.CreateSkeletonRel().SetTargets([self.at[skeleton.GetPath(), "data"]])

    def _animate(self, animation: Any, path: Any, made: Any) -> None:
        if animation:
            path = path.AppendChild(animation.GetName())
            _copy(animation, self.made.DefinePrim(path, "SkelAnimation"), ("",))
            made.CreateAnimationSourceRel().SetTargets([path])


def _copy(source: Any, target: Any, starts: Collection[str], without: Collection[str] = ()) -> None:
    """Attributes of a prim whose names begin so; not lists of rigtri, which Blender does not import."""
    for one in source.GetAuthoredAttributes():
        name = one.GetName()
        ours = name.startswith("rigtri:")
        if not name.startswith(tuple(starts)) or name.startswith(tuple(without)):
            continue
        if not (ours and one.GetTypeName().isArray):
            Sdf.CopySpec(_layer(source), one.GetPath(), _layer(target), target.GetPath().AppendProperty(name))


def _layer(prim: Any) -> Any:
    return prim.GetStage().GetRootLayer()
