"""rigtri diff: nothing where nothing differs, and every planted difference by its name."""

from __future__ import annotations

import json
import random
import re
import shutil
import zipfile
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import gltf_files
import numpy as np
import pytest
import usd_files
from calls import calls
from gltf_files import small
from places import files_of_all_kinds, leave_out_refused
from program import cli
from pxr import Sdf
from rigs import chain, rig_of
from second_opinions import validator
from usd_of_everything import planted

import rigtri
from rigtri import diff
from rigtri.errors import FileError, RigtriError
from rigtri.formats import read
from rigtri.maths.quaternions import from_axis_angle, multiply, to_axes, unit
from rigtri.maths.vectors import normalise
from rigtri.model.animation import Clip, Track
from rigtri.operations.add_polevector import AddPolevectorOptions, add_polevector
from rigtri.operations.orient_joints.orient import orient_joints
from rigtri.pipeline.edit import edit
from rigtri.verification.diff.axis_diff import turns
from rigtri.verification.diff.change import same_numbers, same_rows
from rigtri.verification.diff.diff import Difference
from rigtri.verification.diff.rig_diff import rig_changes


def lines(found: Difference, terms: str = "both") -> list[str]:
    """Every difference as ``group: line``."""
    rig = found.rig or () if terms in ("both", "rig") else ()
    file = found.file or () if terms in ("both", "file") else ()
    return [f"{change.group}: {change}" for change in (*rig, *file)]


@pytest.mark.parametrize("path", files_of_all_kinds(), ids=lambda p: p.name)
def test_a_file_does_not_differ_from_itself(path: Path) -> None:
    try:
        found = diff(path, path, verify=False)
    except FileError as error:
        leave_out_refused(path, error)
    assert found.same
    assert found.describe() == ""


# What a new direction of axes changes, and nothing else.
ORIENTED = re.compile(
    r"axes: ~ |rest pose: ~ |bind pose: ~ |clips: ~ .*(rotation|translation|scale) of .*  values: |places: ~ "
    r"|colliders and offsets: ~ |attachments: > |hierarchy: \+ node .*_payload|clips: > "
    r"|controls and locators: \+ "
    r"|json: [~+] /nodes/\d+(/(translation|rotation|scale|children|extras|matrix|mesh|camera|skin)(/.*)?)?  "
    r"|json: [->+~] /nodes/\d+/(matrix|translation|rotation|scale|mesh|camera|skin)"
    r"|json: [~+] /(accessors|bufferViews)/\d+(/(min|max|count|byteLength|bufferView|byteOffset))?  "
    r"|json: [~>] /(animations/\d+/samplers/\d+/(output|input)|skins/\d+/inverseBindMatrices)  "
    r"|json: ~ /buffers/\d+/(byteLength|uri)  |json: \+ /buffers/\d+  "
    r"|json: \+ /animations/\d+/samplers/\d+  "
    r"|json: ~ /animations/\d+/channels/\d+/sampler  |json: [~+] /extensions/VRMC_"
    r"|accessors: [~>] |buffer views: ~ |buffers: [~+] "
    r"|package: ~ .*  \d+ → \d+ bytes|package: ~ .* other ones"
    r"|[^:]*layer: ~ .*\.(restTransforms|bindTransforms|translations|rotations|scales)( samples)?  "
    r"|[^:]*layer: [~+] .*\.(rigtri:|xformOp)|[^:]*layer: > .*order of properties"
    r"|root layer: \+ .*  over$"
)


def _alone(path: Path, folder: Path) -> Path:
    """A copy of a file, with all beside it where it may refer to them: their paths stay as they are."""
    if path.suffix in (".glb", ".vrm", ".vrma", ".usdz"):
        folder.mkdir()
        shutil.copyfile(path, folder / path.name)
    else:
        shutil.copytree(path.parent, folder)
    return folder / path.name


@pytest.mark.parametrize("path", files_of_all_kinds(), ids=lambda p: p.name)
def test_new_axes_differ_in_what_they_name_and_in_nothing_else(path: Path, tmp_path: Path) -> None:
    try:
        source = _alone(path, tmp_path / "source")
        out = source.with_name(f"out{path.suffix}")
        edit(source, out, lambda rig, report: orient_joints(rig, report=report))
    except RigtriError as error:
        leave_out_refused(path, error)
    found = diff(source, out, verify=False)
    assert found.same == (source.read_bytes() == out.read_bytes())
    strange = [line for line in lines(found) if not ORIENTED.match(line)]
    assert strange == []


# glTF: each fault, and lines it must be told with


