"""Time-scaled layers, blocked samples, value clips: every sample arrives, at its own time."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from crowds import contents
from pxr import Sdf, Usd
from usd_files import MESH, ONE, animation, deviation, read, save, scene, skeleton, skinned, turned, write

from rigtri.errors import FileError
from rigtri.formats.usd.composition import layers
from rigtri.formats.usd.composition.stage import open_stage
from rigtri.formats.usd.composition.time_samples import time_samples

QUARTER = "[(1, 0, 0, 0), (0.6, 0, 0.8, 0), (1, 0, 0, 0)]"
OTHER = "[(0.8, 0, 0.6, 0), (1, 0, 0, 0), (0.6, 0, 0.8, 0)]"
THIRD = "[(0, 1, 0, 0), (0.6, 0.8, 0, 0), (1, 0, 0, 0)]"


def rotations(**at: str) -> str:
    rows = ", ".join(f"{time.removeprefix('t')}: {value}" for time, value in at.items())
    return f"quatf[] rotations.timeSamples = {{ {rows} }}"


def far(one: Path, other: Path, times: np.ndarray) -> float:
    """How far skinned points are apart at some times, in file units."""
    stages = [Usd.Stage.Open(str(path)) for path in (one, other)]
    worst = 0.0
    for time in times.tolist():
        first, second = (skinned(stage, Usd.TimeCode(time)) for stage in stages)
        assert first
        worst = max(worst, *(float(np.abs(first[path] - second[path]).max()) for path in first))
    return worst


@pytest.mark.parametrize(
    ("head", "parts_head", "offset"),
    [
        ("timeCodesPerSecond = 48", "timeCodesPerSecond = 24", ""),
        ("framesPerSecond = 30", "timeCodesPerSecond = 24", "(offset = 0.1; scale = 0.7)"),
        ("", "", "(offset = -7.3; scale = 1.1)"),
    ],
)
@pytest.mark.parametrize("arc", ["subLayers", "references"])
@pytest.mark.parametrize("edit_target", ["root", "new"])
def test_samples_of_scaled_layers_keep_their_times_and_blocks(
    edit_target: str, arc: str, head: str, parts_head: str, offset: str, tmp_path: Path
) -> None:
    moves = "float3[] translations.timeSamples = { 1: [(0, 2, 0), (0, 0, 0), (0, 2, 1)], 2: None, "
    moves += "3: [(0, 2, 0), (0, 0.1, 0), (0, 2, 1)], 3.5: None, 4: [(0, 2, 0), (0, 0, 1), (0, 2, 1)] }"
    both = animation(translations=moves, more=f"quatf[] rotations = {QUARTER}")
    save(tmp_path, scene(skeleton(), both, MESH, head=parts_head + "\n"), "parts/hero.usda")
    if arc == "subLayers":
        text = f"#usda 1.0\n(\n{head}\nsubLayers = [@./parts/hero.usda@ {offset}]\n)\n"
    else:
        where = offset or "(offset = 3)"
        body = f'def "Root" (references = @./parts/hero.usda@</Root> {where})\n{{\n}}\n'
        text = f"#usda 1.0\n(\n{head}\n)\n{body}"
    source = save(tmp_path, text, "shot.usda")
    before = contents(tmp_path)
    document = read(source, edit_target=edit_target)
    out = write(document, turned(document.rig), tmp_path / "out.usda")
    assert {name: found for name, found in contents(tmp_path).items() if name in before} == before
    # At a sample beside a block the source itself may show the block; see below.
    assert far(source, out, np.arange(-9, 12, 0.4371)) < 1e-5
    stages = [Usd.Stage.Open(str(path)) for path in (source, out)]
    one, other = (stage.GetPrimAtPath("/Root/Anim").GetAttribute("translations") for stage in stages)
    times = one.GetTimeSamples()
    assert other.GetTimeSamples() == times
    layer = layers.fresh(out)
    blocked = [isinstance(layer.QueryTimeSample(other.GetPath(), t), Sdf.ValueBlock) for t in times]
    assert blocked == [False, True, False, True, False]


def test_a_sample_beside_a_block_is_read_from_its_layer(tmp_path: Path) -> None:
    """Asked by time, USD comes out one bit beside the sample for about a third of all offsets."""
    save(
        tmp_path,
        '#usda 1.0\ndef "P"\n{\nfloat[] v.timeSamples = {3: None, 5: [7], 6: None}\n}\n',
        "part.usda",
    )
    random, by_time = np.random.default_rng(1), 0
    for scale, offset in random.uniform(0.1, 3, size=(200, 2)).tolist():
        layer = Sdf.Layer.CreateAnonymous(".usda")
        layer.subLayerPaths = [str(tmp_path / "part.usda")]
        layer.subLayerOffsets[0] = Sdf.LayerOffset(offset, scale)
        stage = Usd.Stage.Open(layer)
        attribute = stage.GetPrimAtPath("/P").GetAttribute("v")
        found = time_samples(attribute)
        assert [time for time, _ in found] == attribute.GetTimeSamples()
        assert [value if value is None else list(value) for _, value in found] == [None, [7], None]
        by_time += attribute.Get(found[1][0]) is None
    assert by_time


def test_a_default_of_a_stronger_layer_hides_weaker_samples_in_the_output_too(tmp_path: Path) -> None:
    save(tmp_path, scene(skeleton(), animation(), MESH), "hero.usda")
    over = f'over "Root"\n{{\nover "Anim"\n{{\nquatf[] rotations = {OTHER}\n}}\n}}\n'
    text = f"#usda 1.0\n(\nsubLayers = [@./hero.usda@]\n)\n{over}"
    source = save(tmp_path, text, "shot.usda")
    document = read(source)
    out = write(document, turned(document.rig), tmp_path / "out.usda")
    stage = Usd.Stage.Open(str(out))
    assert stage.GetPrimAtPath("/Root/Anim").GetAttribute("rotations").GetTimeSamples() == []
    assert deviation(source, out) < 1e-6


def clipped(folder: Path, clips: list[str], how: str, body: str = "") -> Path:
    """A character whose rotations come from value clips."""
    for number, values in enumerate(clips, start=1):
        text = f'#usda 1.0\nover "Root"\n{{\nover "Anim"\n{{\n{values}\n}}\n}}\n'
        save(folder, text, f"clips/part.{number:03}.usda")
    save(
        folder, '#usda 1.0\nover "Root"\n{\nover "Anim"\n{\nquatf[] rotations\n}\n}\n', "clips/manifest.usda"
    )
    head = f"""clips = {{ dictionary default = {{
        {how}
        asset manifestAssetPath = @./clips/manifest.usda@
        string primPath = "/Root"
    }} }}"""
    text = scene(skeleton(), animation(rotations=body), MESH)
    return save(folder, text.replace('def SkelRoot "Root"', f'def SkelRoot "Root" ({head})'))


EXPLICIT = "asset[] assetPaths = [@./clips/part.001.usda@, @./clips/part.002.usda@]\n"
TEMPLATE = """string templateAssetPath = "./clips/part.###.usda"
double templateStartTime = 1\ndouble templateEndTime = 3\ndouble templateStride = 1\n"""
LONG = [rotations(t0=QUARTER, t4=OTHER), rotations(t0=THIRD, t2=QUARTER, t4=OTHER)]


@pytest.mark.parametrize(
    "how",
    [
        EXPLICIT + "double2[] active = [(0, 0)]",
        EXPLICIT + "double2[] active = [(0, 0), (4, 1)]\ndouble2[] times = [(0, 0), (4, 4), (4, 0), (8, 4)]",
        # The first clip runs backwards until the second starts: no sample of either says so.
        EXPLICIT + "double2[] active = [(0, 0), (5, 1)]\ndouble2[] times = [(0, 0), (4, 4), (5, 0), (9, 4)]",
        # The same clip again and again, faster each time.
        EXPLICIT
        + "double2[] active = [(0, 0)]\ndouble2[] times = [(0, 0), (4, 4), (4, 0), (6, 4), (6, 0), (7, 4)]",
        TEMPLATE,
    ],
)
@pytest.mark.parametrize("edit_target", ["root", "new"])
def test_an_animation_from_value_clips_is_reoriented_by_samples_of_a_stronger_layer(
    edit_target: str, how: str, tmp_path: Path
) -> None:
    single = [rotations(**{f"t{k}": value}) for k, value in enumerate((QUARTER, OTHER, THIRD), start=1)]
    source = clipped(tmp_path, single if "template" in how else LONG, how)
    before = contents(tmp_path)
    document = read(source, edit_target=edit_target)
    assert not document.rig.rules.fixed
    out = write(document, turned(document.rig), tmp_path / "out.usda")
    assert {name: found for name, found in contents(tmp_path).items() if name in before} == before
    assert deviation(source, out) < 2e-6
    assert far(source, out, np.arange(-1, 11, 0.1371)) < 1e-5


def test_clips_that_lie_in_a_reference_are_overridden_too(tmp_path: Path) -> None:
    clipped(tmp_path / "parts", LONG, EXPLICIT + "double2[] active = [(0, 0)]")
    source = save(tmp_path, '#usda 1.0\ndef "Root" (references = @./parts/in.usda@)\n{\n}\n', "shot.usda")
    document = read(source)
    out = write(document, turned(document.rig), tmp_path / "out.usda")
    assert deviation(source, out) < 2e-6
    assert far(source, out, np.arange(-1, 11, 0.1371)) < 1e-5


def test_a_default_beside_the_clips_hides_them_as_before(tmp_path: Path) -> None:
    how = EXPLICIT + "double2[] active = [(0, 0)]"
    source = clipped(tmp_path, LONG, how, body=f"quatf[] rotations = {THIRD}")
    document = read(source)
    out = write(document, turned(document.rig), tmp_path / "out.usda")
    assert deviation(source, out) < 2e-6
    assert far(source, out, np.arange(-1, 11, 0.371)) < 1e-5


def test_clips_that_no_samples_can_represent_are_refused_with_layer_and_path(tmp_path: Path) -> None:
    """Where a clip lacks the attribute, USD may interpolate across it, and shows no samples there."""
    three = EXPLICIT.replace("002.usda@]", "002.usda@, @./clips/part.003.usda@]")
    three += "bool interpolateMissingClipValues = true\ndouble2[] active = [(0, 0), (3, 1), (6, 2)]\n"
    three += "double2[] times = [(0, 0), (3, 3), (3, 0), (6, 3), (6, 0), (10, 4)]"
    source = clipped(tmp_path, [LONG[0], "", LONG[1]], three)
    reason = r"</Root/Anim.rotations>: the value clips \(of .*part.001.usda\) .* between 3 and 6"
    with pytest.raises(FileError, match=reason):
        read(source)


TWO = EXPLICIT + "double2[] active = [(0, 0), (4, 1)]\ndouble2[] times = [(0, 0), (4, 4), (4, 0), (8, 4)]"


@pytest.mark.parametrize("lost", ["part.001.usda", "part.002.usda"])
def test_a_missing_value_clip_is_an_error_where_the_animation_needs_it(lost: str, tmp_path: Path) -> None:
    """Before, nothing was said, and what the output holds hid the clip when it was there again."""
    source = clipped(tmp_path, LONG, TWO)
    (tmp_path / "clips" / lost).unlink()
    with pytest.raises(FileError, match=rf"{lost}: no such file, .*</Root/Anim.rotations> needs it"):
        read(source)
    (notice,) = read(source, allow_missing=True).warnings
    assert notice.code == "unresolved"
    assert notice.text == f"1 value clip that this one plays was not found: ./clips/{lost}"


def test_all_missing_value_clips_are_named_of_sets_that_begin_at_one_time(tmp_path: Path) -> None:
    source = clipped(tmp_path, LONG, EXPLICIT + "double2[] active = [(0, 0)]")
    other = "dictionary other = { asset[] assetPaths = [@./b.usda@]\ndouble2[] active = [(0, 0)] }"
    source.write_text(source.read_text("utf-8").replace("dictionary default", f"{other}\ndictionary default"))
    (tmp_path / "clips" / "part.001.usda").unlink()
    notice, *_ = read(source, allow_missing=True).warnings
    assert notice.text.startswith("2 value clips that this one plays were not found: ")


@pytest.mark.parametrize("how", ["stronger", "unplayed"])
def test_a_missing_value_clip_that_moves_nothing_is_no_error(how: str, tmp_path: Path) -> None:
    body = f"quatf[] rotations = {THIRD}" if how == "stronger" else ""
    clips = TWO if how == "stronger" else EXPLICIT + "double2[] active = [(0, 0)]"
    source = clipped(tmp_path, LONG, clips, body=body)
    (tmp_path / "clips" / "part.002.usda").unlink()
    assert [notice.code for notice in read(source).warnings] == ["unresolved"] * (how == "stronger")


def test_opinions_of_relocated_inherited_and_specialized_prims_are_overridden(tmp_path: Path) -> None:
    save(tmp_path, scene(skeleton(), animation(), MESH), "hero.usda")
    text = """#usda 1.0
