"""Animations of a glTF file as clips.

Source: glTF 2.0 §3.11; KHR_animation_pointer.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any, NamedTuple, NoReturn

import numpy as np

from rigtri.errors import FileError
from rigtri.formats.gltf.accessors import Accessors
from rigtri.formats.gltf.node_reader import Tree, title
from rigtri.formats.gltf.rules import (
    NON_UNIT,
    WIDTH,
    count_violation,
    interpolation_violation,
    node_violation,
    refuse,
    sampler_violation,
    time_violations,
    time_width_violation,
    twice_violation,
    value_width_violation,
)
from rigtri.formats.json_values import Value, name_in
from rigtri.maths.quaternions import norm
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Column, Interpolation, Path, Tracks
from rigtri.report import Notice

POINTER = "KHR_animation_pointer"
# Below this length float32 has too few digits left for a direction (2⁻¹²⁶, its smallest normal number).
_LEAST = float(np.finfo(np.float32).tiny)
_NODE_POINTER = re.compile(r"/nodes/(0|[1-9][0-9]{0,8})/(translation|rotation|scale|weights)")


def target_of(channel: dict[str, Any]) -> tuple[int, str] | None:
    """The node and property that a channel drives; None where it drives something else.

    The node is the file's own number, in range or not. A pointer to a node's
    property is the same as a channel with that node and path.
    """
    target = channel.get("target")
    if type(target) is not dict:
        return None
    path = target.get("path")
    if path == "pointer":
        found = _NODE_POINTER.fullmatch(pointer_of(target) or "")
        return (int(found[1]), found[2]) if found else None
    node = target.get("node")
    if type(node) is not int or path not in ("translation", "rotation", "scale", "weights"):
        return None
    return node, path


def pointer_of(target: Mapping[str, Any]) -> str | None:
    """The pointer of a channel's target, None where there is none."""
    extensions = target.get("extensions")
    found = extensions.get(POINTER) if isinstance(extensions, dict) else None
    pointer = found.get("pointer") if isinstance(found, dict) else None
    return pointer if isinstance(pointer, str) else None


def animated_matrices(gltf: Value) -> set[int]:
    """File indices of nodes with a matrix whose translation, rotation or scale is animated."""
    matrices = {k for k, node in enumerate(gltf.object().get("nodes", [])) if "matrix" in node}
    found: set[int] = set()
    for animation in gltf.each("animations"):
        channels = animation.get("channels")
        for number, channel in enumerate(channels.entries() if channels is not None else ()):
            if type(channel) is not dict:
                Value(channel, f"{animation.where}.channels[{number}]").object()
            # Most files have no matrices, and many thousands of channels.
            target = target_of(channel) if matrices else None
            if target is not None and target[1] in WIDTH:
                found.add(target[0])
    return found & matrices


class _Alike(NamedTuple):
    """What the channels of a column share. times: their bytes. width: numbers of a value."""

    path: Path
    interpolation: Interpolation
    times: bytes
    width: int


class _Channel(NamedTuple):
    """What a channel has of its own; number: among the channels. input, output: its accessors."""

    number: int
    node: int
    input: int
    output: int


_Groups = dict[_Alike, list[_Channel]]


