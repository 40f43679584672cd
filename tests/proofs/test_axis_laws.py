"""One body, one sense, on real files: every preset on every biped, judged by where joints move.

Chains, facing and up come from `recognise`; aim and hinge of a preset from the table in docs/presets.md.
Everything else is computed here, without rigtri, from the axes of the written result.
"""

from __future__ import annotations

import re
from itertools import combinations, pairwise
from pathlib import Path

import numpy as np
import pytest
from places import ROOT, real_files, sample_files

from rigtri import add_polevector, orient_joints, read, write
from rigtri.errors import RigtriError
from rigtri.maths.trigonometry import Floats
from rigtri.model.rig import Rig
from rigtri.recognition.layout import Character
from rigtri.recognition.recognise import recognise
from rigtri.report import Report

# Preset → aim and the axis about which a positive rotation flexes, as docs/presets.md has them.
ROW = re.compile(r"^\| ((?:`[\w-]+`(?:, )?)+) \| ([+−][xyz]) \| ([+−][xyz]) \|", re.M)
TABLE = ROW.findall((ROOT / "docs" / "presets.md").read_text("utf-8"))
AXES = {name: (aim, hinge) for names, aim, hinge in TABLE for name in re.findall(r"[\w-]+", names)}
# Degrees: fingers of a hand, two bones of a limb, neighbours in the trunk, its axes off where the body faces,
# poles off knees and elbows, and what sockets may move.
FINGERS, LIMB, TRUNK, FORWARD, POLE, SOCKET = 30.0, 20.0, 30.0, 35.0, 60.0, 0.01
FILES = [*sample_files(), *real_files()]


def unit(vector: Floats) -> Floats:
    size = np.linalg.norm(vector, axis=-1, keepdims=True)
    return np.asarray(vector / np.where(size == 0, 1, size))


def degrees(a: Floats, b: Floats) -> float:
    return float(np.degrees(np.arctan2(np.linalg.norm(np.cross(a, b)), np.dot(a, b))))


def carried(start: Floats, end: Floats, vector: Floats) -> Floats:
    """A vector seen at one direction taken to another by the shortest rotation (Rodrigues)."""
    axis, cosine = np.cross(start, end), float(np.dot(start, end))
    if cosine < -0.999999:
        return vector
    return np.asarray(
        vector * cosine + np.cross(axis, vector) + axis * (np.dot(axis, vector) / (1.0 + cosine))
    )


class Result:
    """The axes of a written result: aim and hinge of each node, unit, (n, 3), and where it is."""

    def __init__(self, rig: Rig, preset: str) -> None:
        aim, hinge = AXES[preset]
        frames = unit(rig.world[:, :3, :3])
        # In left-handed axes a positive rotation turns the other way.
        turning = np.sign(np.linalg.det(rig.world[:, :3, :3]))[:, np.newaxis]
        self.axes, self.at = frames, rig.world[:, 3, :3]
        self.aim = frames[:, "xyz".index(aim[1])] * (-1.0 if aim[0] == "−" else 1.0)
        self.hinge = frames[:, "xyz".index(hinge[1])] * (-1.0 if hinge[0] == "−" else 1.0) * turning

    def roll(self, one: int, other: int) -> float:
        return degrees(carried(self.aim[one], self.aim[other], self.hinge[one]), self.hinge[other])

    def moves(self, joint: int, target: int) -> Floats:
        """Where a positive rotation about its hinge moves what a joint aims at, unit, (3,)."""
        return unit(np.cross(self.hinge[joint], self.at[target] - self.at[joint]))


