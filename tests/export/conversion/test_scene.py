"""What a conversion leaves out of what rigtri has built, and what it says of that."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from rigs import chain

from rigtri.export.conversion.scene import Image, Scene, Texture
from rigtri.maths.quaternions import IDENTITY
from rigtri.model.animation import Clip, Track
from rigtri.model.rig import Rig
from rigtri.operations.add_controls import AddControlsOptions, add_controls


@pytest.fixture
def rig() -> Rig:
    bare = chain((0, 0, 0), (1, 0, 0), (2, 0.3, 0), (3, 0, 0))
    return add_controls(bare, options=AddControlsOptions(joints=("b", "c")))


BUILT = "the rig that rigtri has added (5 nodes): build it again on the output"


def test_all_that_was_built_is_left_out_and_its_nodes_are_counted(rig: Rig) -> None:
    scene = Scene(rig, "scene")
    scene.omit_built()
    names = {rig.names[node] for node in scene.omitted}
    assert names == {"rigtri_controls", "b_ctl_offset", "b_ctl", "c_ctl_offset", "c_ctl"}
    assert scene.lost == [BUILT]


def test_what_others_have_put_below_stays_as_do_joints_and_what_is_above_them(rig: Rig) -> None:
    control = rig.find("b_ctl")
    more = rig.with_nodes(["prop", "hook"], [control, control], np.zeros((2, 3)), np.tile(IDENTITY, (2, 1)))
    hook = more.find("hook")
    skin = more.skins[0]
    joined = replace(
        skin,
        joints=np.append(skin.joints, hook),
        inverse_bind=np.concatenate([skin.inverse_bind, np.eye(4)[np.newaxis]]),
    )
    scene = Scene(replace(more, skins=(joined,)), "scene")
    scene.omit_built()
    names = {more.names[node] for node in scene.omitted}
    assert names == {"c_ctl_offset", "c_ctl"}


def test_motion_that_only_controls_have_is_named_and_what_is_stored_on_joints(rig: Rig) -> None:
    control = rig.find("b_ctl")
    keys = Track(control, "translation", "LINEAR", np.array([0.0, 1.0]), np.array([[0.0, 0, 0], [0, 1, 0]]))
    stored = rig.metadata | {rig.find("d"): {"v": 1, "type": "other"}}
    scene = Scene(replace(rig, clips=(Clip("wave", (keys,)),), metadata=stored), "scene")
    scene.omit_built()
    built, motion, kept = scene.lost
    assert built == BUILT
    assert motion.startswith("motion that only controls have. ")
    assert "in clip 'wave'" in motion
    assert motion.endswith(": rigtri bake --to joints first")
    assert kept == "what rigtri has stored on 'd': plain nodes in the output"


def test_of_a_rig_without_anything_built_nothing_is_said() -> None:
    scene = Scene(chain((0, 0, 0), (1, 0, 0)), "scene")
    scene.omit_built()
    assert (scene.omitted, scene.lost) == (set(), [])


def test_the_same_words_are_noted_once() -> None:
    scene = Scene(chain((0, 0, 0), (1, 0, 0)), "scene")
    for what in ("fog", "smoke", "fog"):
        scene.lose(what)
    assert scene.lost == ["fog", "smoke"]


@pytest.mark.parametrize("change", [{"offset": (0.0, 0.5)}, {"rotation": 0.1}, {"scale": (2.0, 1.0)}])
def test_a_texture_is_transformed_by_any_of_its_three(change: dict[str, object]) -> None:
    plain = Texture(Image("a.png", b""), texcoord=2, wrap=("clamp", "mirror"))
    assert not plain.is_transformed
    assert replace(plain, **change).is_transformed