def figure() -> gltf_files.Builder:
    """A chain of joints with extras, an image and bytes that no view covers."""
    b = gltf_files.small(4)
    b.view(b"an image")
    b.gltf["images"] = [
        {"bufferView": len(b.gltf["bufferViews"]) - 1, "mimeType": "image/png", "name": "skin"}
    ]
    b.binary += b"loose bytes!"
    b.gltf["nodes"][2]["extras"] = {"a": [1, {"b": None}]}
    b.gltf["nodes"][3]["scale"] = [1.0, 1.0, 1.0]
    return b


CHUNK = (0x31444441, b"odd")


def _keys(b: Any) -> np.ndarray[Any, Any]:
    view = b.gltf["bufferViews"][
        b.gltf["accessors"][b.gltf["animations"][0]["samplers"][0]["output"]]["bufferView"]
    ]
    return np.frombuffer(b.binary, "<f4", 8, view["byteOffset"])


def _swap_keys(b: Any) -> None:
    keys = np.array(_keys(b))
    _write(b, b.gltf["animations"][0]["samplers"][0]["output"], keys[[4, 5, 6, 7, 0, 1, 2, 3]])


def _write(b: Any, accessor: int, numbers: Any) -> None:
    view = b.gltf["bufferViews"][b.gltf["accessors"][accessor]["bufferView"]]
    content = np.asarray(numbers, "<f4").tobytes()
    b.binary[view["byteOffset"] : view["byteOffset"] + len(content)] = content


def _node(b: Any, number: int) -> Any:
    return b.gltf["nodes"][number]


def _moved_accessor(b: Any) -> None:
    sampler = b.gltf["animations"][0]["samplers"][0]
    sampler["output"] = b.accessor(np.array(_keys(b)).reshape(2, 4))


def _new_skin_order(b: Any) -> None:
    b.gltf["skins"][0]["joints"] = [0, 2, 1, 3]


