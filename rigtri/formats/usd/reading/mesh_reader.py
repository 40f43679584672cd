"""What skeletons move: skinned meshes, blend shapes and rigid points, read to measure.

Inbetweens of blend shapes are not read: their targets count as reached in a
straight line. Points are those of the Default time, else of the earliest sample.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property, partial
from itertools import chain
from typing import Any

import numpy as np
from pxr import Sdf, Usd, UsdGeom, UsdSkel

from rigtri.errors import FileError
from rigtri.formats.usd.composition.shared_instances import SharedInstances
from rigtri.formats.usd.composition.stage import DEFAULT, quiet
from rigtri.formats.usd.composition.time_samples import time_samples
from rigtri.formats.usd.composition.value_types import integers, usable, vectors
from rigtri.maths.arrays import Booleans, Integers
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Track
from rigtri.model.mesh import Mesh, Surface

EARLIEST = Usd.TimeCode.EarliestTime()
ALL_PRIMS = Usd.TraverseInstanceProxies()
# Influences looked through at once: they stay in a processor's cache.
_BLOCK = 1 << 16


class Bindings:
    """What is bound to which skeleton, found when first used: it walks the whole stage."""

    def __init__(self, instances: SharedInstances) -> None:
        self._instances = instances

    @cached_property
    def every(self) -> list[tuple[str, Any]]:
        """Skinned prims as (skeleton path, UsdSkel skinning query), those of instances included."""
        with quiet("USD cannot find what is bound to the skeletons"):
            return _bindings(self._instances)

    def of(self, skeletons: Collection[str]) -> list[Any]:
        """The skinning queries of some skeletons."""
        found = (self._by_skeleton.get(path, []) for path in set(skeletons))
        return [self.every[number][1] for number in sorted(chain.from_iterable(found))]

    @cached_property
    def _by_skeleton(self) -> Mapping[str, Sequence[int]]:
        """Where in `every` those of each skeleton are."""
        found: dict[str, list[int]] = {}
        for number, (path, _) in enumerate(self.every):
            found.setdefault(path, []).append(number)
        return found


def _bindings(instances: SharedInstances) -> list[tuple[str, Any]]:
    cache, found = UsdSkel.Cache(), []
    last: Any = None
    for prim in instances.prims():
        # A SkelRoot below another is part of it.
        nested = last is not None and prim.GetPath().HasPrefix(last)
        if prim.IsA(UsdSkel.Root) and not nested and not instances.is_twin(prim.GetPath()):
            root, last = UsdSkel.Root(prim), prim.GetPath()
            cache.Populate(root, ALL_PRIMS)
            for binding in cache.ComputeSkelBindings(root, ALL_PRIMS):
                path = str(binding.GetSkeleton().GetPath())
                found += [(path, query) for query in binding.GetSkinningTargets()]
    return found


def weighted(queries: Sequence[Any], tokens: Sequence[str]) -> Booleans:
    """Which joints of a skeleton move any point, (n,); all where nothing is bound to it."""
    mask = np.zeros(len(tokens), dtype=bool)
    bound = False
    with quiet("USD cannot find what the skeletons move"):
        for query in queries:
            pair = _influence_arrays(query, None) if query.HasJointInfluences() else None
            if pair is not None:
                bound = True
                order = _places(query, tokens)
                moving = _named(query, *pair, len(order))
                places = order[moving]
                mask[places[places >= 0]] = True
    return mask if bound else np.ones(len(tokens), dtype=bool)


def _named(query: Any, indices: Any, weights: Any, count: int) -> Booleans:
    """Which of ``count`` joints have weight in arrays of influences, (count,)."""
    found = np.zeros(count, dtype=bool)
    for first in range(0, len(indices), _BLOCK):
        named = indices[first : first + _BLOCK][weights[first : first + _BLOCK] != 0.0]
        _check_indices(query, named, count)
        found[named] = True
    return found


def read_meshes(
    prims: Iterable[Any],
    found: Sequence[tuple[str, Any]],
    node_of: Mapping[str, int],
    skins: Mapping[str, int],
    tokens: Mapping[str, Sequence[str]],
    animations: Mapping[str, Any],
) -> list[Mesh]:
    """The points of prims, with the morph weights that hold without samples: the defaults of animations.

    node_of: nodes by prim path. skins, tokens, animations (prims): by skeleton path.
    """
    by_prim = {str(query.GetPrim().GetPath()): (path, query) for path, query in found}
    meshes = []
    for prim in prims:
        path = str(prim.GetPath())
        if not prim.IsA(UsdGeom.PointBased) or path not in node_of:
            continue
        points = seen_at_start(UsdGeom.PointBased(prim).GetPointsAttr())
        if not points:
            continue
        mesh = Mesh(path, node_of[path], np.array(points, dtype=np.float64))
        skeleton, query = by_prim.get(path, ("", None))
        if query is not None and skeleton in skins:
            mesh = _skinned(mesh, query, skins[skeleton], tokens[skeleton])
        if mesh.morph_names and skeleton in animations:
            known = default_weights(animations[skeleton])
            weights = np.array([known.get(name, 0.0) for name in mesh.morph_names])
            mesh = replace(mesh, morph_weights=weights)
        meshes.append(replace(mesh, surface=partial(_surface, prim)))
    return meshes


def _surface(prim: Any) -> Surface:
    """Faces (or curves) and normals as authored."""
    names = ("faceVertexCounts", "curveVertexCounts")
    sizes = next((a for name in names if (a := _attribute(prim, name)) is not None), ())
    corners = _attribute(prim, "faceVertexIndices")
    normals = _attribute(prim, "primvars:normals")
    normals = _attribute(prim, "normals") if normals is None else normals
    return Surface(
        prim.GetTypeName(),
        integers(sizes),
        integers(corners),
        vectors(normals),
        {name: values for name, value in _drawn(prim) if (values := _array(value)) is not None},
    )


def _drawn(prim: Any) -> Iterator[tuple[str, Any]]:
    """Primvars such as colours, subsets of faces, and what blend shapes have besides offsets."""
    for primvar in UsdGeom.PrimvarsAPI(prim).FindPrimvarsWithInheritance():
        name = str(primvar.GetPrimvarName())
        if not name.startswith("skel:") and name != "normals":
            yield f"primvar {name}", flattened(primvar)
            yield f"interpolation of primvar {name}", str(primvar.GetInterpolation())
    for subset in UsdGeom.Subset.GetAllGeomSubsets(UsdGeom.Imageable(prim)):
        yield f"subset {subset.GetPrim().GetName()}", at_start(subset.GetIndicesAttr())
    shapes = prim.GetRelationship("skel:blendShapeTargets")
    for number, target in enumerate(shapes.GetForwardedTargets() if shapes else ()):
        shape = prim.GetStage().GetPrimAtPath(target)
        for attribute in shape.GetAuthoredAttributes() if shape else ():
            if attribute.GetName() == "normalOffsets" or attribute.GetName().startswith("inbetweens:"):
                yield f"{attribute.GetName()} of blend shape {number}", at_start(attribute)


def _array(value: Any) -> Any:
    """Numbers as float64, words as they are; None where there is neither."""
    if value is None:
        return None
    try:
        return np.array(value, dtype=np.float64)
    except (TypeError, ValueError):
        return np.array([str(word) for word in value] if hasattr(value, "__len__") else [str(value)])


def _attribute(prim: Any, name: str) -> Any:
    attribute = prim.GetAttribute(name)
    return at_start(attribute) if attribute else None


def at_start(attribute: Any) -> Any:
    """An attribute's value at the Default time, else at its earliest sample; None without either."""
    value = attribute.Get(DEFAULT)
    value = attribute.Get(EARLIEST) if value is None else value
    return None if isinstance(value, Sdf.UnregisteredValue) else value