def broken(rig: Rig, out: Rig, character: Character, preset: str, kept: set[int]) -> list[str]:
    """The laws that a result breaks, in words. kept: joints that do not turn, most often without weight."""
    result, ahead = Result(out, preset), np.array(character.facing)
    chains = {chain.name: chain for chain in character.chains if chain.is_sure}
    found = []

    def limit(law: str, value: float, most: float, *joints: int) -> None:
        if value > most and kept.isdisjoint(joints):
            found.append(f"{law} {value:.0f}°: {', '.join(rig.names[joint] for joint in joints)}")

    names = [character.hips, *(j for k in ("spine", "neck", "head") if k in chains for j in chains[k].joints)]
    trunk = list(dict.fromkeys(names))
    for below, joint in pairwise(trunk):
        limit("trunk", result.roll(below, joint), TRUNK, below, joint)
        limit(
            "forward", min(degrees(s * a, ahead) for a in result.axes[joint] for s in (1, -1)), FORWARD, joint
        )
    for side in ("left", "right"):
        fingers = [chains.get(f"{side} {finger} finger") for finger in ("index", "middle", "ring", "little")]
        hand = [finger.joints[0] for finger in fingers if finger]
        for one, other in combinations(hand, 2):
            limit("fingers", result.roll(one, other), FINGERS, one, other)
        for kind, way in (("arm", 1.0), ("leg", -1.0)):
            limb = chains.get(f"{side} {kind}")
            if limb is None or len(limb.bend) < 3:
                continue
            start, middle, end = limb.bend
            limit(f"{kind} hinge", result.roll(start, middle), LIMB, start, middle)
            # Of hanging and level limbs; knees bend the foot back, elbows the hand ahead.
            if abs(float(np.dot(unit(result.at[end] - result.at[middle]), ahead))) < 0.7:
                limit("flex", degrees(result.moves(middle, end), way * ahead), 60.0, middle)
    for part in character.parts:
        if part.role == "attachment" and part.joint not in names:
            before, after = unit(rig.world[part.joint, :3, :3]), result.axes[part.joint]
            if max(map(degrees, before, after)) > SOCKET:
                found.append(f"socket turned: {rig.names[part.joint]}")
    return found


def bipeds(rig: Rig) -> list[Character]:
    return [k for k in recognise(rig).characters if k.form == "biped" and k.confidence >= 0.75]


def biped_file(path: Path) -> Rig:
    try:
        rig = read(path)
    except RigtriError:
        pytest.skip("not read")
    if not bipeds(rig) or rig.rules.orient_locked:
        pytest.skip("no biped that may take other axes")
    return rig


def test_the_table_of_presets_is_read() -> None:
    assert len(AXES) == 10
    assert AXES["mgear"] == ("+x", "−z")


@pytest.mark.parametrize("path", FILES, ids=lambda path: path and path.name)
def test_every_preset_keeps_the_laws_of_a_body(path: Path) -> None:
    rig = biped_file(path)
    for preset in AXES:
        report = Report()
        out = orient_joints(rig, preset=preset, report=report)
        kept = {rig.find(entry["address"]) for entry in report.joints if entry["status"] == "kept"}
        for character in bipeds(rig):
            assert broken(rig, out, character, preset, kept) == [], preset


@pytest.mark.parametrize("path", FILES, ids=lambda path: path and path.name)
def test_axes_find_their_way_home(path: Path, tmp_path: Path) -> None:
    """Other axes, and back by ``--like`` the source: within 1e-6."""
    rig = biped_file(path)
    for preset in ("blender", "openxr"):
        changed = tmp_path / f"{preset}{path.suffix}"
        write(orient_joints(rig, preset=preset), changed)
        home = orient_joints(read(changed), like=rig)
        joints = np.flatnonzero(rig.is_joint)
        ours, theirs = (unit(each.world[joints, :3, :3]) for each in (home, rig))
        np.testing.assert_allclose(ours, theirs, atol=1e-6)


@pytest.mark.parametrize("path", FILES, ids=lambda path: path and path.name)
def test_poles_of_nearly_straight_limbs_are_before_knees_and_behind_elbows(path: Path) -> None:
    rig = biped_file(path)
    report = Report()
    try:
        out = add_polevector(rig, limbs="auto", report=report)
    except RigtriError:
        pytest.skip("no limb that may have a pole")
    # Where clips show another side they are believed.
    shown = {entry["polevector"]: entry["bend_degrees"] < 10 for entry in report.limbs}
    shown |= {e["polevector"]: False for e in report.limbs if e["source"] in ("clips", "other pose")}
    for character in bipeds(rig):
        ahead = np.array(character.facing)
        for chain in (chain for chain in character.limbs if chain.is_sure and len(chain.bend) == 3):
            name = f"{rig.names[chain.bend[1]]}_pole"
            if shown.get(name):
                way = out.world[out.find(name), 3, :3] - rig.world[chain.bend[1], 3, :3]
                assert degrees(way, ahead if chain.kind == "leg" else -ahead) <= POLE, chain.name