GLTF: dict[str, tuple[Callable[[Any], Any], list[str]]] = {
    "renamed": (
        lambda b: _node(b, 2).update(name="knee"),
        ["hierarchy: ~ joint joint 2  renamed to knee", 'json: ~ /nodes/2/name  "joint 2" → "knee"'],
    ),
    "reparented": (
        lambda b: (_node(b, 2).pop("children"), _node(b, 1)["children"].append(3)),
        [
            "hierarchy: > joint joint 3  from below joint 2 to joint 1",
            "json: - /nodes/2/children  [3]",
            "json: ~ /nodes/1/children  [2] → [2, 3]",
        ],
    ),
    "a new node": (
        lambda b: (b.gltf["nodes"].append({"name": "prop"}), b.gltf["scenes"][0]["nodes"].append(5)),
        ["hierarchy: + node prop  below nothing", 'json: + /nodes/5  {"name": "prop"}'],
    ),
    "rest moved": (
        lambda b: _node(b, 1).update(translation=[0, 1.5, 0]),
        [
            "rest pose: ~ joint 1  translation 0 1 0 → 0 1.5 0",
            "places: ~ joint 1  stands 0.5 away: 0 2 0 → 0 2.5 0",
            "json: ~ /nodes/1/translation  0 1 0 → 0 1.5 0",
        ],
    ),
    "rest turned": (
        lambda b: _node(b, 3).update(rotation=[0, 0, 0.7071067811865476, 0.7071067811865476]),
        [
            "axes: ~ joint 3  rotated 90° about its local +z",
            "rest pose: ~ joint 3  rotation 0 0 0 1 → 0 0 0.7071068 0.7071068",
        ],
    ),
    "rest scaled": (
        lambda b: _node(b, 3).update(scale=[1, 2, 1]),
        ["rest pose: ~ joint 3  scale 1 1 1 → 1 2 1"],
    ),
    "an extra": (
        lambda b: _node(b, 2)["extras"]["a"][1].update(b=0),
        ["json: ~ /nodes/2/extras/a/1/b  null → 0"],
    ),
    "an extra gone": (
        lambda b: _node(b, 2)["extras"].pop("a"),
        ['json: - /nodes/2/extras/a  [1, {"b": null}]'],
    ),
    "an unknown member": (lambda b: b.gltf.update(odd=True), ["json: + /odd  true"]),
    "an unknown member with a slash": (
        lambda b: b.gltf.update({"odd/~": True}),
        ["json: + /odd~1~0  true"],
    ),
    "a bool for a number": (
        lambda b: b.gltf["asset"].update(extras=True),
        ["json: ~ /asset/extras  5 → true"],
    ),
    "another spelling": (
        lambda b: _node(b, 3).update(scale=[1, 1.0, 1.0]),
        ["json: ~ /nodes/3/scale  spelled [1.0, 1.0, 1.0] → [1, 1.0, 1.0]"],
    ),
    "another order of keys": (
        lambda b: b.gltf["asset"].update(version=b.gltf["asset"].pop("version")),
        ["json: > /asset  order of keys: version copyright extras → copyright extras version"],
    ),
    "keys": (
        _swap_keys,
        [
            "clips: ~ #0: rotation of joint 1  values: 2 of 2 keys differ, by up to",
            "accessors: ~ accessor 5 (keys of rotation of node 1 in animation #0)  8 of 8 numbers differ",
            "buffer views: ~ bufferView 5  ",
        ],
    ),
    "interpolation": (
        lambda b: b.gltf["animations"][0]["samplers"][0].update(interpolation="STEP"),
        ["clips: ~ #0: rotation of joint 1  interpolation LINEAR → STEP"],
    ),
    "key times": (
        lambda b: _write(b, 4, [0, 2]),
        ["clips: ~ #0: rotation of joint 1  times: 1 of 2 numbers differ, by up to 1"],
    ),
    "another target": (
        lambda b: b.gltf["animations"][0]["channels"][0]["target"].update(node=2),
        ["clips: - #0: rotation of joint 1  2 keys", "clips: + #0: rotation of joint 2  2 keys"],
    ),
    "no clip": (lambda b: b.gltf.pop("animations"), ["clips: - #0  1 tracks"]),
    "a moved accessor": (
        _moved_accessor,
        ["json: > /animations/0/samplers/0/output  accessor 5 → 6, equal content"],
    ),
    "inverse binds": (
        lambda b: _write(b, 3, np.diag([1, 1, 1, 1.0]).reshape(-1)),
        ["bind pose: ~ joint 0  position 0 1 0 → 0 0 0"],
    ),
    "order of a skin": (
        _new_skin_order,
        ["skins: > joints of skin #0  order: joint 0 joint 1 joint 2 joint 3 → joint 0 joint 2 joint 1"],
    ),
    "weights": (
        lambda b: _write(b, 2, [0.25, 0.75, 0, 0]),
        ["skins: ~ weights of #4/0  1 of 3 vertices differ, by up to 0.25"],
    ),
    "points": (
        lambda b: _write(b, 0, [5, 0, 0]),
        ["meshes: ~ #4/0  points: 1 of 9 numbers differ, by up to 5"],
    ),
    "an image": (
        lambda b: b.binary.__setitem__(slice(-20, -12), b"an IMAGE"),
        ["images: ~ image 0 skin  5 of 8 bytes differ, the first at 3"],
    ),
    "loose bytes": (
        lambda b: b.binary.__setitem__(slice(-12, -1), b"other bytes"),
        ["loose bytes: ~ buffer 0, bytes "],
    ),
    "more loose bytes": (
        lambda b: (b.view(b"seen"), b.binary.extend(bytes(4))),
        ["loose bytes: + buffer 0, bytes "],
    ),
    "loose bytes gone": (
        lambda b: b.binary.__delitem__(slice(-12, None)),
        ["loose bytes: - buffer 0, bytes "],
    ),
}


@pytest.mark.parametrize("name", GLTF)
def test_a_difference_of_gltf_files_is_named(name: str, tmp_path: Path) -> None:
    change, wanted = GLTF[name]
    other = figure()
    change(other)
    found = diff(figure().glb(tmp_path / "a.glb"), other.glb(tmp_path / "b.glb"), verify=False)
    told = lines(found)
    for line in wanted:
        assert any(text.startswith(line) for text in told), told


@pytest.mark.parametrize(
    ("mine", "theirs", "wanted"),
    [
        ((), (CHUNK,), ["chunks: ~ chunks  JSON BIN → JSON BIN ADD1", "chunks: + chunk ADD1  3 bytes"]),
        ((CHUNK,), (), ["chunks: - chunk ADD1  3 bytes"]),
        ((CHUNK,), ((CHUNK[0], b"oDd"),), ["chunks: ~ chunk ADD1  1 of 3 bytes differ, the first at 1"]),
    ],
)
def test_other_chunks_are_named(mine: Any, theirs: Any, wanted: list[str], tmp_path: Path) -> None:
    one, other = figure().glb(tmp_path / "a.glb", mine), figure().glb(tmp_path / "b.glb", theirs)
    told = lines(diff(one, other))
    assert set(wanted) <= set(told)