class ClipReader:
    """Reads the animations of one file; notices collects what it could live with.

    like: that of the file that this one was made of; what is the same is taken from there, and then neither
    read by channel nor compared.
    """

    def __init__(
        self,
        gltf: Value,
        accessors: Accessors,
        tree: Tree,
        notices: list[Notice],
        like: ClipReader | None,
        *,
        lenient: bool,
    ) -> None:
        self._gltf, self._accessors, self._tree = gltf, accessors, tree
        self._notices, self._lenient = notices, lenient
        self._nodes = gltf.object().get("nodes", [])
        self._times: dict[int, Floats] = {}
        self._groups_of: list[_Groups | None] = []
        self._like = like
        self._content: dict[int, bytes] = {}
        self._rising: dict[bytes, bytes] = {}  # times that are in order: most tracks have the same

    def read(self) -> tuple[Clip, ...]:
        """All animations as clips. FileError, naming animation and channel, for what is broken."""
        # Some NaN are signalling ones: no warnings about them; set once, not for each accessor.
        with np.errstate(invalid="ignore"):
            clips = tuple(
                self._clip(number, animation)
                for number, animation in enumerate(self._gltf.each("animations"))
            )
        for clip in clips:
            self._check_values(clip)
        return clips

    def _clip(self, number: int, animation: Value) -> Clip:
        name = name_in(animation.object())
        groups = self._known_groups(number, animation.raw)
        if groups is None:
            noticed = len(self._notices)
            groups = self._groups(animation, f"{self._gltf.where} animation '{name}' (#{number})")
            self._groups_of.append(groups if len(self._notices) == noticed else None)
        else:
            self._groups_of.append(groups)
        columns = [self._column(number, *group) for group in groups.items()]
        return Clip(name, Tracks(columns), key=number)

    def _known_groups(self, number: int, animation: Any) -> _Groups | None:
        """The channels of an animation that is the same in the file that this one was made of."""
        like = self._like
        if like is None or number >= len(like._groups_of) or self._accessors.known is not like._accessors:
            return None
        groups, place = like._groups_of[number], like._tree.place
        if groups is None or any(alike.path == "weights" for alike in groups):
            return None
        if self._tree.place[: len(place)] != place or animation != like._gltf.raw["animations"][number]:
            return None
        inputs = {channel.input for channels in groups.values() for channel in channels}
        same = all(self._input(k, self._gltf.where) is like._times[k] for k in inputs)
        return groups if same else None

    def _groups(self, animation: Value, where: str) -> _Groups:
        """The channels of an animation by what they share."""
        samplers = Value(animation.object().get("samplers", []), f"{where} samplers").entries()
        channels = Value(animation.object().get("channels", []), f"{where} channels").entries()
        groups: _Groups = {}
        seen: dict[tuple[int, str], int] = {}
        for index, channel in enumerate(channels):
            place = f"{where} channel {index}"
            if type(channel) is not dict:
                raise FileError(f"{place}: an object should stand here")
            target = target_of(channel)
            if target is None:
                self._wonder(channel, place)
                continue  # no node of ours: kept, never read
            node, path = target
            if violation := node_violation(node, len(self._nodes)):
                refuse(f"{place}:", violation)
            if target in seen:
                refuse(f"{place}:", twice_violation(title(self._nodes, node), path, seen[target]))
            seen[target] = index
            try:
                alike, own = self._channel(channel, samplers, target, index, place)
                groups.setdefault(alike, []).append(own)
            except FileError as error:
                if path != "weights":
                    raise
                # Morph weights are only looked at; nothing wrong with them may cost an edit of the rig.
                text = f"{error} (morph weights are kept, but not checked)"
                self._notices.append(Notice("weights-unread", text))
        return groups

    def _wonder(self, channel: dict[str, Any], place: str) -> None:
        """Say that a channel may drive a joint in a way that rigtri does not know."""
        target = channel.get("target")
        path = target.get("path") if isinstance(target, dict) else None
        if path in (*WIDTH, "weights") or (path == "pointer" and pointer_of(channel["target"]) is not None):
            return
        text = f"{place}: the path {path!r} is unknown to glTF; the channel is kept as it is"
        self._notices.append(Notice("channel-unknown", text))

    def _channel(
        self, channel: dict[str, Any], samplers: list[Any], target: tuple[int, Any], index: int, place: str
    ) -> tuple[_Alike, _Channel]:
        node, path = target
        width = WIDTH.get(path) or self._morph_targets(node, place)
        number: Any = channel.get("sampler")
        if violation := sampler_violation(number, len(samplers)):
            refuse(f"{place}:", violation)
        sampler = samplers[number]
        if type(sampler) is not dict:
            Value(sampler, f"{place}: sampler {number}").object()
        interpolation = sampler.get("interpolation", "LINEAR")
        if violation := interpolation_violation(interpolation):
            refuse(f"{place}:", violation)
        source = sampler.get("input")
        times = self._input(source, place)
        output = self._accessor(sampler.get("output"), place, "output")
        rows, columns = self._accessors.readable(output)
        if path == "weights" and rows * columns % width == 0:
            rows, columns = rows * columns // width, width
        violation = value_width_violation(path, width, columns)
        violation = violation or count_violation(len(times), rows, interpolation)
        if violation:
            refuse(f"{place}:", violation)
        alike = _Alike(path, interpolation, self._content[source], width)
        return alike, _Channel(index, self._tree.place[node], source, output)

    def _column(self, number: int, alike: _Alike, channels: list[_Channel]) -> Column:
        """The tracks of channels with the same path, interpolation and times, read at once."""
        times = [self._times[channel.input] for channel in channels]
        values = self._accessors.read_alike([channel.output for channel in channels])
        per_key = (3,) if alike.interpolation == "CUBICSPLINE" else ()
        places = [channel.number for channel in channels]
        return Column(
            alike.path,
            alike.interpolation,
            times[0],
            np.array([channel.node for channel in channels], dtype=np.int64),
            values.reshape(len(channels), len(times[0]), *per_key, alike.width),
            [(number, place) for place in places],
            times,
            places,
        )

    def _accessor(self, index: Any, place: str, what: str) -> int:
        if type(index) is not int or not 0 <= index < len(self._accessors):
            raise FileError(f"{place}: its {what} is accessor {index!r}, the file has {len(self._accessors)}")
        return index

    def _input(self, index: Any, place: str) -> Floats:
        times = self._times.get(index) if type(index) is int else None
        if times is None:
            index = self._accessor(index, place, "input")
            times = self._accessors.read_aloud(index)
            if violation := time_width_violation(times.shape[1]):
                refuse(f"{place}:", violation)
            content, known = times.tobytes(), None if self._like is None else self._like._times.get(index)
            if content not in self._rising:
                for violation in time_violations(times[:, 0], lenient=self._lenient):
                    refuse(f"{place}:", violation)
            # One object for all that are the same, so that they are compared sooner.
            self._content[index] = content = self._rising.setdefault(content, content)
            times = times[:, 0] if known is None or known.tobytes() != content else known
            self._times[index] = times
        return times

    def _morph_targets(self, node: int, place: str) -> int:
        mesh = self._nodes[node].get("mesh")
        meshes = self._gltf.object().get("meshes", [])
        if type(mesh) is not int or not 0 <= mesh < len(meshes):
            raise FileError(f"{place}: node #{node} has no mesh whose weights it could drive")
        for primitive in Value(meshes[mesh], f"{self._gltf.where} meshes[{mesh}]").each("primitives"):
            targets = list(primitive.each("targets"))
            if targets:
                return len(targets)
        raise FileError(f"{place}: the mesh of node #{node} has no morph targets")

    def _check_values(self, clip: Clip) -> None:
        """No NaN, no zero rotation; one look at all values, a second only where something is wrong."""
        columns = [column for column in clip.columns if column.path != "weights"]
        if columns and not np.isfinite(np.concatenate([c.values.ravel() for c in columns])).all():
            self._refuse(clip, ("translation", "rotation", "scale"), "is not a number", _is_lost)
        keys = [column.key_values.reshape(-1, 4) for column in columns if column.path == "rotation"]
        if not keys:
            return
        size = norm(np.concatenate(keys))
        if (size < _LEAST).any():
            like = "is" if (size == 0).any() else "is as good as"
            self._refuse(clip, ("rotation",), f"{like} 0 0 0 0, which is not a rotation", _is_zero)
        off = float(np.abs(size - 1.0).max())
        if off > NON_UNIT:
            name = f"animation '{clip.name}' (#{clip.key})"
            text = f"Rotations of {name} are not unit, the worst is off by {off:.2g}"
            self._notices.append(Notice("rotation-not-unit", text))

    def _refuse(self, clip: Clip, paths: tuple[str, ...], what: str, wrong: Any) -> NoReturn:
        for track in (track for track in clip.tracks if track.path in paths):
            keys = np.argwhere(wrong(track.values))
            if len(keys):
                number, channel = track.key if isinstance(track.key, tuple) else (0, 0)
                name = self._gltf.object()["animations"][number].get("name", "")
                raise FileError(
                    f"{self._gltf.where} animation '{name}' (#{number}) channel {channel}: "
                    f"{track.path} key {keys[0][0]} {what}; export the animation again"
                )
        raise AssertionError("a wrong value was seen and is gone")


def _is_lost(values: Floats) -> Any:
    return ~np.isfinite(values).all(axis=-1)


def _is_zero(values: Floats) -> Any:
    zero = norm(values) < _LEAST
    # Tangents may well be zero.
    return zero[:, 1] if zero.ndim == 2 else zero