def flattened(primvar: Any) -> Any:
    """A primvar's values without indices, at the Default time, else at its earliest sample; None without."""
    # USD raises an error for values without their indices: both from one time.
    return primvar.ComputeFlattened(_known_at(primvar.GetAttr(), primvar.GetIndicesAttr()))


def _known_at(*attributes: Any) -> Any:
    """The Default time where all attributes that are there have a value, else the earliest."""
    return EARLIEST if any(one and one.Get(DEFAULT) is None for one in attributes) else DEFAULT


def seen_at_start(attribute: Any) -> Any:
    """The same; None where UsdSkel does not read its type, too."""
    return usable(attribute, at_start(attribute))


def blend_names(animation: Any) -> list[str]:
    """The blend shapes that an animation has weights for, in their order."""
    order = animation.GetAttribute("blendShapes")
    return [str(name) for name in usable(order, order.Get(DEFAULT)) or ()] if order else []


def drives_shapes(animation: Any, queries: Sequence[Any]) -> bool:
    """Whether an animation has weights for blend shapes of some meshes."""
    names = set(blend_names(animation))
    return any(names & set(blend_order(query)) for query in queries)


def blend_order(query: Any) -> list[str]:
    """The names of a mesh's blend shapes in its order; none where UsdSkel has not one target for each."""
    order = [str(name) for name in query.GetBlendShapeOrder() or ()] if query.HasBlendShapes() else []
    return order if len(order) == len(_blend_targets(query)) else []