def test_another_indentation_is_named_and_nothing_else(tmp_path: Path) -> None:
    one = figure().gltf_file(tmp_path / "a.gltf")
    text = one.read_text("utf-8")
    tabs = tmp_path / "b.gltf"
    tabs.write_text(json.dumps(json.loads(text), indent="\t"), "utf-8")
    assert lines(diff(one, tabs)) == ["spelling: ~ indent  '  ' → '\\t'"]
    windows = tmp_path / "c.gltf"
    windows.write_bytes((text.replace("\n", "\r\n") + "\r\n").encode())
    assert lines(diff(one, windows)) == [
        "spelling: ~ newline  '\\n' → '\\r\\n'",
        "spelling: ~ blanks at the end  '' → '\\r\\n'",
    ]
    odd = tmp_path / "d.gltf"
    odd.write_text(text.replace('"copyright": "nobody"', '"copyright":  "nob\\u006fdy"'), "utf-8")
    assert lines(diff(one, odd))[0].startswith("spelling: ~ text  blanks or escapes, from character ")


def test_a_tolerance_lets_numbers_pass_and_nothing_else(tmp_path: Path) -> None:
    other = figure()
    other.gltf["nodes"][1]["translation"] = [0, 1.0001, 0]
    one, two = figure().glb(tmp_path / "a.glb"), other.glb(tmp_path / "b.glb")
    assert not diff(one, two).same
    assert diff(one, two, tolerance=1e-3).same
    other.gltf["nodes"][1]["name"] = "else"
    assert not diff(one, other.glb(tmp_path / "c.glb"), tolerance=1e-3).same


# USD


def _usd(change: tuple[str, str], folder: Path) -> Difference:
    one = planted(folder, ".usda")
    text = one.read_text("utf-8")
    assert text.count(change[0]) >= 1
    return diff(one, usd_files.save(folder, text.replace(*change), "b.usda"), verify=False)


USD = {
    "a default": (("t_half = 0.5", "t_half = 0.25"), "root layer: ~ /Root/Odd.t_half  0.5 → 0.25"),
    "a type": (
        ("custom int t_int = -7", "custom int64 t_int = -7"),
        "root layer: ~ /Root/Odd.t_int typeName",
    ),
    "a text": (
        ('"about it"', '"about us"'),
        "root layer: ~ /Root/Odd.u_token documentation  about it → about us",
    ),
    "custom data": (("int one = 1", "int one = 2"), "root layer: ~ /Root/Odd.u_token customData:one  1 → 2"),
    "layer data": (("bool yes = 1", ""), "root layer: - / customLayerData:yes  was True"),
    "a sample": (
        ("7.25: []", "7.25: [1]"),
        "root layer: ~ /Root/Odd.t_flags samples  1 of 2, first at 7.25: [] → [1]",
    ),
    "a time": (("7.25: []", "8: []"), "root layer: - /Root/Odd.t_flags samples  1 of 2: 7.25"),
    "a blocked sample": (("2: None", "2: 4"), "root layer: ~ /Root/Odd.t_held samples  1 of 3, first at 2"),
    "a relationship": (("<Root/Nowhere>", "<Root/Odd>"), ""),
    "an API schema": (('"NobodyAPI", ', ""), "root layer: ~ /Root/Odd apiSchemas"),
    "a prim": (('def "Typeless"', 'def "Typed"'), "root layer: - /Root/Odd/Typeless  def"),
    "a specifier": (('over "Second"', 'def "Second"'), "root layer: ~ /Root/Odd/Second specifier"),
    "a variant": (("custom int deep = 3", ""), "root layer: - /Root/Odd{size=big}{inner=one}.deep  int"),
    "a selection": (
        ('look = "blue"', 'look = "red"'),
        "root layer: ~ /Root/Odd variantSelection:look  blue → red",
    ),
    "a sublayer's offset": (
        ("offset = 3", "offset = 4"),
        "root layer: ~ sublayer ./sub.usda  offset and scale 3 2 → 4 2",
    ),
    "a spline": (("9: 7; pre", "9: 8; pre"), "root layer: ~ /Root/Odd.t_curve spline"),
    "an order": (('["Second", "First"]', '["First", "Second"]'), "root layer: ~ /Root/Odd primOrder"),
    "units": (("metersPerUnit = 0.013", "metersPerUnit = 1"), "root layer: ~ / metersPerUnit  0.013 → 1"),
    "a rest pose": (("(0, 2, 1, 1))]", "(0, 2, 1.5, 1))]"), "places: ~ c  stands 0.5 away"),
    "weights": (
        ("[1, 0, 0.5, 0.5, 1, 0]", "[1, 0, 0.4, 0.6, 1, 0]"),
        "skins: ~ weights of /Root/Skin  1 of 3 vertices",
    ),
    "keys": (
        ("(0.8, 0.6, 0, 0)],", "(0.6, 0.8, 0, 0)],"),
        "clips: ~ Anim: rotation of c  values: 1 of 2 keys differ, by up to 32.5°",
    ),
}