(
    relocates = { </World/Moved/Anim> : </World/Moved/Walk> }
)
class "Hero" (references = @./hero.usda@</Root>)
{
}
def Xform "World"
{
    def "Moved" (references = @./hero.usda@</Root>)
    {
        over "Skel"
        {
            rel skel:animationSource = </World/Moved/Walk>
        }
    }
    def "Heir" (inherits = </Hero>)
    {
    }
    def "Special" (specializes = </Hero>)
    {
    }
}
"""
    source = save(tmp_path, text, "shot.usda")
    document = read(source)
    assert len(document.rig.skins) == 3
    assert len(document.rig.clips) == 6
    out = write(document, turned(document.rig), tmp_path / "out.usda")
    assert deviation(source, out) < 1e-6
    assert not document.warnings


def edits_of(how: str) -> str:
    return f'over "Root"\n{{\nover "Anim"\n{{\nquatf[] rotations{how}\n}}\n}}\n'


ARRAY_EDIT = "edit [ write (0, 0, 1, 0) to [1] ]"


@pytest.mark.parametrize("how", [f".timeSamples = {{ 1: {ARRAY_EDIT} }}", f" = {ARRAY_EDIT}"])
def test_array_edits_of_what_moves_are_refused_with_layer_and_path(how: str, tmp_path: Path) -> None:
    """UsdSkel plays what they make of the weaker arrays, and holds it between samples."""
    save(tmp_path, scene(skeleton(), animation(), MESH), "hero.usda")
    shot = save(tmp_path, "#usda 1.0\n(\nsubLayers = [@./hero.usda@]\n)\n" + edits_of(how), "shot.usda")
    plain, edited = (Usd.Stage.Open(str(tmp_path / name)) for name in ("hero.usda", "shot.usda"))
    apart = [skinned(stage, Usd.TimeCode(1))["/Root/Skin"] for stage in (plain, edited)]
    assert float(np.abs(apart[0] - apart[1]).max()) > 0.1
    with pytest.raises(FileError, match=r"</Root/Anim\.rotations> of .*shot\.usda edits an array"):
        read(shot)


def test_array_edits_among_whole_samples_of_one_layer_are_refused(tmp_path: Path) -> None:
    moves = rotations(t1=QUARTER, t3=ARRAY_EDIT, t5=OTHER)
    source = save(tmp_path, scene(skeleton(), animation(rotations=moves), MESH))
    with pytest.raises(FileError, match=r"</Root/Anim\.rotations> of .*in\.usda edits an array"):
        read(source)


def test_array_edits_of_a_rest_pose_are_composed_and_reoriented(tmp_path: Path) -> None:
    save(tmp_path, scene(skeleton(), animation(), MESH), "hero.usda")
    edit = f"uniform matrix4d[] restTransforms = edit [ write {ONE} to [0] ]"
    text = f'#usda 1.0\n(\nsubLayers = [@./hero.usda@]\n)\nover "Root"\n{{\nover "Skel"\n{{\n{edit}\n}}\n}}\n'
    source = save(tmp_path, text, "shot.usda")
    document = read(source)
    assert deviation(source, write(document, turned(document.rig), tmp_path / "out.usda")) < 1e-5


def test_a_layer_is_parsed_once_where_it_is_opened(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = save(tmp_path, scene(skeleton(), animation(), MESH))
    again: list[str] = []
    monkeypatch.setattr(Sdf.Layer, "Reload", lambda layer, force=False: again.append(layer.identifier))
    stage, _ = open_stage(path, allow_external=False)
    assert stage.GetPrimAtPath("/Root/Skel")
    assert not again
