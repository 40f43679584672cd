"""Pose readers and rivets in Blender: drivers and sockets say there what rigtri bakes."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from engines import Shown, blender_setup, blender_trip
from gltf_files import glb_bytes, glb_parts
from places import NO_ASSETS, SAMPLES, asset_files, ci, slow
from program import cli
from test_blender_bridge import BAKED, ONE, turn

import rigtri
from rigtri.evaluation.active_controls import controls_and_poles
from rigtri.evaluation.pose_cache import PoseCache, sample_parts
from rigtri.evaluation.pose_readers import relative
from rigtri.evaluation.sampling import sample
from rigtri.export.blender.plan import named
from rigtri.export.blender.rivets import imported_vertices
from rigtri.export.blender.script import blender_setup as exported
from rigtri.export.blender.script import setup_for
from rigtri.formats import ReadOptions, read
from rigtri.maths.quaternions import multiply
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Track
from rigtri.model.metadata import PoseWeightRecord, RivetRecord
from rigtri.model.rig import Rig
from rigtri.model.script_nodes import DRIVE
from rigtri.operations.options.add_posereader import Goal
from rigtri.operations.take_clips.driven_channels import driven_channels
from rigtri.report import Report

# Of the size, and of a weight of 1: Blender's float32, and its bones, which store their axes as two points
# and an angle.
EXACT = 3e-5
Y_UP = np.array([[1.0, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]])

READERS: list[dict[str, Any]] = [
    {"driver": "upper_arm_L", "target": ["up=0,1,0", "front=0,0,1"], "name": "arm"}
    | {
        "joint": [
            ("up", "fingers_L", "tx=0.02,rz=40,sx=1.3"),
            ("front", "fingers_L", "ty=-0.01,rx=-25,sy=0.8"),
        ]
    },
    {"driver": "head", "frame": "world", "reader": "cone", "outer": 150.0, "inner": 5.0, "name": "look"}
    | {"axis": (0.0, 0.0, 1.0), "target": ["hand=hand_R", "up=0,1,0"], "joint": [("hand", "toe_R", "rx=30")]},
    {"driver": "thigh_L", "reader": "rbf", "kernel": "gaussian", "name": "hip"}
    | {
        "target": ["out=1,0,0", "front=0,0,1", "back=0,-0.3,-1"],
        "joint": [("front", "toe_L", "tz=0.03,sz=1.2")],
    },
    {"driver": "forearm_R", "reader": "rbf", "mode": "twist", "axis": (1.0, 0.0, 0.0), "name": "roll"},
    {"driver": "hand_R", "frame": "chest", "reader": "rbf", "mode": "both", "name": "wrist"},
    {"driver": "spine", "signed": True, "target": ["bend=1,0,0"], "axis": (0.0, 1.0, 0.0), "name": "back"}
    | {"attribute": [("bend", "head_ctl", "bend")]},
]
POSES: dict[str, Any] = {
    "roll": [("a", turn("x", 40)), ("b", turn("x", -60))],
    "wrist": [("a", turn("y", 50)), ("b", turn("z", 70)), ("rest", None)],
}
MOVES: list[dict[str, Any]] = [
    {},
    {
        "hips_root_ctl": ONE | {"translation": [0.2, 0.0, 0.1], "rotation": turn("y", 35)},
        "spine_ctl": ONE | {"rotation": turn("z", 25)},
        "head_ctl": ONE | {"rotation": turn("y", 40)},
        "hand_L_ik_ctl": ONE | {"translation": [0.0, 0.25, 0.12], "rotation": turn("y", 50)},
    },
    {
        "spine_ctl": ONE | {"rotation": turn("z", -20)},
        "hand_R_ik_ctl": ONE | {"translation": [0.1, 0.1, 0.2], "rotation": turn("x", 70)},
        "foot_L_ik_ctl": ONE | {"translation": [0.05, 0.15, 0.25]},
        "forearm_R_ctl": ONE | {"rotation": turn("x", 30)},
    },
    {
        "hips_ctl": ONE | {"translation": [0.0, -0.05, 0.03], "rotation": turn("z", 10)},
        "foot_L_ik_ctl": ONE | {"translation": [0.2, 0.3, -0.1]},
        "upper_arm_L_ctl": ONE | {"rotation": turn("y", -30)},
        "head_ctl": ONE | {"rotation": turn("x", -50)},
    },
    {
        "hips_root_ctl": ONE | {"rotation": turn("x", 60)},
        "forearm_R_ctl": ONE | {"rotation": turn("x", -50)},
        "hand_R_ctl": ONE | {"rotation": turn("z", 60)},
        "fingers_L_ctl": ONE | {"rotation": turn("x", 20)},
    },
    {
        "hand_R_ctl": ONE | {"rotation": turn("y", 55)},
        "thigh_L_ctl": ONE | {"rotation": turn("x", -80)},
        "hand_L_ik_ctl": ONE | {"translation": [0.05, 0.45, 0.1]},
        "spine_ctl": ONE | {"rotation": turn("x", 70)},
    },
]


def with_morphs(path: Path, target: Path) -> Path:
    """The sample with two morph targets on its body."""
    gltf, binary = glb_parts(path)
    mesh = next(each for each in gltf["meshes"] if each["name"] == "body")
    accessors, views = gltf["accessors"], gltf["bufferViews"]
    for primitive in mesh["primitives"]:
        primitive["targets"] = []
        count = accessors[primitive["attributes"]["POSITION"]]["count"]
        for number in range(2):
            offsets = (0.03 * np.sin(np.arange(count * 3) * (1.7 + number))).astype("<f4")
            binary += b"\0" * (-len(binary) % 4)
            views.append({"buffer": 0, "byteOffset": len(binary), "byteLength": offsets.nbytes})
            rows = offsets.reshape(-1, 3)
            box = {"min": rows.min(axis=0).tolist(), "max": rows.max(axis=0).tolist()}
            accessors.append(
                {"bufferView": len(views) - 1, "componentType": 5126, "count": count, "type": "VEC3"} | box
            )
            primitive["targets"].append({"POSITION": len(accessors) - 1})
            binary += offsets.tobytes()
    mesh |= {"weights": [0.0, 0.0], "extras": {"targetNames": ["bulge", "dent"]}}
    gltf["buffers"][0]["byteLength"] = len(binary)
    target.write_bytes(glb_bytes(gltf, binary))
    return target


def followed(rig: Rig, *, morphs: bool) -> Rig:
    """A rig with controls, readers of every kind and rivets, on joints that clips do not move."""
    rig = rig if "head_end" in rig.names else replace(rig, clips=())
    still = {"fingers_L": "head_end", "toe_L": "toe_L_end", "toe_R": "toe_R_end"} if rig.clips else {}
    rig = rigtri.add_controls(rig, whole_character=True)
    for given in READERS:
        options = dict(given)
        options["joint"] = [(goal, still.get(joint, joint), by) for goal, joint, by in given.get("joint", ())]
        if options["name"] in POSES:
            driver = rig.find(options["driver"])
            frame = rig.find(options["frame"]) if "frame" in options else int(rig.parents[driver])
            options["target"] = goals(rig, driver, frame, POSES[options["name"]])
        if morphs and options["name"] == "hip":
            options["morph"] = [("out", "body", "bulge"), ("back", "body", "dent")]
        rig = rigtri.add_posereader(rig, **options)
    rig = rigtri.add_rivet(
        rig, mesh="body", triangle=[0, 137, 300], barycentric=[(0.2, 0.5, 0.3)], name=["button"]
    )
    return rigtri.add_rivet(rig, mesh="staff", vertex=[3], name=["ring"])


def goals(rig: Rig, driver: int, frame: int, poses: list[tuple[str, Any]]) -> list[Goal]:
    """Poses of a driver: its rotation at rest, seen from the frame, turned on in its own axes."""
    rest = relative(rig.world[driver], rig.world[frame])
    found = []
    for name, more in poses:
        rotation = rest if more is None else multiply(rest, np.array(more))
        found.append(Goal(name, rotation=tuple(rotation.tolist())))
    return found


def baked(rig: Rig, controls: dict[str, Any]) -> tuple[Rig, Clip]:
    """What rigtri makes of a pose of controls, with IK on, in a clip of its own: joints, and what follows."""
    tracks = []
    for node in sorted(controls_and_poles(rig)):
        given = controls.get(rig.names[node])
        for path, rest in zip(ONE, (rig.translation, rig.rotation, rig.scale), strict=True):
            value = np.array(given[path] if given else rest[node], dtype=np.float64)
            tracks.append(Track(node, path, "STEP", np.zeros(1), value[np.newaxis]))
    out = rigtri.bake(replace(rig, clips=(Clip("pose", tuple(tracks)),)), to="joints")
    return out, out.clips[0]


def compared(path: Path, folder: Path, moves: list[dict[str, Any]] = MOVES) -> tuple[float, float, float]:
    """How far off joints, rivets (of the size) and weights are in Blender, at most."""
    report = Report()
    setup = setup_for(path, ReadOptions(), report)
    assert not [warning for warning in report.warnings if warning.code == "blender-left-out"]
    rig, is_gltf, meters = read(path).rig, setup.plan["gltf"], setup.plan["meters"]
    script = folder / f"{path.stem}.py"
    script.write_text(setup.script, "utf-8")
    moves = [{k: v for k, v in pose.items() if rig.known(k) is not None} for pose in moves]
    rivets, values = (sorted(rig.records(kind)) for kind in (RivetRecord, PoseWeightRecord))
    columns = driven_channels(rig).morphs
    morphs = [(node, column) for node in sorted(columns) for column in sorted(columns[node])]
    attributes = [(node, one) for node, one in rig.records(PoseWeightRecord).items() if one.control]
    job = {
        "source": str(path),
        "script": str(script),
        "meters": meters,
        "poses": moves,
        "objects": [rig.names[node] for node in rivets],
        "weights": [
            *(rig.names[node] for node in values),
            *(f"{rig.names[node]}/{column}" for node, column in morphs),
            *(f"{rig.title(rig.find(one.control))}:{one.attribute}" for _, one in attributes),
        ],
    }
    (found,) = blender_setup(job, folder=folder)
    assert not found["slow"]
    before, once, twice, removed = found["counts"].tolist()
    assert once == twice
    assert once > before == removed
    assert np.abs(found["points|removed"] - found["points|imported"]).max() <= EXACT
    up = Y_UP if rig.rules.up[1] > 0 else np.eye(4)
    size = float(np.linalg.norm(np.ptp(rig.world[np.flatnonzero(rig.is_joint), 3, :3], axis=0)))
    joints, places, weights = [], [], []
    for number, pose in enumerate(moves):
        out, clip = baked(rig, pose)
        seen = PoseCache(out, sample_parts(out, clip, np.zeros(1)))
        joints.append(_joints(rig, found, number, seen, up, meters) / size)
        axes = np.linalg.inv(up) if is_gltf else np.eye(4)
        for k, node in enumerate(rivets):
            there = found[f"objects|{number}"][k].T
            mine = axes @ seen.world(node)[0] @ up
            mine[3, :3] *= meters
            off = (there - mine)[3, :3] / (size * meters), 0.1 * (_unit(there) - _unit(mine))
            places += [float(np.abs(each).max()) for each in off]
        mine = [float(seen.local(node)[0, 3, 0]) for node in values]
        for node, column in morphs:
            track = next(t for t in clip.tracks if t.node == node and t.path == "weights")
            mine.append(float(sample(track, np.zeros(1))[0, column]))
        mine += [float(seen.local(node)[0, 3, 0]) for node, _ in attributes]
        weights.append(float(np.abs(found[f"weights|{number}"] - mine).max(initial=0.0)))
    return max(joints), max(places, default=0.0), max(weights, default=0.0)


def _unit(matrix: Floats) -> Floats:
    return matrix[:3, :3] / np.linalg.norm(matrix[:3, :3], axis=1)[:, np.newaxis]


def _joints(rig: Rig, found: Shown, number: int, seen: PoseCache, up: Floats, meters: float) -> float:
    """How far joints, or tips of their axes of a tenth of the size, are from where they are baked."""
    worst, size = 0.0, float(np.linalg.norm(np.ptp(rig.world[np.flatnonzero(rig.is_joint), 3, :3], axis=0)))
    tips = np.concatenate([np.zeros((1, 3)), np.eye(3) * 0.1 * size])
    joints = {named(rig, joint): joint for joint in np.flatnonzero(rig.is_joint).tolist()}
    for k, name in enumerate(found["names"]):
        there = found[f"joints|{number}"][k].T
        mine = seen.world(joints[str(name)])[0] @ up
        theirs = tips @ there[:3, :3] + there[3, :3] / meters
        mine = tips @ mine[:3, :3] + mine[3, :3]
        worst = max(worst, float(np.abs(theirs - mine).max()))
    return worst


@pytest.mark.parametrize("name", [ci("biped.glb"), slow("biped.usda")])
def test_readers_and_rivets_are_in_blender_what_rigtri_bakes(name: str, tmp_path: Path) -> None:
    source = SAMPLES / name
    if name.endswith(".glb"):
        source = with_morphs(source, tmp_path / "morphs.glb")
    document, target = read(source), tmp_path / name
    document.write(followed(document.rig, morphs=name.endswith(".glb")), target, target)
    joints, places, weights = compared(target, tmp_path)
    print(joints, places, weights)
    assert joints <= EXACT
    assert places <= EXACT
    assert weights <= EXACT


def on_any(rig: Rig) -> Rig:
    """A character with controls, readers of three of its joints that drive ends of chains, and rivets."""
    rig = rigtri.add_controls(rig, whole_character=True)
    joints = np.flatnonzero(rig.is_joint).tolist()
    above = [k for k in joints if rig.parents[k] in joints and any(c in joints for c in rig.children[k])]
    still = {t.node for clip in rig.clips for t in clip.tracks}
    ends = [k for k in joints if k not in above and rig.parents[k] in joints and k not in still]
    ways = ({"reader": "dot"}, {"reader": "cone", "frame": "world"}, {"reader": "rbf", "kernel": "gaussian"})
    for number, way in enumerate(ways):
        driver = above[number * (len(above) - 1) // 2]
        mesh = next((mesh for mesh in rig.meshes if len(mesh.morphs)), None)
        more: dict[str, Any] = {}
        if mesh is not None:
            more["morph"] = [("up", rig.address(mesh.node), mesh.morph_names[number])]
        if number < len(ends):
            more["joint"] = [("front", rig.address(ends[number]), "rz=30,sy=1.3")]
        rig = rigtri.add_posereader(
            rig,
            driver=rig.address(driver),
            target=["up=0,1,0.1", "front=0.1,0,1", "side=1,0,0"],
            name=f"reader {number}",
            **way,
            **more,
        )
    shown = [mesh for mesh in rig.meshes if len(mesh.points) > 20]
    for number, mesh in enumerate(shown[:2]):
        rig = rigtri.add_rivet(
            rig, mesh=rig.address(mesh.node), triangle=[5, 17], name=[f"rivet {number}", f"rivet {number}b"]
        )
    return rig


def five_poses(rig: Rig) -> list[dict[str, Any]]:
    """FK controls turned by up to 40 degrees each, and a root that moves and turns."""
    poses, numbers = list[dict[str, Any]](), np.random.default_rng(7)
    for _ in range(5):
        poses.append({})
        for node in rig.nodes_of("control"):
            if rig.metadata[node].get("kind") in ("fk", "root"):
                x, y, z = np.radians(numbers.uniform(-12, 12, 3))
                half = np.array([x, y, z, 1.0])
                rotation = (half / np.linalg.norm(half)).tolist()
                poses[-1][rig.names[node]] = ONE | {"rotation": rotation}
    return poses


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    ["khronos_CesiumMan_Binary.glb", "addon_Example_vrm1.vrm", "Godette_v4.vrm", "usdwg_CesiumMan.usdz"],
)
def test_readers_and_rivets_of_characters(name: str, tmp_path: Path) -> None:
    path = next((path for path in asset_files() if path.name == name), None)
    if path is None:
        pytest.skip(NO_ASSETS)
    document, target = read(path), tmp_path / name
    rig = on_any(document.rig)
    document.write(rig, target, target)
    joints, places, weights = compared(target, tmp_path, five_poses(rig))
    print(name, joints, places, weights)
    assert joints <= EXACT
    assert places <= EXACT
    assert weights <= EXACT


@pytest.mark.ci
def test_what_readers_and_rivets_drive_in_blender_is_no_edit(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Blender exports a key a frame of all that is driven, which take-clips took for edits of 15 nodes."""
    monkeypatch.chdir(tmp_path)
    document = read(with_morphs(SAMPLES / "biped.glb", tmp_path / "hero.glb"))
    rig = document.rig
    free = {rig.find(name) for name in ("fingers_L", "toe_L", "toe_R")}
    clips = (replace(c, tracks=tuple(t for t in c.tracks if t.node not in free)) for c in rig.clips)
    document.write(
        followed(replace(rig, clips=tuple(clips)), morphs=True), Path("rigged.glb"), Path("rigged.glb")
    )
    cli("bake", "rigged.glb", "-o", "animate.glb", "--to", "controls", code=0)
    cli("export-blender", "animate.glb", "-o", "setup.py", code=0)
    driven = driven_channels(read(Path("animate.glb")).rig)
    assert driven.nodes
    assert driven.morphs
    edits: dict[str, dict[str, Any]] = {
        "same.glb": {},
        "edited.glb": {"hand_L_ik_ctl": {"by": [0.02, 0.05, -0.04]}},
    }
    script = str(tmp_path / "setup.py")
    blender_trip(
        *(
            {"script": script, "target": str(tmp_path / name), "clip": "walk", "keys": keys}
            for name, keys in edits.items()
        ),
        folder=tmp_path,
    )
    told = cli("take-clips", "animate.glb", "--from", "same.glb", "-o", "home.glb", code=0).stderr
    assert "EDITED has no changes" in told
    cli("take-clips", "animate.glb", "--from", "edited.glb", "-o", "edited-home.glb", code=0)
    before, after = (read(Path(name)).rig for name in ("animate.glb", "edited-home.glb"))
    assert not driven.nodes.intersection(taken := _changed(before, after))
    assert before.find("body") not in taken
    assert before.find("hand_L_ik_ctl") in taken
    for name, *more in (("edited-home.glb", "--to", "joints"), ("edited.glb", "--rig", "animate.glb")):
        cli("bake", name, "-o", f"baked-{name}", *more, code=0)
    one, other = (read(Path(f"baked-{name}")).rig for name in ("edited-home.glb", "edited.glb"))
    for node in (*one.records(RivetRecord), *one.records(PoseWeightRecord)):
        places = []
        for each in (one, other):
            clip = each.clip("walk")
            times = np.linspace(0.0, 0.9, 10)
            seen = PoseCache(each, sample_parts(each, clip, times))
            places.append(seen.world(each.find(one.names[node]))[:, 3, :3])
        assert np.abs(places[0] - places[1]).max() <= BAKED


