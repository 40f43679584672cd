"""Channels of animations in JSON: which node each drives, another node for it, and taking some away."""

from __future__ import annotations

from typing import Any

import pytest

from rigtri.formats.gltf.animation_channels import (
    channels_by_sampler,
    drive_node,
    driven_attachment,
    drop_channels,
    drop_empty_animations,
)
from rigtri.formats.gltf.json_copy_on_write import CopyOnWrite


def pointing(pointer: Any) -> dict[str, Any]:
    return {"path": "pointer", "extensions": {"KHR_animation_pointer": {"pointer": pointer}}}


@pytest.mark.parametrize(
    ("target", "node"),
    [
        ({"path": "weights", "node": 3}, 3),
        ({"path": "weights", "node": 0}, 0),
        ({"path": "weights", "node": True}, None),
        ({"path": "weights"}, None),
        ({"path": "rotation", "node": 3}, None),
        (pointing("/nodes/4/weights"), 4),
        (pointing("/nodes/4/weights/0"), 4),
        (pointing("/nodes/4/extensions/KHR_lights_punctual/intensity"), 4),
        (pointing("/nodes/4/extensions/EXT_mesh_gpu_instancing/x"), 4),
        (pointing("/nodes/4/extensions/VENDOR_axis"), None),
        (pointing("/nodes/4/rotation"), None),
        (pointing("/nodes/x/weights"), None),
        (pointing("/meshes/4/weights"), None),
        (pointing(7), None),
        (None, None),
    ],
)
def test_the_node_whose_weights_lights_or_instances_a_channel_drives(target: Any, node: int | None) -> None:
    assert driven_attachment({"target": target} if target is not None else {}) == node


def test_a_channel_drives_another_node_by_number_or_by_pointer() -> None:
    channels = [
        {"sampler": 0, "target": {"path": "rotation", "node": 1}},
        {"sampler": 0, "target": pointing("/nodes/1/extensions/KHR_lights_punctual/color")},
    ]
    gltf = {"animations": [{}, {"channels": channels}]}
    draft = CopyOnWrite(gltf)
    for number in (0, 1):
        target = draft.edit("animations", 1, "channels", number, "target")
        drive_node(draft, (1, number), target, 12)
    by_number, by_pointer = draft.gltf["animations"][1]["channels"]
    assert by_number == {"sampler": 0, "target": {"path": "rotation", "node": 12}}
    assert by_pointer == {"sampler": 0, "target": pointing("/nodes/12/extensions/KHR_lights_punctual/color")}
    # What was read stays as it was.
    assert channels[0]["target"] == {"path": "rotation", "node": 1}
    assert channels[1]["target"] == pointing("/nodes/1/extensions/KHR_lights_punctual/color")


def test_dropped_channels_take_along_the_samplers_that_nobody_else_uses() -> None:
    samplers = [{"input": 10 * k} for k in range(4)]
    used = (0, 1, 2, 3, 1)
    channels = [{"sampler": k, "target": {"node": node}} for node, k in enumerate(used)]
    draft = CopyOnWrite({"animations": [{}, {"channels": channels, "samplers": samplers}]})
    assert channels_by_sampler(draft.gltf["animations"], {1}) == {(1, 0): 1, (1, 1): 2, (1, 2): 1, (1, 3): 1}
    drop_channels(draft, 1, {0, 1, 2})
    assert draft.gltf["animations"] == [
        {},
        {
            "channels": [{"sampler": 1, "target": {"node": 3}}, {"sampler": 0, "target": {"node": 4}}],
            "samplers": [{"input": 10}, {"input": 30}],
        },
    ]
    assert [channel["sampler"] for channel in channels] == [*used]


def test_animations_without_channels_are_dropped_and_an_empty_list_too() -> None:
    draft = CopyOnWrite({"animations": [{"channels": []}, {"channels": [1]}, {}]})
    drop_empty_animations(draft)
    assert draft.gltf == {"animations": [{"channels": [1]}]}
    draft = CopyOnWrite({"animations": [{"channels": []}]})
    drop_empty_animations(draft)
    assert draft.gltf == {}
    draft = CopyOnWrite({"animations": [{"channels": [1]}]})
    drop_empty_animations(draft)
    assert not draft.changed