def _blend_targets(query: Any) -> Any:
    return query.GetPrim().GetRelationship("skel:blendShapeTargets").GetForwardedTargets()


def blend_tracks(
    animation: Any, queries: Sequence[Any], node_of: Mapping[str, int], interpolation: Any
) -> list[Track]:
    """The morph weights that an animation drives, as one track for each mesh it moves."""
    attribute = animation.GetAttribute("blendShapeWeights")
    names = blend_names(animation)
    keys = [(time, usable(attribute, value)) for time, value in time_samples(attribute)]
    keys = [(time, value) for time, value in keys if value is not None and len(value) == len(names)]
    if not keys:
        return []
    times = np.array([time for time, _ in keys])
    values = np.array([np.array(value, dtype=np.float64) for _, value in keys])
    values = np.concatenate([values, np.zeros((len(keys), 1))], axis=1)  # the last: not driven
    tracks = []
    for query in queries:
        path = str(query.GetPrim().GetPath())
        if (order := blend_order(query)) and path in node_of:
            columns = [names.index(name) if name in names else -1 for name in order]
            unlisted = frozenset(k for k, column in enumerate(columns) if column < 0)
            shown = values[:, columns]
            tracks.append(Track(node_of[path], "weights", interpolation, times, shown, unlisted=unlisted))
    return tracks


def default_weights(animation: Any) -> dict[str, float]:
    """The default weights of an animation by blend shape; none where they are not one for each."""
    names, weights = blend_names(animation), animation.GetAttribute("blendShapeWeights")
    values = usable(weights, weights.Get(DEFAULT)) if weights else None
    if values is None or len(values) != len(names):
        return {}
    return {name: float(value) for name, value in zip(names, values, strict=True)}


def _skinned(mesh: Mesh, query: Any, skin: int, tokens: Sequence[str]) -> Mesh:
    morphs = _morphs(query, len(mesh.points)) if query.HasBlendShapes() else mesh.morphs
    mesh = replace(
        mesh, morphs=morphs, morph_weights=np.zeros(len(morphs)), morph_names=tuple(blend_order(query))
    )
    if not query.HasJointInfluences():
        return mesh
    influences = _influences(query, tokens, len(mesh.points))
    if influences is None:
        return mesh
    joints, weights = influences
    when = _known_at(query.GetGeomBindTransformAttr())
    return replace(
        mesh,
        skin=skin,
        joints=joints,
        weights=weights,
        bind=np.array(query.GetGeomBindTransform(when), dtype=np.float64),
        dual_quaternion=str(query.GetSkinningMethod()) == "dualQuaternion",
        raw_weights=True,
    )


