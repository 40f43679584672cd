"""What a page must carry to show a USD file: one layer with all that is composed, and its textures."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from tempfile import gettempdir
from typing import Any

from pxr import Sdf, Usd, UsdGeom, UsdShade, UsdSkel

from rigtri.errors import FileError
from rigtri.formats.document import FOUR, Embedded
from rigtri.formats.image_types import KINDS, shows
from rigtri.formats.usd.composition import layers
from rigtri.formats.usd.composition.stage import quiet
from rigtri.formats.usd.composition.value_types import usable
from rigtri.formats.usd.reading.mesh_reader import EARLIEST

# The bytes of the texture that an asset path names; FileError where they are not to be had.
Images = Callable[[Any], bytes]


def embedded(stage: Any, path: Path, images: Images) -> Embedded:
    """A stage as one crate; variants as they are chosen, instances as prims of their own."""
    whole = Usd.Stage.Open(stage.GetRootLayer(), Usd.Stage.LoadAll)
    # The session is this stage's own: nothing reaches the layers of the file.
    whole.SetEditTarget(whole.GetSessionLayer())
    while instances := [prim for prim in whole.Traverse() if prim.IsInstance()]:
        for prim in instances:
            prim.SetInstanceable(False)
    flat = Usd.Stage.Open(whole.Flatten())
    _bind(whole, flat)
    files: dict[str, bytes | Path] = {}
    lacking = list(dict.fromkeys(_unseen(whole)))
    for prim in whole.Traverse():
        if prim.IsA(UsdShade.Shader):
            _textures(prim, flat, files, lacking, images)
    with quiet(f"{path} as one layer in the temporary folder {gettempdir()}: USD cannot write it"):
        content = layers.to_bytes(flat.GetRootLayer(), "usdc")
    return Embedded("usd", content, files, tuple(lacking))


def _bind(whole: Any, flat: Any) -> None:
    """Write at every skinned mesh, and every skeleton, what it inherits of bindings from prims above."""
    for prim in whole.Traverse():
        binding = UsdSkel.BindingAPI(prim)
        other = flat.GetPrimAtPath(prim.GetPath())
        if prim.IsA(UsdGeom.Mesh):
            skeleton = binding.GetInheritedSkeleton()
            if skeleton:
                UsdSkel.BindingAPI(other).CreateSkeletonRel().SetTargets([skeleton.GetPath()])
                _spread(prim, other)
        elif prim.IsA(UsdSkel.Skeleton):
            animation = binding.GetInheritedAnimationSource()
            targets = [animation.GetPath()] if animation and animation.IsActive() else []
            UsdSkel.BindingAPI(other).CreateAnimationSourceRel().SetTargets(targets)


def _spread(prim: Any, other: Any) -> None:
    """Give every point the joints that USD has once for all points of a mesh."""
    attribute = UsdGeom.Mesh(prim).GetPointsAttr()
    points = usable(attribute, attribute.Get(EARLIEST)) or ()
    own, binding = UsdSkel.BindingAPI(prim), UsdSkel.BindingAPI(other)
    pairs = (
        (own.GetJointIndicesPrimvar(), binding.CreateJointIndicesPrimvar),
        (own.GetJointWeightsPrimvar(), binding.CreateJointWeightsPrimvar),
    )
    for primvar, create in pairs:
        values = usable(primvar.GetAttr(), primvar.Get(EARLIEST)) if primvar else None
        if values and primvar.GetInterpolation() == UsdGeom.Tokens.constant:
            create(False, len(values)).Set(list(values) * len(points))


def _unseen(whole: Any) -> Iterator[str]:
    """What three.js shows otherwise than USD."""
    for prim in whole.Traverse():
        if not prim.IsA(UsdGeom.Mesh):
            continue
        binding = UsdSkel.BindingAPI(prim)
        relation = binding.GetBlendShapeTargetsRel()
        shapes = map(whole.GetPrimAtPath, relation.GetForwardedTargets() if relation else ())
        blend_shapes = (UsdSkel.BlendShape(prim) for prim in shapes if prim and prim.IsA(UsdSkel.BlendShape))
        if any(shape.GetInbetweens() for shape in blend_shapes):
            yield "blend shapes with inbetweens are shown without these, in a straight line"
        method = UsdGeom.PrimvarsAPI(prim).FindPrimvarWithInheritance("primvars:skel:skinningMethod")
        if method and method.Get() == UsdSkel.Tokens.dualQuaternion:
            yield "meshes that are skinned by dual quaternions are shown as if they were not"
        joints = binding.GetJointIndicesPrimvar()
        if joints and joints.GetElementSize() > 4:
            yield FOUR


def _textures(
    shader: Any, flat: Any, files: dict[str, bytes | Path], lacking: list[str], images: Images
) -> None:
    """Take the images of a shader along under plain names, which ``flat`` then has for them."""
    for given in shader.GetAttributes():
        asset = given.Get()
        if given.GetTypeName() != Sdf.ValueTypeNames.Asset or asset is None or not asset.path:
            continue
        try:
            content = images(asset)
        except FileError as error:
            lacking.append(str(error))
            continue
        if not shows(content):
            lacking.append(f"the texture '{asset.path}' is not shown: it is not one of {KINDS}")
            continue
        name = f"texture{len(files)}{Path(asset.path.rstrip(']')).suffix.lower()}"
        files[name] = content
        flat.GetPrimAtPath(shader.GetPath()).GetAttribute(given.GetName()).Set(Sdf.AssetPath(name))
