"""An edited text layer keeps every byte that the edit does not name.

The judge is the text itself: lines, comments, spelling and line ends; and USD, which reads it.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import usd_files
from pxr import Gf, Sdf, Vt
from usd_of_everything import EDITS, HEAD, MAY_CHANGE, PRIMS, SUB, packed

from rigtri import add_twist
from rigtri.formats import ReadOptions
from rigtri.formats.usd.text import splice
from rigtri.formats.usd.text import statements as text
from rigtri.formats.usd.text.statements import UnknownTextError
from rigtri.operations.orient_joints.orient import orient_joints
from rigtri.pipeline.edit import edit

# Properties out of order, comments wherever USD allows them, spellings that USD does not use.
ODD = """#usda 1.0
(
    "a layer" # with a remark
    upAxis = 'Y'; metersPerUnit = 0.0100
)

# before { the prim
def Xform "B" ( /* in "between */
    kind = "component" // the kind
)
{
    double3 z = (1.0, 2.50, 0x) # last first
    custom string s = \"\"\"two } lines
# not a comment " \\\"\"\" of it\"\"\"
    float[] a = [
        1.0, 2e0, # two
        3,
    ]
    asset file = @./a#{b.png@
    rel there = </B/Inner> ; int tail = 7 // and more
    float t.timeSamples = { 1.0: 1.50,
        2: 2.5 /* here */ }
    def "Inner" {}
}
over "A" { int one = 1; }
""".replace("0x", "0")


def changed(content: str | bytes, change: Callable[[Any], None]) -> bytes:
    """A text with a change to the layer that it says."""
    raw = content.encode() if isinstance(content, str) else content
    before, wanted = (Sdf.Layer.CreateAnonymous(".usda") for _ in range(2))
    for layer in (before, wanted):
        assert layer.ImportFromString(raw.decode())
    change(wanted)
    return splice.spliced(raw, before, wanted)


def put(path: str, value: Any) -> Callable[[Any], None]:
    def change(layer: Any) -> None:
        layer.GetAttributeAtPath(path).default = value

    return change


def test_a_layer_that_did_not_change_keeps_its_bytes() -> None:
    assert changed(ODD, lambda _: None) == ODD.encode()


def test_a_number_is_changed_where_it_stands() -> None:
    assert changed(ODD, put("/B.z", Gf.Vec3d(1, 2.5, 3))) == ODD.replace("2.50, 0)", "2.50, 3)").encode()
    value = Vt.FloatArray([1, 0.1, 3])
    assert changed(ODD, put("/B.a", value)) == ODD.replace("2e0, # two", "0.1, # two").encode()
    assert changed(ODD, put("/A.one", 2)) == ODD.replace("one = 1", "one = 2").encode()
    assert changed(ODD, put("/B.tail", 8)) == ODD.replace("tail = 7", "tail = 8").encode()


def test_a_sample_is_changed_and_its_neighbour_is_not() -> None:
    def change(layer: Any) -> None:
        layer.SetTimeSample("/B.t", 2, 3.25)

    assert changed(ODD, change) == ODD.replace("2: 2.5 ", "2: 3.25 ").encode()


def test_a_new_sample_replaces_the_block_of_samples_alone() -> None:
    def change(layer: Any) -> None:
        layer.SetTimeSample("/B.t", 3, 4)

    lines = changed(ODD, change).decode()
    start = ODD.index("{ 1.0: 1.50")
    assert lines.startswith(ODD[:start])
    assert lines.endswith(ODD[ODD.index(' }\n    def "Inner"') + 2 :])


def test_new_statements_get_the_indentation_and_line_ends_of_the_file() -> None:
    def change(layer: Any) -> None:
        spec = layer.GetPrimAtPath("/B")
        Sdf.AttributeSpec(spec, "new", Sdf.ValueTypeNames.Int).default = 5
        inner = layer.GetPrimAtPath("/B/Inner")
        Sdf.AttributeSpec(inner, "deep", Sdf.ValueTypeNames.Int).default = 6
        inner.SetInfo("apiSchemas", Sdf.TokenListOp.CreateExplicit(["SomeAPI"]))
        Sdf.CreatePrimInLayer(layer, "/B/More/Last").specifier = Sdf.SpecifierDef

    text = ODD.replace("    ", "\t").replace("\n", "\r\n")
    want = text.replace("2.5 /* here */ }", "2.5 /* here */ }\r\n\tint new = 5").replace(
        'def "Inner" {}',
        'def "Inner" (\r\n\t\tapiSchemas = ["SomeAPI"]\r\n\t) {\r\n\t\tint deep = 6\r\n\t}\r\n'
        '\r\n\tover "More"\r\n\t{\r\n\t\tdef "Last"\r\n\t\t{\r\n\t\t}\r\n\t}',
    )
    assert changed(text, change).decode() == want


def test_a_new_property_opens_a_prim_that_stood_on_one_line() -> None:
    def change(layer: Any) -> None:
        spec = Sdf.AttributeSpec(layer.GetPrimAtPath("/A"), "two", Sdf.ValueTypeNames.Int)
        spec.default = 2

    want = ODD.replace("{ int one = 1; }", "{ int one = 1;\n    int two = 2\n }")
    assert changed(ODD, change) == want.encode()


def test_what_is_removed_takes_its_line_and_nothing_else() -> None:
    def remove(layer: Any) -> None:
        spec = layer.GetPrimAtPath("/B")
        for name in ("file", "tail"):
            del spec.properties[name]

    want = ODD.replace("    asset file = @./a#{b.png@\n", "").replace("; int tail = 7 //", ";  //")
    assert changed(ODD, remove) == want.encode()


def test_an_empty_prim_that_was_filled_and_emptied_is_what_it_was() -> None:
    def fill(layer: Any) -> None:
        Sdf.CreatePrimInLayer(layer, "/B/Inner/deep").specifier = Sdf.SpecifierDef

    def empty(layer: Any) -> None:
        del layer.GetPrimAtPath("/B/Inner").nameChildren["deep"]

    assert changed(changed(ODD, fill), empty) == ODD.encode()


def test_a_renamed_asset_is_changed_alone() -> None:
    def rename(layer: Any) -> None:
        layer.GetAttributeAtPath("/B.file").default = Sdf.AssetPath("../a#{b.png")

    assert changed(ODD, rename) == ODD.replace("@./a#", "@../a#").encode()


def test_a_text_that_differs_from_its_layer_is_not_spliced() -> None:
    """What USD reads from the outcome decides, not the scanner."""
    layers = [Sdf.Layer.CreateAnonymous(".usda") for _ in range(2)]
    for layer in layers:
        layer.ImportFromString(ODD)
    put("/A.one", 2)(layers[1])
    for old, new, why in (
        ("tail = 7", "tail = 9", "something else"),
        ("one = 1", "won = 1", "no statement 'one' in line 25"),
        ("    def", "    {def", "a brace that nothing closes in line 11"),
        ("@./a#{b.png@", "@./a#{b.png", "does not end in line 19"),
        ('def "Inner"', "def Inner", "USD does not read"),
    ):
        with pytest.raises(UnknownTextError, match=why):
            splice.spliced(ODD.replace(old, new).encode(), *layers)


def rich(folder: Path) -> Path:
    """A rig beside one of everything, with comments, tabs and carriage returns."""
    text = usd_files.scene(usd_files.MESH, usd_files.skeleton(), usd_files.animation(), PRIMS, head=HEAD)
    lines = text.replace("    ", "\t").replace("(0, 2, 0)", "(0.0, 2.00, 0)").split("\n")
    # Behind a line a comment may stand anywhere but in a string, of which none here is longer.
    commented = [lines[0], *(f"{line} # remark {k}" for k, line in enumerate(lines[1:]))]
    usd_files.save(folder, SUB, "sub.usda")
    (folder / "tex.png").write_bytes(b"no picture")
    path = folder / "in.usda"
    path.write_bytes("\r\n".join(commented).encode())
    return path


def kept_lines(before: bytes, after: bytes) -> tuple[list[bytes], list[bytes]]:
    """The lines of a text but those with values that an edit may change; and which are not in another."""
    names = [name.encode() for name in MAY_CHANGE]
    lines = [
        line
        for line in before.splitlines(keepends=True)
        if not any(name in line for name in names) and not line.startswith((b"1: [(1, 0,", b"5: [(0.8,"))
    ]
    rest = iter(after.splitlines(keepends=True))
    return lines, [line for line in lines if line not in rest]


@pytest.mark.parametrize("action", EDITS)
def test_every_line_without_an_edited_value_stays_in_its_order(action: str, tmp_path: Path) -> None:
    path = rich(tmp_path)
    out = path.with_stem("out")
    result = edit(path, out, EDITS[action])
    before, after = path.read_bytes(), out.read_bytes()
    lines, lost = kept_lines(before, after)
    assert before != after
    assert len(lines) > 100
    assert lost == []
    assert after.count(b"\n") == after.count(b"\r\n")
    assert "text-respelled" not in [notice.code for notice in result.report.warnings]
    edit(out, path.with_stem("again"), EDITS[action])
    assert path.with_stem("again").read_bytes() == after


def test_a_block_of_too_many_statements_is_left_to_usd(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(text, "MOST", 6)
    with pytest.raises(UnknownTextError, match="more than 6 statements in one block in line 21"):
        changed(ODD, put("/B.tail", 8))


@pytest.mark.ci
def test_an_override_that_somebody_wrote_into_keeps_what_they_wrote(tmp_path: Path) -> None:
    path, over = rich(tmp_path), tmp_path / "over.usda"
    edit(path, over, EDITS["orient-joints"], options=ReadOptions(edit_target="bare"))
    mine = over.read_bytes() + b"# a note of mine\n"
    over.write_bytes(mine)
    edit(over, tmp_path / "out.usda", EDITS["add-polevector"])
    after = (tmp_path / "out.usda").read_bytes()
    assert b"PoleVectorAPI" in after
    assert after.endswith(b"# a note of mine\n")
    lines, lost = kept_lines(mine, after)
    assert lines
    assert lost == []


@pytest.mark.ci
def test_the_text_in_a_package_keeps_its_bytes(tmp_path: Path) -> None:
    path = rich(tmp_path)
    package = packed(path)
    edit(package, package.with_stem("out"), EDITS["orient-joints"])
    edit(path, path.with_stem("out"), EDITS["orient-joints"])
    assert path.with_stem("out").read_bytes() in package.with_stem("out").read_bytes()


def test_a_text_that_cannot_be_spliced_is_written_by_usd_with_a_notice(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = rich(tmp_path)

    def refuse(*_: Any) -> bytes:
        raise UnknownTextError("a thing in line 3")

    monkeypatch.setattr(splice, "spliced", refuse)
    result = edit(path, path.with_stem("out"), lambda rig, report: orient_joints(rig, report=report))
    (notice,) = [notice for notice in result.report.warnings if notice.code == "text-respelled"]
    assert "a thing in line 3" in notice.text
    assert b"# remark" not in path.with_stem("out").read_bytes()


def test_comments_in_an_array_that_got_another_size_are_lost_with_a_notice(tmp_path: Path) -> None:
    text = '#usda 1.0\ndef "A"\n{\n    int[] a = [1, # one "x"\n 2]\n    string[] b = ["#", "//"]\n}\n'

    def respelled(wanted: str) -> tuple[bytes, list[str]]:
        lost: list[str] = []
        sides = [Sdf.Layer.CreateAnonymous(".usda") for _ in range(2)]
        for side, said in zip(sides, (text, wanted), strict=True):
            assert side.ImportFromString(said)
        return splice.spliced(text.encode(), sides[0], sides[1], lost), lost

    told, lost = respelled(text.replace("2]", "2, 3]").replace('"//"]', '"//", "/*"]'))
    assert lost == ["a"]
    assert b"# one" not in told
    # Where the size stays, the comment does.
    told, lost = respelled(text.replace("2]", "3]"))
    assert b'# one "x"' in told
    assert not lost


def test_an_edit_names_the_values_that_lose_comments(tmp_path: Path) -> None:
    joints = 'uniform token[] joints = ["a", # the root\n "a/b", "a/b/c"]'
    text = usd_files.scene(usd_files.skeleton(joints=joints), usd_files.animation(), usd_files.MESH)
    document = usd_files.read(usd_files.save(tmp_path, text))
    usd_files.write(document, add_twist(document.rig, joint="a", to="a/b"), tmp_path / "out.usda")
    assert [notice.text for notice in document.warnings if notice.code == "comments-dropped"] == [
        "comments inside these values went, for the values got another size: joints"
    ]


STATED = """#usda 1.0
def Xform "B"
{
    float a = 1.50 (
        doc = "one" # kept
        hidden = 1
    )
    float b = 2.50 # plain
    float c (
        doc = 'alone'
    )
}
"""


@pytest.mark.parametrize(
    ("path", "key", "value", "gone", "new"),
    [
        ("/B.a", "documentation", "two", 'doc = "one"', 'doc = "two"'),
        ("/B.a", "hidden", False, "hidden = 1", "hidden = false"),
        ("/B.b", "hidden", True, "float b = 2.50 # plain", "hidden = true"),
        ("/B.c", "documentation", "else", "doc = 'alone'", 'doc = "else"'),
    ],
)
def test_metadata_of_a_property_is_changed_where_it_stands(
    path: str, key: str, value: Any, gone: str, new: str
) -> None:
    out = changed(STATED, lambda layer: layer.GetAttributeAtPath(path).SetInfo(key, value)).decode()
    layer = Sdf.Layer.CreateAnonymous(".usda")
    assert layer.ImportFromString(out)
    assert layer.GetAttributeAtPath(path).GetInfo(key) == value
    kept = [line for line in STATED.splitlines() if gone not in line]
    assert [line for line in out.splitlines() if line in kept] == kept
    assert new in out
    assert gone not in out
    assert all(word in out for word in ("2.50", "# plain", "# kept"))


@pytest.mark.parametrize("path", ["/B.a", "/B.c"])
def test_metadata_that_goes_takes_its_brackets_along(path: str) -> None:
    def change(layer: Any) -> None:
        for key in ("documentation", "hidden"):
            layer.GetAttributeAtPath(path).ClearInfo(key)

    out = changed(STATED, change).decode()
    layer = Sdf.Layer.CreateAnonymous(".usda")
    assert layer.ImportFromString(out)
    assert not layer.GetAttributeAtPath(path).HasInfo("documentation")
    assert out.count("(") == 1
    assert "float a = 1.50" in out
    assert "float b = 2.50 # plain" in out


@pytest.mark.parametrize(
    ("old", "new", "change"),
    [
        ("int x  (hidden = 1) # r", "int x = 5  (hidden = 1) # r", put("/P.x", 5)),
        ("int x = 5 # r", "int x # r", lambda layer: layer.GetAttributeAtPath("/P.x").ClearDefaultValue()),
        (
            'int x = 5 (doc = "d") # r',
            "int x = 5 # r",
            lambda layer: layer.GetAttributeAtPath("/P.x").ClearInfo("documentation"),
        ),
    ],
)
def test_a_value_or_metadata_comes_and_goes_alone(old: str, new: str, change: Callable[[Any], None]) -> None:
    around = '#usda 1.0\ndef "P"\n{{\n    int w = 1\n    {}\n    int y = 2\n}}\n'
    assert changed(around.format(old), change).decode() == around.format(new)