def _influences(query: Any, tokens: Sequence[str], points: int) -> tuple[Integers, Floats] | None:
    """Joint indices of the skeleton and weights, (v, k); unmatched influences weigh nothing.

    points: how many, to spread constant influences over.
    None where UsdSkel has no use for them and leaves the points where they are.
    FileError for an index that no joint has, though it weighs something.
    """
    pair = _influence_arrays(query, points)
    if pair is None:
        return None
    width = max(query.GetNumInfluencesPerComponent(), 1)
    # Indices in their own type, as USD holds them: of large meshes a copy takes as much memory as the points.
    indices, weights = pair[0].reshape(-1, width), pair[1].astype(np.float64).reshape(-1, width)
    order = _places(query, tokens)
    usable = _usable(indices, len(order))
    if usable is not None:
        indices = indices.copy()
        _check_indices(query, indices[~usable & (weights != 0.0)], len(order))
        indices[~usable], weights[~usable] = 0, 0.0
    if not np.array_equal(order, np.arange(len(order))):
        indices = order[indices]
        if (usable := _usable(indices, len(tokens))) is not None:
            indices[~usable], weights[~usable] = 0, 0.0
    return indices, weights


def _influence_arrays(query: Any, points: int | None) -> tuple[Any, Any] | None:
    """Joint indices and weights as USD has them, at the Default time, else at the earliest sample.

    points: how many, to spread constant influences over; None leaves one row for all. None without any.
    """
    for time in (DEFAULT, EARLIEST):
        if points is None:
            pair = query.ComputeJointInfluences(time)
        else:
            pair = query.ComputeVaryingJointInfluences(points, time)
        if pair and len(pair[0]):
            break
    width = max(query.GetNumInfluencesPerComponent(), 1)
    if not pair or len(pair[0]) % width or len(pair[0]) != len(pair[1]):
        return None
    return np.asarray(pair[0]), np.asarray(pair[1])


def _places(query: Any, tokens: Sequence[str]) -> Integers:
    """Which joints of the skeleton the indices of a mesh mean, (o,); −1 for one that it does not have."""
    index = {token: number for number, token in enumerate(tokens)}
    own = query.GetJointOrder()
    return np.array([index.get(str(t), -1) for t in own], dtype=np.int64) if own else np.arange(len(tokens))


def _usable(indices: Integers, count: int) -> Booleans | None:
    """Which indices are joints; None where all are."""
    if indices.min(initial=0) >= 0 and indices.max(initial=-1) < count:
        return None
    return np.asarray((indices >= 0) & (indices < count))


def _check_indices(query: Any, named: Integers, count: int) -> None:
    """FileError for an index that no joint has."""
    lost = _usable(named, count)
    if lost is not None:
        raise FileError(
            f"<{query.GetPrim().GetPath()}>.primvars:skel:jointIndices names joint {named[~lost][0]}, "
            f"and it has the joints 0 to {count - 1}. Export it again."
        )


def _morphs(query: Any, count: int) -> Floats:
    """Offsets of a mesh's blend shapes, (t, v, 3), in the mesh's own order."""
    prim = query.GetPrim()
    targets = _blend_targets(query)
    morphs = np.zeros((len(targets), count, 3))
    for row, target in zip(morphs, targets, strict=True):
        shape = prim.GetStage().GetPrimAtPath(target)
        offsets = seen_at_start(shape.GetAttribute("offsets")) if shape else None
        if not offsets:
            continue
        where = seen_at_start(shape.GetAttribute("pointIndices"))
        rows = np.array(where, dtype=np.int64) if where else np.arange(count)
        if len(rows) == len(offsets) and rows.max(initial=0) < count:
            row[rows] = np.array(offsets, dtype=np.float64)
    return morphs