@pytest.mark.slow
@pytest.mark.parametrize("suffix", [".glb", ".usdc"])
def test_what_readers_drive_in_blender_is_no_edit_without_ik(suffix: str, tmp_path: Path) -> None:
    """Only the switches of IK limbs said that the script was at work, and keys of readers were taken."""
    rigged, edited, home, script = (
        str(tmp_path / name) for name in ("rigged.glb", f"edited{suffix}", "home.glb", "setup.py")
    )
    document = read(SAMPLES / "biped.glb")
    free = document.rig.find("toe_L")
    clips = (replace(c, tracks=tuple(t for t in c.tracks if t.node != free)) for c in document.rig.clips)
    rig = rigtri.add_controls(replace(document.rig, clips=tuple(clips)), below=["hips"])
    rig = rigtri.add_posereader(
        rig, driver="thigh_L", target=["up=0,-1,0.4"], joint=[("up", "toe_L", "rz=30")]
    )
    document.write(rig, Path(rigged), Path(rigged))
    cli("export-blender", rigged, "-o", script, code=0)
    blender_trip({"script": script, "target": edited, "clip": "walk", "keys": {}}, folder=tmp_path)
    assert any(name.startswith(DRIVE) for name in read(Path(edited)).rig.names)
    told = cli("take-clips", rigged, "--from", edited, "-o", home, code=0).stderr
    after = read(Path(home)).rig
    assert after.find("toe_L") not in _changed(read(Path(rigged)).rig, after), told


