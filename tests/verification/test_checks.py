"""rigtri check finds each thing that is wrong, all of them, and nothing else."""

from __future__ import annotations

import json
import tracemalloc
from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from body_files import AXES
from broken_gltf import GLTF, attribute, sparse_texture
from broken_gltf import clean as clean_gltf
from broken_usd import USD
from broken_usd import clean as clean_usd
from broken_vrm import VRM, avatar_0, avatar_1, motion
from calls import calls
from gltf_files import glb_bytes, glb_parts
from places import SAMPLES, sample_files
from program import cli
from pxr import Usd, UsdValidation
from usd_files import save
from wrong_values import refusal

from rigtri import read, write
from rigtri.model.metadata import TwistRecord
from rigtri.verification.checks import RULES, Finding, check
from rigtri.verification.checks.findings import Findings
from rigtri.verification.checks.gltf.tolerant_reader import View
from rigtri.verification.checks.usd import check_usd, usd_validation

BROKEN = GLTF | VRM | USD | AXES | {"clips.far": [*GLTF["clips.far"], *USD["clips.far"]]}
# What a mistake brings with it: the smallest file with the one has the other, too.
ALONG = {
    "gltf.accessor.broken": {"gltf.accessor.bounds"},
    "gltf.reference": {"gltf.accessor.broken"},
    "vrm.spring.shape": {"gltf.extension.undeclared"},
    "usd.skel.no-joints": {"usd.skel.bind-missing"},
}


def ids(findings: Iterable[Finding]) -> set[str]:
    return {finding.id for finding in findings}


def serious(findings: Iterable[Finding]) -> set[str]:
    return {finding.id for finding in findings if finding.severity != "info"}


CASES = [(rule, k, make) for rule, makes in BROKEN.items() for k, make in enumerate(makes)]