@pytest.mark.parametrize("name", [name for name in USD if USD[name][1]])
def test_a_difference_of_usd_files_is_named(name: str, tmp_path: Path) -> None:
    change, wanted = USD[name]
    told = lines(_usd(change, tmp_path))
    assert any(line.startswith(wanted) for line in told), told


def test_a_root_and_the_prim_below_it_may_both_be_renamed(samples: Path, tmp_path: Path) -> None:
    text = (samples / "biped.usda").read_text()
    for old, new in (("Xform", "hero"), ("SkelRoot", "rig")):
        (name,) = re.findall(rf'^ *def {old} "(biped|figure)"', text, re.M)
        text = re.sub(rf'(?<=[/"]){name}\b', new, text)
    (tmp_path / "hero.usda").write_text(text)
    found = lines(diff(samples / "biped.usda", tmp_path / "hero.usda"), "rig")
    assert found == ["hierarchy: ~ node biped  renamed to hero", "hierarchy: ~ node figure  renamed to rig"]


def test_a_comment_is_a_difference_of_spelling(tmp_path: Path) -> None:
    found = _usd(('def UnknownType "Odd"', '# a comment\ndef UnknownType "Odd"'), tmp_path)
    assert [line.partition(", from byte")[0] for line in lines(found)] == [
        "spelling: ~ bytes  comments, blanks or layout"
    ]


def test_another_encoding_is_the_only_difference_of_a_copy(tmp_path: Path) -> None:
    one = planted(tmp_path, ".usda")
    Sdf.Layer.FindOrOpen(str(one)).Export(str(tmp_path / "b.usdc"))
    found = diff(one, tmp_path / "b.usdc", verify=False)
    assert lines(found) == ["layers: ~ root layer  encoding usda → usdc"]


@pytest.mark.ci
def test_a_difference_of_another_layer_is_named_by_its_path(tmp_path: Path) -> None:
    one = planted(tmp_path / "a", ".usda")
    two = planted(tmp_path / "b", ".usda")
    assert diff(one, two, verify=False).same
    below = two.with_name("sub.usda")
    below.write_text(below.read_text().replace("below = 1", "below = 2"))
    assert lines(diff(one, two, verify=False)) == ["sub.usda: ~ /Root.below  1 → 2"]


def test_entries_of_packages_are_compared(tmp_path: Path) -> None:
    one = planted(tmp_path, ".usdz")
    two = tmp_path / "b.usdz"
    content = one.read_bytes()
    two.write_bytes(content.replace(b"notes\r\n", b"NOTES\r\n"))
    told = lines(diff(planted(tmp_path / "c", ".usda"), one, verify=False))
    assert "package: ~ container  .usda → .usdz" in told
    # The sums of the zip no longer fit, which nobody here asks for.
    assert lines(diff(one, two, verify=False))[0].startswith("package: ~ z/notes.txt  7 bytes, other ones")
    with zipfile.ZipFile(one) as package:
        stamp = package.infolist()[1].date_time
    assert stamp[0] == 2000
    old, new = ((year - 1980) << 9 | 12 << 5 | 31 for year in (2000, 2010))
    two.write_bytes(content.replace(old.to_bytes(2, "little"), new.to_bytes(2, "little")))
    assert "package: ~ tex.png  date 2000-12-31 23:59:58 → 2010-12-31 23:59:58" in lines(diff(one, two))


# Both formats


def test_new_pole_vectors_are_new_locators(samples: Path, tmp_path: Path) -> None:
    for name in ("biped.glb", "biped.usda"):
        out = tmp_path / name
        edit(
            samples / name,
            out,
            lambda rig, report: add_polevector(
                rig, options=AddPolevectorOptions(limbs="auto"), report=report
            ),
        )
        told = lines(diff(samples / name, out), "rig")
        assert any(line.startswith("hierarchy: + poleVector ") for line in told)
        assert all(line.startswith(("hierarchy: +", "controls and locators: +")) for line in told)


def test_files_of_two_formats_are_compared_in_rig_terms(samples: Path) -> None:
    found = diff(samples / "biped.glb", samples / "biped.usda")
    assert found.file is None
    assert found.rig
    assert "two formats" in found.notices[0]
    assert found.looks is not None
    with pytest.raises(FileError, match="two formats"):
        diff(samples / "biped.glb", samples / "biped.usda", only="file")