def _changed(before: Rig, after: Rig) -> set[int]:
    """The nodes of which a clip has other keys."""
    found = set[int]()
    for was, now in zip(before.clips, after.clips, strict=True):
        old = {(track.node, track.path): track for track in was.tracks}
        for track in now.tracks:
            known = old.get((track.node, track.path))
            if known is None or not np.array_equal(known.values, track.values):
                found.add(track.node)
    return found


def test_expressions_are_short_and_each_is_a_value_of_its_own() -> None:
    """Blender cuts an expression after 255 letters, and runs Python for what is none of its own words."""
    rig = followed(read(SAMPLES / "biped.glb").rig, morphs=False)
    plan = exported(rig, gltf=True).plan
    assert max(len(value["expression"]) for value in plan["values"]) < 256
    words = set(re.findall(r"[a-z]\w+", " ".join(value["expression"] for value in plan["values"])))
    assert words <= {"max", "min", "sqrt", "atan2", "asin", "abs", "sin", "exp"}
    channels = {driver["channel"] for driver in plan["drivers"]}
    assert channels == {"location", "rotation_euler", "scale", "property"}


def test_a_joint_follows_more_targets_than_an_expression_has_letters() -> None:
    """Before, the export ended in a traceback."""
    rig = rigtri.add_controls(replace(read(SAMPLES / "biped.glb").rig, clips=()), joints=["hips"])
    count = 10
    rig = rigtri.add_posereader(
        rig,
        driver="forearm_L",
        target=[f"t{k}={np.cos(k)},{np.sin(k)},0" for k in range(count)],
        joint=[(f"t{k}", "toe_L", f"tx={k + 1}e-3,sy={1 + k / 10}") for k in range(count)],
        name="many",
    )
    plan = exported(rig, gltf=True).plan
    (move,) = (each for each in plan["drivers"] if each["channel"] == "location" and each["on"][0] == "s")
    (grow,) = (each for each in plan["drivers"] if each["channel"] == "scale")
    named = {one["name"]: f"v{k}" for k, one in enumerate(plan["values"])}
    weights = {named[f"many t{k}"]: 1.0 for k in range(count)}

    def computed(word: str) -> float:
        """A value where each target has all of its weight."""
        if word in weights:
            return weights[word]
        one = plan["values"][int(word[1:])]
        return float(eval(one["expression"], {}, {k: computed(each) for k, each in one["inputs"].items()}))

    assert computed(move["value"]) == pytest.approx(1e-3 * sum(range(1, count + 1)))
    assert computed(grow["value"]) == pytest.approx(np.prod([1 + k / 10 for k in range(count)]))