@pytest.fixture(scope="module")
def broken(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("broken")


@cache
def examined(case: int, broken: Path) -> tuple[list[Finding], str]:
    """All findings of the smallest file of a case, in order, and why the reader refuses it."""
    (folder := broken / str(case)).mkdir()
    path = CASES[case][2](folder)
    return list(check(path)), refusal(path)


@pytest.mark.parametrize(
    ("case", "rule"),
    [(case, rule) for case, (rule, _, _) in enumerate(CASES)],
    ids=[f"{rule}-{k}" for rule, k, _ in CASES],
)
def test_the_smallest_broken_file_gives_just_that_finding(case: int, rule: str, broken: Path) -> None:
    """And an error, where the reader refuses the file."""
    findings, refused = examined(case, broken)
    assert rule in ids(findings)
    wanted = {rule} if RULES[rule].severity != "info" else set()
    assert serious(findings) - wanted == ALONG.get(rule, set()) & serious(findings)
    (first, *_) = [finding for finding in findings if finding.id == rule]
    assert first.place
    assert first.message
    assert first.remedy
    assert first.severity == RULES[rule].severity
    # No skeleton at all is no fault of a file.
    if refused and "no skeleton" not in refused:
        assert "error" in {finding.severity for finding in findings}


# Rules whose messages have words of other libraries.
FOREIGN = ("file.unreadable", "usd.layer.unreadable", "usd.layer.cycle", "usd.layer.time-offset")


def test_each_finding_says_where_and_what_and_the_reader_why_it_refuses(broken: Path, golden: Any) -> None:
    """Of every broken file all findings in order, and the error of the reader."""
    lines: list[str] = []
    for case, (rule, k, _) in enumerate(CASES):
        if rule not in FOREIGN:
            findings, refused = examined(case, broken)
            folder = broken / str(case)
            told = [f"{f.id}: {f.place}: {f.pointer}: {f.message}" for f in findings]
            told += [f"refused: {refused}"] if refused else []
            told = [one.replace(f"{folder}/", "").replace(str(folder), "") for one in told]
            lines += [f"# {rule}-{k}", *told]
    golden.check("findings.txt", "\n".join(lines) + "\n")


def test_a_vertex_that_is_no_number_is_named_with_its_place(tmp_path: Path) -> None:
    """Positions, too, each attribute by itself; weights as a whole are told of once, as weights."""
    gone = [[0, 0, 0], [np.nan, 0, 0], [0, np.inf, 0]]
    stated = {"min": [0, 0, 0], "max": [0, 0, 0]}
    b = clean_gltf()
    primitive = b.gltf["meshes"][0]["primitives"][0]
    primitive["attributes"] |= {
        "POSITION": b.accessor(gone, **stated),
        "NORMAL": b.accessor(gone),
        "WEIGHTS_0": b.accessor([[np.nan, 1, 0, 0]] * 3),
    }
    primitive["targets"] = [{}, {"POSITION": b.accessor(gone, **stated)}]
    found = [item for item in check(b.glb(tmp_path / "a.glb")) if item.id.endswith("-nan")]
    assert {(item.place, item.pointer, item.message) for item in found if "vertex" in item.id} == {
        (
            f"mesh #0, primitive 0, {name}",
            f"/meshes/0/primitives/0/{pointer}",
            "vertex 1 is not a finite number (2 of 3 vertices)",
        )
        for name, pointer in (
            ("POSITION", "attributes/POSITION"),
            ("NORMAL", "attributes/NORMAL"),
            ("morph target 1 POSITION", "targets/1/POSITION"),
        )
    }
    assert [item.id for item in found if "vertex" not in item.id] == ["gltf.mesh.weight-nan"]


def test_what_a_sparse_accessor_replaces_does_not_count(tmp_path: Path) -> None:
    rows = [[0, 0], [0, 0], [np.nan, 0]]
    assert "gltf.mesh.vertex-nan" in ids(check(sparse_texture(rows, {1: [1, 1]})(tmp_path)))
    assert "gltf.mesh.vertex-nan" not in ids(check(sparse_texture(rows, {2: [1, 1]})(tmp_path)))


@pytest.mark.ci
def test_vertices_are_looked_at_some_at_a_time(tmp_path: Path) -> None:
    """A million more vertices, of which one is wrong far behind, take little more memory than their bytes."""
    normals = np.zeros((1_000_000, 3), dtype=np.float32)
    normals[777_777, 1] = np.nan
    b = clean_gltf()
    b.gltf["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = b.accessor(normals)
    path = b.gltf_file(tmp_path / "a.gltf")
    tracemalloc.start()
    try:
        findings = check(path)
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    (found,) = [item for item in findings if item.id == "gltf.mesh.vertex-nan"]
    assert "vertex 777777 is not a finite number (1 of 1000000 vertices)" in found.message
    # The bytes of the file themselves; decoded at once they would be twice as many more.
    assert peak < 1.5 * normals.nbytes


MESHES = [make for rule, makes in GLTF.items() if rule.startswith("gltf.mesh.") for make in makes]


@pytest.mark.parametrize("make", MESHES)
def test_influences_looked_at_point_by_point_are_judged_the_same(
    make: Callable[[Path], Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = make(tmp_path)
    together = check(path)
    for module in ("tolerant_reader", "meshes"):
        monkeypatch.setattr(f"rigtri.verification.checks.gltf.{module}.BLOCK", 1)
    assert check(path) == together


def test_the_farthest_sum_of_weights_is_named_wherever_it_stands(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    make = attribute("WEIGHTS_0", [[0.5, 0.4, 0, 0], [0.5, 0.1, 0, 0], [0.5, 0.1, 0, 0]])
    monkeypatch.setattr("rigtri.verification.checks.gltf.meshes.BLOCK", 1)
    (found,) = (item for item in check(make(tmp_path)) if item.id == "gltf.mesh.weight-sum")
    assert found.message.startswith("the weights of vertex 1 sum to 0.6 (3 of 3 vertices)")


def test_every_check_has_a_file_that_breaks_it() -> None:
    assert set(BROKEN) == set(RULES)


@pytest.mark.parametrize("make", [clean_gltf, avatar_1, avatar_0, motion])
def test_there_is_nothing_to_report_of_a_sound_gltf(make: object, tmp_path: Path) -> None:
    assert callable(make)
    findings = check(make().glb(tmp_path / "a.glb"))
    assert findings == []


def test_there_is_nothing_to_report_of_a_sound_stage(tmp_path: Path) -> None:
    assert check(save(tmp_path, clean_usd())) == []


@pytest.mark.parametrize("path", sample_files(), ids=lambda path: path.name)
def test_samples_have_neither_errors_nor_warnings(path: Path) -> None:
    # Two roots and no node above them: glTF asks for one, and the Khronos validator misses it here.
    rootless = {"gltf.skin.no-common-root"} if path.name == "mirrored_pair.glb" else set()
    assert serious(check(path)) == rootless


def test_metadata_finds_nodes_without_names_by_their_paths(tmp_path: Path) -> None:
    gltf, binary = glb_parts(SAMPLES / "hand.glb")
    for node in gltf["nodes"]:
        node.pop("name", None)
    source, controls = tmp_path / "a.glb", tmp_path / "out.glb"
    source.write_bytes(glb_bytes(gltf, binary))
    cli("add-controls", source, "-o", controls, "--chain", "#1", "#3", code=0)
    assert "gltf.note.broken" not in {finding.id for finding in check(controls)}


@pytest.mark.parametrize("suffix", [".glb", ".usda"])
def test_a_twist_joint_that_was_parented_elsewhere_is_told_with_what_to_do(
    suffix: str, tmp_path: Path
) -> None:
    """Before, check said nothing, and bake refused the file."""
    twisted = tmp_path / f"twisted{suffix}"
    cli("add-twist", SAMPLES / f"biped{suffix}", "-o", twisted, "--limbs", "auto", "--count", 1, code=0)
    assert not {finding.id for finding in check(twisted) if "note" in finding.id}
    rig = read(twisted)
    node, record = next((n, r) for n, r in rig.records(TwistRecord).items() if "upper_arm" in r.joint)
    forearm = rig.address(rig.find("forearm_L"))
    told = replace(record, joint=forearm, driver=rig.address(rig.find("hand_L"))).to_dict()
    copied = tmp_path / f"copied{suffix}"
    write(replace(rig, metadata={**rig.metadata, node: told}), copied)
    (finding,) = [finding for finding in check(copied) if finding.id.endswith("note.broken")]
    assert f"has the metadata of a twist joint of '{forearm}', and is not its child" in finding.message
    assert f"Parent it to '{forearm}' again, or remove that metadata" in finding.message


def test_metadata_finds_joints_by_their_paths_whatever_their_tokens_begin_with(tmp_path: Path) -> None:
    """Tokens of joints may begin with prims that are no joints, and names be those of prims, too."""
    text = (SAMPLES / "biped.usda").read_text("utf-8").replace('"hips', '"figure/hips')
    text = text.replace('def Mesh "staff"', 'def Xform "hips" {\n}\n\ndef Mesh "staff"')
    source, controls = save(tmp_path, text), tmp_path / "out.usda"
    cli("add-controls", source, "-o", controls, "--whole-character", code=0)
    assert "usd.note.broken" not in {finding.id for finding in check(controls)}


def test_all_mistakes_of_a_file_are_reported_and_the_worst_first(tmp_path: Path) -> None:
    b = clean_gltf()
    b.gltf["nodes"][1]["rotation"] = [0, 0, 0, 2]
    b.gltf["skins"][0] |= {"joints": [0, 1, 1, 88], "skeleton": 2}
    b.gltf["animations"][0]["channels"][0]["sampler"] = 5
    b.gltf["nodes"][2]["name"] = "joint 1"
    findings = check(b.glb(tmp_path / "a.glb"))
    assert ids(findings) == {
        "gltf.node.rotation-not-unit",
        "gltf.skin.joint-twice",
        "gltf.skin.joint-missing",
        "gltf.skin.inverse-bind-count",
        "gltf.skin.skeleton-not-above",
        "gltf.animation.sampler-missing",
    }
    severities = [finding.severity for finding in findings]
    assert severities == sorted(severities, key=["error", "warning", "info"].index)


def test_a_finding_names_the_place_as_the_user_does(tmp_path: Path) -> None:
    b = clean_gltf()
    b.gltf["skins"][0] |= {"name": "body", "joints": [0, 1, 1]}
    (found,) = check(b.glb(tmp_path / "a.glb"))
    assert found.place == "skin 'body' (#0)"
    assert found.pointer == "/skins/0/joints/2"
    assert found.message == "lists node 'joint 1' (#1) 2 times"


def test_a_finding_in_another_layer_names_that_layer(tmp_path: Path) -> None:
    text = clean_usd().replace('"a", "a/b", "a/b/c"]', '"a", "a/b", "a/b"]', 1)
    save(tmp_path, text, "character.usda")
    head = "#usda 1.0\n(\n    subLayers = [@./character.usda@]\n)\n"
    found = [item for item in check(save(tmp_path, head, "shot.usda")) if item.severity == "error"]
    assert [(item.id, item.pointer) for item in found] == [
        ("usd.skel.joint-twice", "character.usda </Root/Skel>.joints")
    ]


def test_openusd_checks_on_request(tmp_path: Path) -> None:
    text = clean_usd().replace("def SkelRoot", "def Xform", 1)
    path = save(tmp_path, text)
    own, both = check(path), check(path, external=True)
    foreign = [item for item in both if item not in own]
    assert {item.id.partition(":")[0] for item in foreign} >= {"usdSkelValidators"}
    assert any(item.severity == "error" and "SkelRoot" in item.message for item in foreign)


def test_bare_opinions_of_ours_are_checked_over_what_they_are_for(tmp_path: Path) -> None:
    save(tmp_path, clean_usd(), "character.usda")
    text = (
        "#usda 1.0\n(\n    customLayerData = {\n        dictionary rigtri = {\n"
        '            string override = "layer"\n            asset source = @./character.usda@\n'
        "        }\n    }\n)\n"
        'over "Root"\n{\nover "Skel"\n{\nuniform token[] joints = ["a", "a", "a/b"]\n}\n}\n'
    )
    assert "usd.skel.joint-twice" in ids(check(save(tmp_path, text, "over.usda")))


def with_children(path: Path, *children: list[int]) -> Path:
    """A glTF whose nodes have these children."""
    nodes = [{"name": f"n{k}", **({"children": below} if below else {})} for k, below in enumerate(children)]
    path.write_text(json.dumps({"asset": {"version": "2.0"}, "nodes": nodes}))
    return path


def test_a_child_that_is_named_many_times_is_one_finding_with_a_count(tmp_path: Path) -> None:
    path = with_children(tmp_path / "a.gltf", [1] * 5, [], [1, 1, 1])
    found = [(item.place, item.pointer, item.message) for item in check(path) if item.pointer]
    assert found == [
        ("node 'n1' (#1)", "/nodes/0/children/1", "is 5 times among the children of node 'n0' (#0)"),
        (
            "node 'n1' (#1)",
            "/nodes/2/children/0",
            "is below two parents, node 'n0' (#0), node 'n2' (#2) (3 times)",
        ),
    ]


def test_a_second_parent_that_is_below_the_node_is_a_cycle(tmp_path: Path) -> None:
    path = with_children(tmp_path / "a.gltf", [1, 3], [2], [1, 1], [0])
    found = {(item.id, item.pointer) for item in check(path) if item.pointer}
    # 0 and 3 are below each other; 1 is below 0, and a child of 2, which is below it.
    assert found == {("gltf.node.cycle", "/nodes/0"), ("gltf.node.cycle", "/nodes/2/children/0")}


def test_findings_of_many_children_take_no_more_than_their_number(tmp_path: Path) -> None:
    """A chain each of whose nodes is a parent of the first, too, and one that names a child very often."""

    def work(count: int) -> int:
        chain = [[k + 1, 0] for k in range(count)]
        path = with_children(tmp_path / f"{count}.gltf", [1] * count, *chain[1:], [])
        return calls(lambda: check(path))

    work(1)  # what is imported once
    assert work(2000) < 4.4 * work(500)


@pytest.mark.parametrize("wrong", [1e9, "1", True, None, 1e400, [0.5]])
def test_the_bounds_of_keys_that_are_read_together_are_each_looked_at(wrong: object, tmp_path: Path) -> None:
    """Accessors of one size are read at once: one whose bounds do not fit has its finding, as alone."""
    path = tmp_path / "in.glb"
    gltf, binary = glb_parts(SAMPLES / "biped.glb")
    samplers = gltf["animations"][0]["samplers"]
    times = samplers[0]["input"]
    assert (
        sum(gltf["accessors"][s["input"]]["count"] == gltf["accessors"][times]["count"] for s in samplers) > 9
    )
    for output in [sampler["output"] for sampler in samplers[:2]]:
        accessor = gltf["accessors"][output]
        width = {"VEC3": 3, "VEC4": 4}[accessor["type"]]
        rows = np.frombuffer(
            binary,
            "<f4",
            accessor["count"] * width,
            gltf["bufferViews"][accessor["bufferView"]].get("byteOffset", 0) + accessor.get("byteOffset", 0),
        ).reshape(-1, width)
        accessor["min"], accessor["max"] = rows.min(axis=0).tolist(), rows.max(axis=0).tolist()
    gltf["accessors"][samplers[1]["output"]]["max"][0] = wrong
    path.write_bytes(glb_bytes(json.dumps(gltf).replace("Infinity", "1e400").encode(), binary))
    found = [item for item in check(path) if f"/accessors/{samplers[1]['output']}/" in item.pointer]
    assert [item.id for item in found] == ["gltf.accessor.bounds" if wrong == 1e9 else "gltf.json.value"]
    assert not [item for item in check(path) if f"/accessors/{samplers[0]['output']}/" in item.pointer]


def test_accessors_of_clips_are_read_together(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """All that samplers name are; a number that names none waits for what says so."""
    path = tmp_path / "in.glb"
    gltf, binary = glb_parts(SAMPLES / "biped.glb")
    samplers = gltf["animations"][0]["samplers"]
    named = {sampler[key] for sampler in samplers for key in ("input", "output")}
    gltf["animations"] = gltf["animations"][:1]
    samplers[0]["input"], samplers[1]["output"], samplers[2]["input"] = -1, len(gltf["accessors"]), True
    left = {sampler[key] for sampler in samplers for key in ("input", "output")} - {
        -1,
        len(gltf["accessors"]),
        True,
    }
    path.write_bytes(glb_bytes(json.dumps(gltf).encode(), binary))
    read = list[int]()
    monkeypatch.setattr(View, "read_together", lambda self, indices: read.extend(indices))
    check(path)
    assert set(read) == left < named


def test_findings_of_openusd_are_told_with_their_place(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its first site: a property, else a prim, else a layer. A text that quotes other bytes is not told."""

    def site(**of: Any) -> Any:
        def get(kind: str) -> Any:
            return lambda: of.get(kind)

        return SimpleNamespace(GetProperty=get("property"), GetPrim=get("prim"), GetLayer=get("layer"))

    def error(kind: str, message: Any, *sites: Any) -> Any:
        return SimpleNamespace(
            GetSites=lambda: list(sites),
            GetIdentifier=lambda: f"usd:{kind}",
            GetType=lambda: getattr(UsdValidation.ValidationErrorType, kind),
            GetMessage=message,
        )

    def no_text() -> str:
        return b"\xff".decode()

    at = {name: SimpleNamespace(GetPath=lambda name=name: f"/{name}") for name in ("a.b", "a", "c")}
    layer = SimpleNamespace(GetDisplayName=lambda: "a.usda")
    found = [
        error("Error", lambda: "one\n  two", site(property=at["a.b"], prim=at["a"]), site(prim=at["c"])),
        error("Warn", lambda: "three", site(prim=at["a"])),
        error("Info", no_text, site(layer=layer)),
        error("Error", lambda: "four"),
    ]
    context = SimpleNamespace(Validate=lambda stage: found)
    fake = SimpleNamespace(
        ValidationRegistry=lambda: SimpleNamespace(GetOrLoadAllValidators=list),
        ValidationContext=lambda validators: context,
    )
    monkeypatch.setattr(usd_validation, "UsdValidation", fake)
    findings = Findings({})
    usd_validation.validate(Usd.Stage.CreateInMemory(), findings, tmp_path)
    told = [(each.id, each.severity, each.pointer, each.message) for each in findings.all()]
    assert told == [
        ("usd:Error", "error", "</a.b>", "one two"),
        ("usd:Error", "error", "", "four"),
        ("usd:Warn", "warning", "</a>", "three"),
        ("usd:Info", "info", "a.usda", "its text about the file quotes bytes that are not text"),
    ]


def test_openusd_knows_the_types_of_all_prims_before_its_validators_run(
    samples: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of two validators that ask for one type at once one fails in half of all runs of OpenUSD 25.8."""
    asked = list[str]()

    def api(prim: Any) -> Any:
        return SimpleNamespace(IsContainer=lambda: asked.append(str(prim.GetPath())))

    def run(stage: Any) -> list[Any]:
        assert sorted(asked) == sorted(str(prim.GetPath()) for prim in stage.TraverseAll())
        return []

    fake = SimpleNamespace(
        ValidationRegistry=lambda: SimpleNamespace(GetOrLoadAllValidators=list),
        ValidationContext=lambda validators: SimpleNamespace(Validate=run),
    )
    monkeypatch.setattr(usd_validation, "UsdShade", SimpleNamespace(ConnectableAPI=api))
    monkeypatch.setattr(usd_validation, "UsdValidation", fake)
    stage = Usd.Stage.Open(str(samples / "arm.usda"))
    assert usd_validation.openusd_findings(stage) == []
    assert asked


def test_joints_are_looked_up_once_for_all_controls(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asset, rigged = save(tmp_path, clean_usd()), tmp_path / "rigged.usda"
    cli("add-controls", asset, "-o", rigged, "--joints", "*", code=0)
    looked: list[str] = []
    way = check_usd._joint_paths
    monkeypatch.setattr(
        check_usd, "_joint_paths", lambda path, tokens: (looked.append(path), way(path, tokens))[1]
    )
    assert not [found for found in check(rigged) if found.id.startswith("usd.note")]
    assert len(looked) == len(set(looked)) > 0


@pytest.mark.parametrize("key", ["scale", "rotation"])
def test_an_integer_that_no_float_can_hold_is_a_finding_of_a_bone_too(key: str, tmp_path: Path) -> None:
    builder = avatar_1()
    bones = builder.gltf["extensions"]["VRMC_vrm"]["humanoid"]["humanBones"]
    node = builder.gltf["nodes"][bones["hips"]["node"]]
    node[key] = [10**400, 1, 1, 1][: 3 + (key == "rotation")]
    found = check(builder.glb(tmp_path / "a.vrm"))
    assert [finding.id for finding in found if finding.pointer.endswith(key)] == ["gltf.json.value"]
