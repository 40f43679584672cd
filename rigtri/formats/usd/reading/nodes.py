"""The nodes of a rig, collected from the prims of a stage and the joints of its skeletons."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Mapping
from typing import Any

import numpy as np
from pxr import Usd, UsdGeom

from rigtri.formats.usd.composition.animation_binding import within_scene
from rigtri.formats.usd.composition.shared_instances import SharedInstances
from rigtri.formats.usd.composition.stage import DEFAULT
from rigtri.formats.usd.composition.time_samples import has_splines, ops_times
from rigtri.formats.usd.composition.value_types import ignored
from rigtri.formats.usd.identifiers import identifier
from rigtri.formats.usd.reading import joint_tokens, mesh_reader, metadata_attributes
from rigtri.formats.usd.reading.skeleton_reader import Skeleton
from rigtri.maths.matrices import compose, decompose, identity
from rigtri.model.format_rules import FormatRules
from rigtri.model.metadata import ADDED, damage, illegible
from rigtri.model.rig import Rig
from rigtri.report import Notice, SameNotices

# rigtri's prims have translate, orient and scale; a transform that these cannot hold is somebody else's.
OWN_PLACE = 1e-9


_STORED = "What rigtri stored on "


class Nodes:
    """Nodes in columns. animated: prims that their ops move; own: prims of rigtri."""

    def __init__(self, stage: Any, instances: SharedInstances, warnings: list[Notice]) -> None:
        self.stage, self.instances, self.warnings = stage, instances, warnings
        self._same = SameNotices(warnings)
        self.names: list[str] = []
        self.parents: list[int] = []
        self.matrices: list[np.ndarray] = []
        self.keys: list[tuple[str, ...]] = []
        self.labels: list[str] = []
        self.attachment: list[int] = []
        self.own: list[int] = []  # prims of rigtri, which keep their transform as TRS
        self.metadata: dict[int, dict[str, Any]] = {}
        self.restless: list[str] = []  # prims of rigtri that are no controls, with samples and no default
        self.fixed: dict[int, str] = {}
        self.unlisted: dict[int, str] = {}
        self.animated: dict[int, Any] = {}  # prims that their ops move over time
        self.node_of: dict[str, int] = {}
        self.joint_nodes: dict[str, dict[str, int]] = {}

    def add_prims(self) -> list[Any]:
        """Add every prim with a transform; returns the Skeleton and SkelAnimation prims of the scene."""
        others = []
        placeless = self.instances.placeless()
        above: dict[Any, int] = {}
        for prim in self.instances.prims():
            path = prim.GetPath()
            parent = above.get(path.GetParentPath(), -1)
            above[path] = parent
            kind = prim.GetTypeName()
            if kind in ("Skeleton", "SkelAnimation"):
                others.append(prim)
            group = kind == "Scope" and prim.HasAttribute("rigtri:type")
            # An instance among others that may get another place must not get it.
            still = group or path in placeless
            if prim.IsA(UsdGeom.Xformable) or still:
                above[path] = self._add_prim(prim, parent, still)
        if self.restless:
            more = f" and {len(self.restless) - 1} more" if len(self.restless) > 1 else ""
            text = (
                f"The file has no rest position of '{self.restless[0]}'{more} (time samples without a "
                "default value), and limbs are recognised by it; "
                "give a file that has it with rigtri bake --rig"
            )
            self.warnings.append(Notice("rest-lost", text))
        up = UsdGeom.GetStageUpAxis(self.stage)
        if up not in (UsdGeom.Tokens.y, UsdGeom.Tokens.z):
            text = f"upAxis is '{up}', which USD does not define; Y is taken. Set it to Y or Z"
            self.warnings.append(Notice("up-axis", text))
        return within_scene(self.instances.prims(), others)

    def _add_prim(self, prim: Any, parent: int, still: bool) -> int:
        node, path = len(self.names), str(prim.GetPath())
        metadata = metadata_attributes.read_prim(prim)
        made = not illegible(metadata) and metadata["type"] in ADDED
        if still:
            local = np.eye(4)
        else:
            xformable = UsdGeom.Xformable(prim)
            if ops_times(xformable):
                self.animated[node] = prim
                if made and metadata["type"] != "control" and _moment(xformable) != DEFAULT:
                    self.restless.append(str(prim.GetName()))
            # The rest value of an op of rigtri is its default; without, it is the identity.
            moment = _moment(xformable) if node in self.animated and not made else DEFAULT
            local = np.array(xformable.GetLocalTransformation(moment), dtype=np.float64)
            if not np.isfinite(local).all():
                text = f"The ops of <{path}> give no finite matrix; it is measured as if it had none."
                self.warnings.append(Notice("no-place", text))
                local = np.eye(4)
            parent = -1 if xformable.GetResetXformStack() else parent
        self._add(prim.GetName(), parent, local, ("prim", path), path)
        self.node_of[path] = node
        if _shows(prim):
            self.attachment[node] = node
        if prim.IsA(UsdGeom.PointBased):
            self.warnings += [Notice("type-ignored", text) for text in ignored(prim)]
        if metadata and not self._unread(path, metadata):
            self.metadata[node] = metadata
            self.own.append(node)
        return node

    def _add(self, name: str, parent: int, local: np.ndarray, key: tuple[str, ...], label: str) -> None:
        self.names.append(name)
        self.parents.append(parent)
        self.matrices.append(local)
        self.keys.append(key)
        self.labels.append(label)
        self.attachment.append(-1)

    def add_joints(self, skeletons: Collection[Skeleton]) -> None:
        """Add the joints of all skeletons.

        The label of a token that several have, or that is the path of a prim, names its skeleton, too.
        """
        counts = Counter(token for skeleton in skeletons for token in skeleton.tokens)
        counts.update(self.node_of)
        for skeleton in skeletons:
            self._add_joints(skeleton, self.owner(skeleton.path), counts)
            nodes = self.joint_nodes[skeleton.path]
            stored = metadata_attributes.read_joints(self.stage.GetPrimAtPath(skeleton.path))
            for token, metadata in stored.items():
                if token in nodes and not self._unread(token, metadata):
                    self.metadata[nodes[token]] = metadata

    def owner(self, path: str) -> int:
        """The node of a prim, or of the nearest above it that has a place; −1 for none."""
        while path and path not in self.node_of:
            path = path.rpartition("/")[0]
        return self.node_of.get(path, -1)

    def _add_joints(self, skeleton: Skeleton, owner: int, counts: Mapping[str, int]) -> None:
        first = len(self.names)
        nodes = {token: first + number for number, token in enumerate(skeleton.tokens)}
        self.joint_nodes[skeleton.path] = nodes
        before = joint_tokens.unsplit(skeleton.tokens, self._holders(skeleton))
        known = dict(zip(skeleton.tokens, before, strict=True))
        for number, token in enumerate(skeleton.tokens):
            parent = int(skeleton.parents[number])
            self._add(
                token.rpartition("/")[2],
                owner if parent < 0 else first + parent,
                skeleton.rest[number],
                ("joint", skeleton.path, known[token]),
                f"{skeleton.path}:{token}" if counts[token] > 1 else token,
            )
            if skeleton.locked:
                self.fixed[first + number] = skeleton.locked
            if skeleton.path in skeleton.animations and parent < 0 and "/" in token:
                self.unlisted[first + number] = token.rpartition("/")[0]

    def _holders(self, skeleton: Skeleton) -> set[str]:
        """The tokens of joints that only hold the axes of the one below them."""
        found = metadata_attributes.read_joints(self.stage.GetPrimAtPath(skeleton.path))
        return {
            token
            for token, metadata in found.items()
            if metadata.get("type") == "frame" and "joint" in metadata
        }

    def _unread(self, title: str, metadata: Mapping[str, Any]) -> bool:
        """Whether another version has stored metadata, which are reported and left alone then."""
        why = illegible(metadata)
        if why:
            self._same.add("note-unread", _STORED, f"'{title}'", f" stays as it is: {why}")
        elif broken := damage(metadata):
            self._same.add("note-damaged", _STORED, f"'{title}'", f" is damaged and is not used: {broken}")
        return bool(why)

    def rig(self) -> Rig:
        """The nodes so far as a rig without skins and clips."""
        count = len(self.names)
        matrix = np.array(self.matrices, dtype=np.float64).reshape(-1, 4, 4)
        has_matrix = np.ones(count, dtype=bool)
        with np.errstate(invalid="ignore"):
            translation, rotation, scale = decompose(matrix)
        # A frame that is flat or sheared has no rotation; the matrix holds all there is.
        whole = np.all(np.isfinite(rotation), axis=1, keepdims=True)
        rotation = np.where(whole, rotation, (0.0, 0, 0, 1))
        composed = compose(translation, rotation, scale)
        for node in self.own:
            has_matrix[node] = bool(np.abs(composed[node] - matrix[node]).max() > OWN_PLACE)
        up = (0.0, 0.0, 1.0) if UsdGeom.GetStageUpAxis(self.stage) == "Z" else (0.0, 1.0, 0.0)
        return Rig(
            names=tuple(self.names),
            parents=np.array(self.parents, dtype=np.int64),
            translation=translation,
            rotation=rotation,
            scale=scale,
            matrix=np.where(has_matrix[:, np.newaxis, np.newaxis], matrix, identity(count)),
            has_matrix=has_matrix,
            attachment=np.array(self.attachment, dtype=np.int64),
            keys=tuple(self.keys),
            labels=tuple(self.labels),
            metadata=dict(self.metadata),
            rules=FormatRules(
                fixed=dict(self.fixed),
                unlisted=dict(self.unlisted),
                up=up,
                metres_per_unit=float(UsdGeom.GetStageMetersPerUnit(self.stage)),
                sized_binding=True,
                raw_quaternions=True,
                linear=True,
                instances={
                    self.node_of[str(path)]: self.node_of[str(first)]
                    for path, first in self.instances.twins().items()
                    if str(path) in self.node_of
                },
                skeletons=frozenset(self.node_of[path] for path in self.joint_nodes if path in self.node_of),
                valid_name=identifier,
            ),
        )


def _moment(xformable: Any) -> Any:
    """When a prim is at rest: at the Default time, or at its start where it has only time samples."""
    attributes = [op.GetAttr() for op in xformable.GetOrderedXformOps()]
    if not any(at.Get(DEFAULT) is None for at in attributes):
        return DEFAULT
    # The earliest time of all is where a spline has gone on beyond its first knot.
    return ops_times(xformable)[0] if has_splines(xformable.GetPrim()) else mesh_reader.EARLIEST


def _holds_skeletons(prim: Any) -> bool:
    return any(each.GetTypeName() == "Skeleton" for each in Usd.PrimRange(prim))


def _shows(prim: Any) -> bool:
    return bool(
        prim.IsA(UsdGeom.Gprim)
        or prim.IsA(UsdGeom.Camera)
        or (prim.IsA(UsdGeom.PointInstancer) and not _holds_skeletons(prim))
        or prim.GetTypeName().endswith("Light")
    )
