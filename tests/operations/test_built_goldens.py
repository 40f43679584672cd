"""What commands build and set, as a rigger reads it: name, parent, kind, place, axes, shape, colour."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
import pytest
from baked_rigs import rigged, with_keyed_controls
from conftest import Golden
from places import SAMPLES, slow

import rigtri
from rigtri.evaluation import sampling
from rigtri.evaluation.sampling import worlds
from rigtri.maths.matrices import nearest_rotation
from rigtri.maths.trigonometry import Floats
from rigtri.model.rig import Rig

AT = "walk@0.5"
# A share of the height that a rigger would see.
SEEN = 0.01


def numbers(values: Iterable[float]) -> str:
    return " ".join(f"{round(float(value), 6) + 0.0:9.6f}" for value in values)


def placed(world: Floats) -> str:
    """Its place, and where its x and y axes point."""
    x, y, _ = nearest_rotation(world)
    return f"at {numbers(world[3, :3])}  x {numbers(x)}  y {numbers(y)}"


def built(rig: Rig) -> str:
    """A line for each node that rigtri has built."""
    lines = []
    for node in sorted(rig.own):
        parent = int(rig.parents[node])
        above = rig.names[parent] if parent >= 0 else "-"
        note = rig.metadata[node]
        kind = f"{note['type']} {note.get('kind', '')}".strip()
        line = f"{rig.names[node]:26} under {above:26} {kind:12} {placed(rig.world[node])}"
        if note.get("shape"):
            line += f"  {note['shape']} {note['size']:.6f} colour {numbers(note['color'])}"
        lines.append(line)
    return "\n".join(lines) + "\n"


def standing(rig: Rig, nodes: Iterable[int]) -> str:
    """A line for each node as it stands at rest."""
    return "".join(f"{rig.names[k]:26} {placed(rig.world[k])}\n" for k in nodes)


def moment(rig: Rig, clip: str, time: float, nodes: Iterable[int]) -> str:
    """A line for each node as it stands in a clip."""
    world = worlds(rig, sampling.locals_at(rig, rig.clip(clip), [time]))[0]
    return "".join(f"{rig.names[k]:26} {placed(world[k])}\n" for k in nodes)


@pytest.mark.parametrize("name", ["biped.glb", slow("biped.usda"), slow("tpose.glb")])
def test_controls_of_a_whole_character(name: str, golden: Golden) -> None:
    rig = rigtri.add_controls(rigtri.read(SAMPLES / name), whole_character=True)
    golden.check(f"add-controls_{name}.txt", built(rig))


@pytest.mark.ci
def test_a_root_control_that_is_too_high_by_what_one_sees_is_noticed(golden: Golden) -> None:
    if golden.update:
        return
    rig = rigtri.add_controls(rigtri.read(SAMPLES / "biped.glb"), whole_character=True)
    (root,) = (k for k, note in rig.metadata.items() if note["type"] == "control" and note["kind"] == "root")
    translation = rig.translation.copy()
    translation[int(rig.parents[root]), 1] += SEEN * float(np.ptp(rig.world[rig.is_joint, 3, 1]))
    with pytest.raises(pytest.fail.Exception, match="root"):
        golden.check("add-controls_biped.glb.txt", built(replace(rig, translation=translation)))


def test_controls_and_joints_of_a_bake_at_a_moment(golden: Golden) -> None:
    up = with_keyed_controls()
    controls = up.nodes_of("control", "poleVector")
    text = moment(up, "walk", 0.5, controls)
    home = rigtri.bake(up, to="joints")
    text += "\njoints\n" + moment(home, "walk", 0.5, np.flatnonzero(home.is_joint).tolist())
    golden.check("bake_biped.glb.txt", text)


def test_a_pose_that_is_the_rest_pose_from_now_on(golden: Golden) -> None:
    posed = rigtri.take_pose(with_keyed_controls(), at=AT)
    golden.check("pose_biped.glb.txt", standing(posed, np.flatnonzero(posed.is_joint).tolist()))


def test_fk_controls_that_have_been_snapped_to_ik(golden: Golden) -> None:
    up = with_keyed_controls()
    arm = ("upper_arm_L", "forearm_L", "hand_L")
    snapped = rigtri.snap(up, to="fk", at=(AT,), limb=(arm,))
    keyed = {track.node for track in snapped.clip("walk").tracks}
    driving = [snapped.names[k] for k in snapped.nodes_of("control", "poleVector") if k in keyed]
    text = f"with keys in walk: {', '.join(sorted(driving))}\n"
    controls = [snapped.find(f"{joint}_ctl") for joint in arm]
    golden.check("snap_biped.glb.txt", text + moment(snapped, "walk", 0.5, controls))


def test_strip_leaves_the_nodes_of_the_source(golden: Golden) -> None:
    source, stripped = rigtri.read(SAMPLES / "biped.glb"), rigtri.strip(rigged())
    assert stripped.names == source.names
    golden.check("strip_biped.glb.txt", standing(stripped, range(len(stripped))))