def test_a_glb_and_the_stage_made_of_it_look_as_verify_says(samples: Path, tmp_path: Path) -> None:
    out = tmp_path / "hero.usda"
    rigtri.convert(samples / "hand.glb", out)
    for one, other in ((samples / "hand.glb", out), (out, samples / "hand.glb")):
        looks = rigtri.diff(one, other).looks
        assert looks is not None
        assert looks.deviation < 1e-6
        assert not looks.lost


def test_without_a_rig_the_files_are_still_compared(tmp_path: Path) -> None:
    broken = figure()
    broken.gltf["nodes"][0]["rotation"] = [0, 0, 0, 0]
    one, two = figure().glb(tmp_path / "a.glb"), broken.glb(tmp_path / "b.glb")
    found = diff(one, two)
    assert found.rig is None
    assert lines(found) == ["json: + /nodes/0/rotation  [0, 0, 0, 0]"]
    assert "has the rotation 0 0 0 0" in found.notices[0]
    with pytest.raises(FileError, match="has the rotation 0 0 0 0"):
        diff(one, two, only="rig")
    assert diff(two, two).same


def test_joints_without_a_frame_do_not_differ_from_themselves(tmp_path: Path) -> None:
    flat = figure()
    flat.gltf["nodes"][1]["scale"] = [0, 0, 0]
    path = flat.glb(tmp_path / "a.glb")
    assert diff(path, path).same
    assert lines(diff(figure().glb(tmp_path / "b.glb"), path), "rig")


def test_a_file_with_fewer_buffers_is_compared(tmp_path: Path) -> None:
    one, two = figure(), figure()
    path = one.glb(tmp_path / "a.glb")
    two.glb(tmp_path / "b.glb")
    two.gltf["buffers"].append({"byteLength": 3, "uri": "data:;base64,AAAA"})
    (tmp_path / "b.glb").write_bytes(gltf_files.glb_bytes(two.gltf, bytes(two.binary)))
    there, back = diff(path, tmp_path / "b.glb"), diff(tmp_path / "b.glb", path)
    assert [line[:19] for line in lines(there)] == ["json: + /buffers/1 "]
    assert [line[:19] for line in lines(back)] == ["json: - /buffers/1 ", "buffers: - buffer 1"]


@pytest.mark.parametrize("seed", range(40))
def test_whatever_stands_in_the_json_is_compared_or_refused(seed: int, tmp_path: Path) -> None:
    pick = random.Random(seed)
    broken = figure()
    for _ in range(3):
        place: Any = broken.gltf
        while isinstance(place, dict | list) and place:
            key = pick.choice(list(place) if isinstance(place, dict) else range(len(place)))
            if not isinstance(place[key], dict | list) or not place[key] or pick.random() < 0.2:
                place[key] = pick.choice([None, -1, 1e300, 2**70, "x", [], {}, [[1]], {"a": 1}, True, 99])
                break
            place = place[key]
    one = figure().glb(tmp_path / "a.glb")
    content = gltf_files.glb_bytes(broken.gltf, bytes(broken.binary))
    (tmp_path / "b.glb").write_bytes(content)
    for pair in ((one, tmp_path / "b.glb"), (tmp_path / "b.glb", one)):
        with suppress(FileError):
            assert not diff(*pair, verify=False).same


@pytest.mark.ci
def test_how_they_look_is_measured_unless_disabled(samples: Path, tmp_path: Path) -> None:
    out = tmp_path / "biped.glb"
    edit(samples / "biped.glb", out, lambda rig, report: orient_joints(rig, report=report))
    found = diff(samples / "biped.glb", out)
    assert found.looks is not None
    assert found.looks.passes()
    assert found.describe().startswith("looks  largest vertex movement: ")
    assert diff(samples / "biped.glb", out, verify=False).looks is None


# The program


run = partial(cli, "diff")


def test_the_program_ends_with_0_1_and_2(samples: Path, tmp_path: Path) -> None:
    one = samples / "biped.glb"
    same = run(one, one)
    assert (same.exit_code, same.stdout, same.stderr) == (0, "", "")
    differ = run(one, samples / "tail.glb", "--brief")
    assert (differ.exit_code, differ.stdout) == (1, f"{one} and {samples / 'tail.glb'} differ\n")
    (tmp_path / "bad.glb").write_bytes(b"glTF\2\0\0\0")
    for bad in (tmp_path / "none.glb", tmp_path / "bad.glb", tmp_path):
        result = run(one, bad, code=2)
        assert result.stderr.startswith("rigtri: ")
    run(one, code=2)
    run(one, one, "--only", "nothing", code=2)


