"""Channels of animations in the JSON of a glTF file: which node each drives, and taking some away.

Source: glTF 2.0 §3.11; KHR_animation_pointer.
"""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

from rigtri.formats.gltf.animation_reader import POINTER, pointer_of
from rigtri.formats.gltf.json_copy_on_write import CopyOnWrite
from rigtri.text import is_number


def drop_channels(draft: CopyOnWrite, number: int, lost: Collection[int]) -> None:
    """Take channels out of an animation, and the samplers that only they were using."""
    animation = draft.edit("animations", number)
    channels = animation.get("channels", [])
    kept = [channel for k, channel in enumerate(channels) if k not in lost]
    used = {channel.get("sampler") for channel in kept}
    gone = {channels[k].get("sampler") for k in lost} - used
    places = [k for k in range(len(animation.get("samplers", []))) if k not in gone]
    moved = {old: new for new, old in enumerate(places)}
    animation["samplers"] = [animation["samplers"][k] for k in places]
    animation["channels"] = [
        channel
        if moved.get(channel.get("sampler"), channel.get("sampler")) == channel.get("sampler")
        else {**channel, "sampler": moved[channel["sampler"]]}
        for channel in kept
    ]


def drop_empty_animations(draft: CopyOnWrite) -> None:
    """An animation without channels is not allowed; nothing refers to animations by number."""
    animations = draft.gltf.get("animations", [])
    if any(not animation.get("channels") for animation in animations):
        kept = [animation for animation in animations if animation.get("channels")]
        draft.edit("animations")[:] = kept
        if not kept:
            draft.gltf.pop("animations")


def channels_by_sampler(animations: list[Any], among: set[int]) -> dict[tuple[int, int], int]:
    """How many channels use each sampler of some animations."""
    users: dict[tuple[int, int], int] = {}
    for number in among:
        for channel in animations[number].get("channels", []):
            sampler = channel.get("sampler")
            if type(sampler) is int:
                users[number, sampler] = users.get((number, sampler), 0) + 1
    return users


def driven_attachment(channel: Any) -> int | None:
    """The node whose morph weights, lights or instances a channel drives."""
    target = channel.get("target")
    if not isinstance(target, dict):
        return None
    if target.get("path") == "weights":
        node = target.get("node")
        return node if type(node) is int else None
    pointer = (pointer_of(target) or "").split("/")
    shown = pointer[3:4] == ["weights"] or pointer[3:5] in (
        ["extensions", "KHR_lights_punctual"],
        ["extensions", "EXT_mesh_gpu_instancing"],
    )
    return int(pointer[2]) if pointer[1:2] == ["nodes"] and shown and is_number(pointer[2]) else None


def drive_node(draft: CopyOnWrite, place: tuple[int, int], target: dict[str, Any], node: int) -> None:
    """Let a channel drive another node, by number or by pointer."""
    pointer = pointer_of(target)
    if target.get("path") != "pointer" or pointer is None:
        target["node"] = node
        return
    parts = pointer.split("/")
    parts[2] = str(node)
    path = ("animations", place[0], "channels", place[1], "target", "extensions", POINTER)
    draft.edit(*path)["pointer"] = "/".join(parts)