def test_of_two_readers_of_one_channel_the_last_drives_it_as_in_bake() -> None:
    rig = rigtri.add_controls(replace(read(SAMPLES / "biped.glb").rig, clips=()), joints=["hips"])
    for name, changes in (("first", "tx=0.1,rz=20"), ("second", "rz=30")):
        rig = rigtri.add_posereader(
            rig, driver="forearm_L", target=["up=0,1,0"], joint=[("up", "toe_L", changes)], name=name
        )
    report = Report()
    plan = exported(rig, gltf=True, report=report).plan
    (text,) = [warning.text for warning in report.warnings if warning.code == "blender-left-out"]
    assert "what the pose reader 'first' does to rotation of 'toe_L'" in text
    assert "'second'" in text
    names = {
        each["name"]
        for each in plan["sockets"]
        if each["name"].endswith("turned") and "toe_L" in each["name"]
    }
    assert "second toe_L up turned" in names
    assert "first toe_L up turned" not in names
    assert sum(driver["channel"] == "location" and driver["on"][0] == "s" for driver in plan["drivers"]) == 1


def test_a_reader_that_moves_joints_below_which_controls_are_is_left_out_by_name() -> None:
    rig = replace(read(SAMPLES / "biped.glb").rig, clips=())
    rig = rigtri.add_controls(rig, joints=["hand_L"])
    options: dict[str, Any] = {"driver": "head", "target": ["up=0,1,0"], "name": "nod"}
    rig = rigtri.add_posereader(rig, **options, joint=[("up", "forearm_L", "rz=10")])
    report = Report()
    exported(rig, gltf=True, report=report)
    (text,) = [warning.text for warning in report.warnings if warning.code == "blender-left-out"]
    assert "what the pose reader 'nod' does to 'forearm_L'" in text