@pytest.mark.ci
def test_long_groups_are_cut_unless_all_is_requested(samples: Path, tmp_path: Path) -> None:
    out = tmp_path / "out.glb"
    edit(samples / "biped.glb", out, lambda rig, report: orient_joints(rig, report=report))
    short, full = (run(samples / "biped.glb", out, *flags).stdout for flags in ([], ["--all"]))
    assert "rig: axes, 23 differences" in short
    assert "… and 15 more (--all)" in short
    assert "more (--all)" not in full
    assert len(full.splitlines()) > len(short.splitlines())
    rig = run(samples / "biped.glb", out, "--only", "rig").stdout
    assert "file: " not in rig
    assert "rig: " not in run(samples / "biped.glb", out, "--only", "file").stdout


def test_the_program_speaks_json(samples: Path, tmp_path: Path) -> None:
    out = tmp_path / "out.glb"
    edit(samples / "biped.glb", out, lambda rig, report: orient_joints(rig, report=report))
    for other in (out, samples / "biped.glb", samples / "biped.usda"):
        told = json.loads(run(samples / "biped.glb", other, "--json").stdout)
        validator("diff").validate(told)
        assert told["same"] == (other == samples / "biped.glb")


@pytest.mark.parametrize("tolerance", [0.0, 0.5])
def test_an_integer_beyond_all_floats_is_reported(tolerance: float, tmp_path: Path) -> None:
    builder = small()
    builder.gltf["extras"] = [1, 2]
    before = builder.glb(tmp_path / "before.glb")
    builder.gltf["extras"] = [10**400, 2.5]
    after = builder.glb(tmp_path / "after.glb")
    assert [change.where for change in diff(before, after, tolerance=tolerance, only="file").file]


# Many at once


def test_rows_are_the_same_as_each_alone() -> None:
    """NaN equals NaN, −0 is not 0, and beside a NaN the signs do not count, as for one array."""
    rows = np.array(
        [[1, 0, 2], [1, -0.0, 2], [np.nan, 0, 2], [np.nan, -0.0, 2], [1, 0, 2.01], [np.inf, 0, 2]]
    )
    first, second = (np.ascontiguousarray(x) for x in (np.repeat(rows, 6, axis=0), np.tile(rows, (6, 1))))
    for tolerance in (0.0, 0.1):
        alone = [same_numbers(a, b, tolerance) for a, b in zip(first, second, strict=True)]
        assert same_rows(first, second, tolerance).tolist() == alone
        assert set(alone) == {True, False}


def test_rotations_of_many_frames_are_those_of_each_alone() -> None:
    """A turn by a known angle about a known axis of the frame, half turns among them; NaN is none."""
    random = np.random.default_rng(3)
    before = unit(random.normal(size=(40, 4)))
    axes = normalise(random.normal(size=(40, 3)))
    angles = np.append(random.uniform(0.01, 3.1, 39), np.pi)
    turn_by = np.concatenate([axes * np.sin(angles / 2)[:, np.newaxis], np.cos(angles / 2)[:, np.newaxis]], 1)
    frames = to_axes(before), to_axes(multiply(before, turn_by))
    degrees, lines = turns(*frames)
    assert np.allclose(degrees, np.degrees(angles), atol=1e-9)
    same_line = np.abs((normalise(lines) * axes).sum(axis=1))
    assert np.allclose(same_line, 1.0, atol=1e-9)
    assert np.isnan(turns(np.full((1, 3, 3), np.nan), np.eye(3)[np.newaxis])[0][0])


@pytest.mark.parametrize("size", [1.0, 1000.0])
@pytest.mark.parametrize(
    ("tolerance", "share", "shown"),
    [(0.0, 0.5e-6, False), (0.0, 2e-6, True), (1e-4, 0.5e-4, False), (1e-4, 2e-4, True)],
)
def test_places_and_axes_count_from_the_rounding_of_the_joints_above_on(
    size: float, tolerance: float, share: float, shown: bool
) -> None:
    """From a millionth of the rig's size on, axes from a millionth of a radian on, or from the tolerance."""
    before = chain((0, 0, 0), (0.6 * size, 0, 0), (0.6 * size, 0.8 * size, 0))
    moved, turned = before.translation.copy(), before.rotation.copy()
    moved[2, 2] = share * size
    turned[1] = from_axis_angle(np.array([1.0, 0, 0]), share)
    places = rig_changes(before, replace(before, translation=moved), tolerance=tolerance * size)
    axes = rig_changes(before, replace(before, rotation=turned), tolerance=tolerance)
    assert [each.where for each in places if each.group == "places"] == ["c"] * shown
    assert [each.where for each in axes if each.group == "axes"] == ["b", "c"] * shown


