"""Relationships of rigtri's prims to the prims and skeletons that their metadata refer to.

Composition carries targets along, as it does no text (`reading.node_references`). Relationships hold a
target once, so that a list of references has the number of its target for each of them.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from pxr import Sdf, Vt

from rigtri.errors import FileError
from rigtri.formats.usd.composition.stage import refuse
from rigtri.formats.usd.opinions.edits import Edit
from rigtri.formats.usd.opinions.instance_edits import instance_of
from rigtri.formats.usd.opinions.variant_paths import why_unkeyable
from rigtri.formats.usd.reading.metadata_attributes import INDICES, PREFIX, TARGET, Metadata, attribute_name
from rigtri.formats.usd.reading.node_keys import kind, parts
from rigtri.formats.usd.reading.source import Source
from rigtri.model.metadata import Place, with_references
from rigtri.model.rig import Rig

# What a constraint moves.
CHILD = attribute_name(("child",))[0]
# Targets by relationship; an empty path for what is nowhere.
Relations = Mapping[str, list[Any]]


def reference_edits(
    source: Source, rig: Rig, made: Mapping[int, Any], skeletons: Mapping[int, Any], now: Callable[[Any], Any]
) -> list[Edit]:
    """Edits of the relationships of prims that are new, that refer to others, or whose targets are renamed.

    made: the paths of new prims. skeletons: those of the skeletons of new joints. now: a path after renaming.
    FileError where a prim inside an instance would refer to one outside, and for a new constraint of a prim
    that cannot get keys.
    """
    before, found = source.rig, []
    for node, metadata in rig.metadata.items():
        old = Sdf.Path(rig.labels[node]) if kind(rig.keys[node]) == "prim" else None
        path = made.get(node, old)
        if path is None or node in rig.pending.removed:
            continue
        relations = _relations(rig, metadata, {**skeletons, **made})
        moved = {name: [now(target) for target in targets] for name, targets in relations.items()}
        same = old is not None and dict(metadata) == dict(before.metadata.get(node, {}))
        if (moved or old is not None) and (not same or moved != relations):
            _refuse_outside(source, path, relations)
            if not same and metadata.get("type") == "constraint":
                children = (source.stage.GetPrimAtPath(child) for child in relations[CHILD] if child)
                refuse("; ".join(filter(None, (why_unkeyable(child) for child in children if child))))
            found.append(_relate(now(path), moved))
    return found


def _refuse_outside(source: Source, path: Any, relations: Relations) -> None:
    """FileError where a prim inside an instance would refer to one outside, which composition drops."""
    if (instance := instance_of(source.stage, path)) is None:
        return
    for target in (target for targets in relations.values() for target in targets):
        if not target.isEmpty and not target.HasPrefix(instance.GetPath()):
            raise FileError(
                f"'{Sdf.Path(path).name}' would be in <{instance.GetPath()}>, an instance, and refer to "
                f"<{target}>, which is outside: what instances share can refer to nothing else. Make "
                f"<{instance.GetPath()}> no instance (instanceable = false), then run this again"
            )


def portable(rig: Rig, metadata: Metadata, skeleton: str = "") -> dict[str, Any]:
    """Metadata in which joints have their tokens in the place of paths, which other stages change.

    skeleton: of its joints alone, for metadata that have no relationships.
    """

    def token(_: Place, name: str) -> str:
        node = rig.known(name)
        key = () if node is None else parts(rig.keys[node])
        if node is None or name == rig.names[node] or key[:1] != ("joint",) or skeleton not in ("", key[1]):
            return name
        return str(key[2])  # labels keep the names that joints had

    return dict(with_references(metadata, token))


def _relations(rig: Rig, metadata: Metadata, made: Mapping[int, Any]) -> Relations:
    found: dict[str, list[Any]] = {}

    def collect(place: Place, name: str) -> str:
        node = rig.known(name)
        path = Sdf.Path.emptyPath
        if node is not None:
            path = made.get(node) or Sdf.Path(str(parts(rig.keys[node])[1]) if parts(rig.keys[node]) else "")
        found.setdefault(attribute_name(place)[0], []).append(path)
        return name

    with_references(metadata, collect)
    return found


def _relate(path: Any, relations: Relations) -> Edit:
    """Give a prim these relationships, and no others to what its metadata refer to."""

    def edit(layer: Any) -> None:
        spec = Sdf.CreatePrimInLayer(layer, path)
        # Files of older versions have the drivers of constraints as `rigtri:source`.
        stale = [name for name in spec.relationships.keys() if name.startswith(PREFIX)]  # noqa: SIM118
        for name in stale:
            del spec.properties[name]
            indices = name.removesuffix(TARGET) + INDICES
            if name.endswith(TARGET) and indices in spec.attributes:
                del spec.properties[indices]
        for name, paths in relations.items():
            targets = [target for target in dict.fromkeys(paths) if not target.isEmpty]
            if not targets:
                continue
            relation = Sdf.RelationshipSpec(spec, name + TARGET, custom=True)
            relation.targetPathList.explicitItems = targets
            if len(targets) > 1 or Sdf.Path.emptyPath in paths:
                types, uniform = Sdf.ValueTypeNames, Sdf.VariabilityUniform
                numbers = [-1 if target.isEmpty else targets.index(target) for target in paths]
                attribute = Sdf.AttributeSpec(
                    spec, name + INDICES, types.IntArray, uniform, declaresCustom=True
                )
                attribute.default = Vt.IntArray(numbers)

    return Edit(Sdf.Path(path), edit)
