"""What rigtri has stored may be damaged, of another version, or about nodes that are gone: it is reported."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from gltf_files import character, glb_json
from places import ci, one_in, slow
from program import cli
from pxr import Gf, Sdf, Vt
from usd_files import MESH, animation, scene, skeleton

TYPES = Sdf.ValueTypeNames
# Any type that Python has no word for stands for the others.
VALUES: list[Any] = [
    (TYPES.TimeCode, Sdf.TimeCode(3)),
    slow(TYPES.Asset, Sdf.AssetPath("x.png")),
    slow(TYPES.Quatf, Gf.Quatf(1)),
    slow(TYPES.Matrix4d, Gf.Matrix4d(1)),
    ci(TYPES.Point3fArray, Vt.Vec3fArray([(1, 2, 3)])),
    slow(TYPES.Int, 2),
    slow(TYPES.Int64, 2**40),
    (TYPES.Double, float("nan")),
    slow(TYPES.String, "\u2776"),
]
READING = ("inspect", "check", "strip", "mirror", "bake", "view", "export-blender")


def test_what_is_wrong_with_many_nodes_alike_is_one_warning(tmp_path: Path) -> None:
    """Before, a line for each of 61 nodes."""
    builder = character()
    for node in builder.gltf["nodes"]:
        node["extras"] = {"rigtri": {"v": 9, "type": "control"}}
    builder.glb(path := tmp_path / "in.glb")
    (line,) = cli("inspect", path).stderr.splitlines()
    more = len(builder.gltf["nodes"]) - 4
    assert f"on node 0, node 1, node 2, node 3 and {more} more stays as it is: its version is 9" in line


@pytest.fixture
def rigged(tmp_path: Path) -> Path:
    (path := tmp_path / "scene.usda").write_text(scene(skeleton(), animation(), MESH), "utf-8")
    out = tmp_path / "rigged.usda"
    assert cli("add-controls", path, "-o", out, "--ik", "a", "b", "c").exit_code == 0
    limb = ["--joint", "a", "--to", "b"]
    assert cli("add-twist", out, "-o", out, "--overwrite", *limb).exit_code == 0
    return out


def use(path: Path, *commands: str) -> None:
    """Run commands, all that read metadata unless named: each ends with an exit code of its own."""
    for command in commands or READING:
        suffix = {"view": ".html", "export-blender": ".py", "convert": ".glb"}.get(command, path.suffix)
        target = ["-o", path.with_name(f"{command}{suffix}"), "--overwrite"]
        done = cli(command, path, *([] if command in ("inspect", "check") else target))
        assert done.exit_code in (0, 1, 3, 4, 5, 6), (command, done.stderr)


@pytest.mark.parametrize(("kind", "value"), VALUES, ids=lambda value: str(value)[:20])
def test_metadata_of_types_that_rigtri_does_not_write_are_reported(
    kind: Any, value: Any, rigged: Path
) -> None:
    layer = Sdf.Layer.FindOrOpen(str(rigged))
    changed = _replace(
        layer, lambda name: name in ("rigtri:joint", "rigtri:chain", "rigtri:size"), kind, value
    )
    assert changed
    layer.Export(str(broken := rigged.with_name("broken.usda")))
    assert "is damaged and is not used: its " in cli("inspect", broken).stderr
    use(broken)


@pytest.mark.ci
@pytest.mark.parametrize(
    "text", ["[" * 3000, slow("1" * 4400), slow("{"), slow("[]"), '{"v": 1, "type": "twist"}']
)
def test_notes_of_joints_that_are_no_records_are_passed_over(text: str, rigged: Path) -> None:
    layer = Sdf.Layer.FindOrOpen(str(rigged))
    spec = layer.GetAttributeAtPath("/Root/Skel.rigtri:jointNotes")
    spec.default = Vt.StringArray([text] * len(spec.default))
    layer.Export(str(broken := rigged.with_name("broken.usda")))
    use(broken)


@pytest.mark.parametrize("kind", [TYPES.Int, slow(TYPES.String), slow(TYPES.DoubleArray)], ids=str)
def test_notes_of_joints_may_be_of_another_type(kind: Any, rigged: Path) -> None:
    layer = Sdf.Layer.FindOrOpen(str(rigged))
    assert _replace(
        layer, lambda name: name in ("rigtri:joints", "rigtri:jointNotes"), kind, kind.defaultValue
    )
    layer.Export(str(broken := rigged.with_name("broken.usda")))
    use(broken)


@pytest.mark.parametrize(
    ("name", "kind", "value", "command"),
    [
        ("faceVertexCounts", TYPES.String, "x", "strip"),
        ci("faceVertexIndices", TYPES.StringArray, Vt.StringArray(["a"]), "strip"),
        ci("points", TYPES.Double, 3.5, "check"),
        ci("points", TYPES.Double, 3.5, "view"),
        ci("primvars:skel:jointIndices", TYPES.Double, 3.5, "view"),
        ci("curveVertexCounts", TYPES.Int, 3, "view"),
        ci("primvars:displayColor", TYPES.StringArray, Vt.StringArray(["red"]), "view"),
        ci("primvars:displayOpacity", TYPES.Double, 0.5, "convert"),
    ],
)
def test_attributes_of_another_type_are_passed_over(
    name: str, kind: Any, value: Any, command: str, rigged: Path
) -> None:
    layer = Sdf.Layer.FindOrOpen(str(rigged))
    if not _replace(layer, lambda found: found == name, kind, value):
        Sdf.AttributeSpec(layer.GetPrimAtPath("/Root/Skin"), name, kind).default = value
    layer.Export(str(broken := rigged.with_name("broken.usda")))
    use(broken, command)


def test_indices_of_another_type_say_nothing(rigged: Path) -> None:
    """Before, a traceback: 'bool' object is not iterable."""
    layer = Sdf.Layer.FindOrOpen(str(rigged))
    (prim,) = (layer.GetPrimAtPath(f"/Root/rigtri/{name}") for name in ["a_ctl_offset"])
    relation = next(name for one in prim.properties if (name := one.name).endswith(":target"))
    Sdf.AttributeSpec(prim, relation.replace(":target", ":indices"), TYPES.Bool).default = True
    layer.Export(str(broken := rigged.with_name("broken.usda")))
    use(broken, "inspect")


def test_keys_for_a_rivet_that_is_no_xform_are_refused_by_name(tmp_path: Path) -> None:
    """Before, they were written where OpenUSD reads none, and the result was refused as another."""
    (path := tmp_path / "scene.usda").write_text(scene(skeleton(), animation(), MESH), "utf-8")
    out = tmp_path / "rigged.usda"
    named = ["--mesh", "Skin", "--vertex", "0", "--name", "button"]
    assert cli("add-rivet", path, "-o", out, *named).exit_code == 0
    text = out.read_text("utf-8").replace('def Xform "button"', 'def Scope "button"')
    out.write_text(text, "utf-8")
    done = cli("bake", out, "--to", "joints", "-o", tmp_path / "baked.usda")
    assert (done.exit_code, "button> is a Scope, which USD gives no transform" in done.stderr) == (3, True)


def test_an_op_of_a_shape_that_is_not_there_is_not_printed_by_openusd(
    rigged: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    text = rigged.read_text("utf-8").replace(
        'uniform token type = "linear"',
        'uniform token type = "linear"\n uniform token[] xformOpOrder = ["xformOp:scale"]',
    )
    rigged.write_text(text, "utf-8")
    assert cli("view", rigged, "-o", rigged.with_suffix(".html")).exit_code == 0
    assert "xformable.cpp" not in "".join(capfd.readouterr())


def _replace(layer: Any, named: Any, kind: Any, value: Any) -> int:
    """Give attributes by their names another type and value; how many there were."""
    found: list[Any] = []

    def visit(path: Any) -> None:
        if path.IsPropertyPath() and named(path.name):
            found.append(layer.GetAttributeAtPath(path))

    layer.Traverse(Sdf.Path.absoluteRootPath, visit)
    for spec in found:
        owner, name = spec.owner, spec.name
        owner.RemoveProperty(spec)
        Sdf.AttributeSpec(owner, name, kind).default = value
    return len(found)


RECORD = {"v": 1, "type": "poseReader", "name": "r", "driver": "leg", "frame": "hips", "axis": [1, 0, 0]}
READER = RECORD | {"reader": "dot", "targets": [], "outputs": [], "within": 0.1}
BEFORE = {"clip": "walk", "mesh": "body", "morphs": [0], "interpolation": "LINEAR", "times": [0.0, 1.0]}


@pytest.mark.parametrize(
    "stored",
    one_in(
        4,
        [
            RECORD,
            READER | {"before": [{}]},
            READER | {"before": [{"clip": "walk", "mesh": "body"}]},
            READER | {"before": [BEFORE]},
            READER | {"before": [BEFORE | {"values": [[1.0]]}]},
            READER | {"before": [BEFORE | {"values": [[1.0], []]}]},
            READER | {"before": [BEFORE | {"values": [[1.0], [2.0]], "morphs": [99]}]},
            READER | {"before": [BEFORE | {"values": [[1.0], [2.0]], "times": [1.0, 1.0]}]},
            {"v": 1, "type": "rivet", "name": "x"},
            {"v": 1, "type": "control"},
            {"v": 1, "type": "twist", "joint": "leg", "to": "foot"},
            {"v": 1, "type": "limb", "limb": "l"},
            {"v": 1, "type": "constraint", "kind": "aim", "child": "prop", "drivers": ["hand"]},
            {"v": 1, "type": "poleVector"},
            {"v": 1, "type": "offset"},
            {"v": 1, "type": "offset", "kind": "fk", "joint": "leg", "aim": "x", "upFrom": "plane"},
            {"v": 1, "type": "control", "kind": ["fk"], "joint": "leg", "color": 3},
            {"v": 1, "type": "frame", "joint": "nobody"},
            {"v": 1, "type": "control", "kind": "fk", "joint": "nobody", "chain": ["nobody"]},
            {
                "v": 1,
                "type": "twist",
                "joint": "gone",
                "to": "gone",
                "driver": "gone",
                "number": 1,
                "count": 1,
            }
            | {"at": 0.5, "weight": 1.0},
            {"v": 0, "type": "control", "kind": "fk", "joint": "leg"},
            {"v": 2, "type": "control", "kind": "fk", "joint": "leg"},
            {"v": "1", "type": "control", "kind": "fk", "joint": "leg"},
            {"v": True, "type": "control", "kind": "fk", "joint": "leg"},
            {"type": "control", "kind": "fk", "joint": "leg"},
            {"v": 1, "type": "unheardOf"},
            {"v": 1, "type": ["control"]},
            {"v": 1},
            {},
        ],
    ),
    ids=lambda stored: str(stored)[:60],
)
def test_any_record_in_gltf_is_used_or_reported(stored: dict[str, Any], tmp_path: Path) -> None:
    builder = character()
    node = next(n for n in builder.gltf["nodes"] if n.get("name") == "prop")
    node["extras"] = {"rigtri": stored}
    builder.glb(path := tmp_path / "in.glb")
    use(path)
    version = stored.get("v")
    known = version == 1 and version is not True
    newer = not known or not isinstance(stored.get("type"), str) or stored["type"] == "unheardOf"
    if newer:
        assert "What rigtri stored on node 9 stays as it is: " in cli("inspect", path).stderr
        out = tmp_path / "out.glb"
        assert cli("orient-joints", path, "-o", out).exit_code == 0
        kept = next(n for n in glb_json(out)["nodes"] if n.get("name") == "prop")
        assert kept["extras"]["rigtri"] == stored