def test_another_order_of_children_and_roots_is_that_of_those_that_both_have() -> None:
    names, more = ["top", "a", "b", "c", "side"], ["side", "top", "c", "new", "a", "b"]
    before = rig_of(names, [-1, 0, 0, 0, -1], np.eye(5, 3))
    after = rig_of(more, [-1, -1, 1, 1, 1, 1], np.eye(6, 3))
    moved = [str(each) for each in rig_changes(before, after) if each.kind == "moved"]
    assert [text.split("order: ")[1] for text in moved if "order" in text] == [
        "a b c → c a b",
        "top side → side top",
    ]


@pytest.mark.ci
def test_the_work_of_a_difference_grows_as_the_joints_do(tmp_path: Path) -> None:
    """Four times as many joints take at most a little over four times as many calls, whatever the machine."""

    def work(joints: int) -> int:
        before = read(small(joints).glb(tmp_path / f"{joints}.glb")).rig
        after = orient_joints(before)
        assert rig_changes(before, after)  # what is worked out once and kept is there now
        return calls(lambda: rig_changes(before, after))

    assert work(2000) < 4.4 * work(500)


@pytest.mark.parametrize("nodes", [0, 1])
def test_files_without_nodes_or_anything_else_differ_from_nothing_in_themselves(
    nodes: int, tmp_path: Path
) -> None:
    path = tmp_path / "empty.gltf"
    path.write_text(json.dumps({"asset": {"version": "2.0"}, **({"nodes": [{}] * nodes} if nodes else {})}))
    assert diff(path, path).same
    result = cli("diff", path, path)
    assert (result.exit_code, result.output) == (0, "")


def test_a_mistake_of_ours_in_diff_is_no_answer(monkeypatch: pytest.MonkeyPatch, samples: Path) -> None:
    def broken(*_: Any, **__: Any) -> None:
        raise AssertionError("a mistake of ours")

    monkeypatch.setattr("rigtri.verification.diff.diff.diff", broken)
    result = cli("diff", samples / "biped.glb", samples / "biped.glb", code=2)
    assert "a mistake of ours" in result.stderr


@pytest.mark.parametrize(
    ("off", "words"), [(0.0, []), (0.5, ["meshes: ~ body/0  morphs: 1 of 9 numbers differ, by up to 0.5"])]
)
def test_offsets_of_morph_targets_are_compared(off: float, words: list[str], tmp_path: Path) -> None:
    def built(name: str, offset: float) -> Path:
        b = small(2)
        offsets = [[0, offset, 1], [0, 0, 1], [0, 0, 1]]
        b.gltf["meshes"][0]["name"] = "body"
        b.gltf["meshes"][0]["primitives"][0]["targets"] = [{"POSITION": b.points(offsets)}]
        b.gltf["meshes"][0]["weights"] = [0.25]
        return b.glb(tmp_path / name)

    found = diff(built("one.glb", 0.0), built("two.glb", off), verify=False)
    assert [line for line in lines(found, "rig") if "morph" in line] == words


def test_two_siblings_may_be_renamed_at_once() -> None:
    """Each is the one at its place among those that nobody else claims."""
    before = rig_of(["root", "a", "b", "c"], [-1, 0, 0, 0], np.eye(4)[:, :3])
    after = replace(
        before, names=("root", "left", "b", "right"), labels=("#0", "#7", "#2", "#9"), keys=(0, 7, 2, 9)
    )
    found = [str(each) for each in rig_changes(before, after)]
    assert [each.partition("  ")[2] for each in found] == ["renamed to left", "renamed to right"]


@pytest.mark.parametrize(
    ("before", "after", "told"),
    [
        (0, 0, ["~ walk  renamed to run"]),
        (0, 5, ["- walk  1 tracks", "+ run  1 tracks"]),
        (None, None, ["- walk  1 tracks", "+ run  1 tracks"]),
        (0, None, ["- walk  1 tracks", "+ run  1 tracks"]),
    ],
)
def test_a_clip_of_another_name_is_the_same_by_its_key(before: Any, after: Any, told: list[str]) -> None:
    rig = chain((0, 0, 0), (1, 0, 0))
    track = Track(1, "translation", "LINEAR", np.array([0.0, 1.0]), np.eye(3)[:2])
    pair = [
        replace(rig, clips=(Clip(name, (track,), key=key),))
        for name, key in (("walk", before), ("run", after))
    ]
    assert [str(each) for each in rig_changes(*pair)] == told