def test_a_rivet_that_moves_a_bone_is_left_out_by_name() -> None:
    """Blender deforms a mesh once all bones of its armature stand."""
    rig = replace(read(SAMPLES / "biped.glb").rig, clips=())
    rig = rigtri.add_controls(rig, joints=["hips"])
    rig = rigtri.add_rivet(rig, mesh="body", triangle=[0], name=["button"])
    rig = rigtri.constrain(rig, type="aim", child="head", driver="button")
    report = Report()
    plan = exported(rig, gltf=True, report=report).plan
    (text,) = [warning.text for warning in report.warnings if warning.code == "blender-left-out"]
    assert "the rivet 'button': it moves 'head'" in text
    assert not any("vertices" in socket for socket in plan["sockets"])


def test_a_rivet_rides_on_the_vertices_that_blender_keeps_of_each_primitive() -> None:
    """Its import leaves out those that no face has, and joins the primitives of a mesh."""
    rig = replace(read(SAMPLES / "biped.glb").rig, clips=())
    (body,) = [mesh for mesh in rig.meshes if rig.names[mesh.node] == "body"]
    surface = body.surface_now
    assert surface is not None
    first = replace(body, name="body/0", surface=lambda: surface._replace(corners=surface.corners[3:9]))
    second = replace(body, name="body/1")
    rig = rigtri.add_rivet(rig, mesh="body", triangle=[1], name=["button"])
    (record,) = rig.records(RivetRecord).values()
    drawn = np.unique(surface.corners[3:9])
    numbers, count = imported_vertices([first, second], replace(record, primitive=1))
    ranks = np.searchsorted(np.unique(surface.corners), record.vertices)
    assert numbers == [len(drawn) + int(rank) for rank in ranks]
    assert count == len(drawn) + len(np.unique(surface.corners))
