"""What reaches a limit is taken, and what is one beyond it is refused, with the limit in the message.

Real files are far from most limits, so each is set to what a small file has.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import pytest
from gltf_files import character
from places import SAMPLES

import rigtri
from rigtri.errors import RigtriError
from rigtri.export.viewer import view as viewer
from rigtri.formats.gltf import accessors
from rigtri.formats.usd.composition import composition_limits
from rigtri.pipeline.rigspec import expand, parse, positions, spec_init
from rigtri.pipeline.rigspec.load import load
from rigtri.report import Report

STEP = "steps:\n- {do: orient-joints, joints: "


def _spec(text: str) -> Callable[[Path], str]:
    def run(folder: Path) -> str:
        path = folder / "a.yaml"
        path.write_text(text, "utf-8")
        load(path)
        return ""

    return run


def _extended(folder: Path) -> str:
    """Five specs, each of which extends the next."""
    for number in range(5):
        more = "steps: [{do: strip}]" if number == 4 else f"extends: {number + 1}.yaml"
        (folder / f"{number}.yaml").write_text(f"{more}\n", "utf-8")
    load(folder / "0.yaml")
    return ""


def _without_bytes(folder: Path) -> str:
    """Five skins' worth of inverse bind matrices that no bytes are there for."""
    builder = character()
    skin = builder.gltf["skins"][0]
    builder.gltf["accessors"].append({"count": 5, "componentType": 5126, "type": "MAT4"})
    skin["inverseBindMatrices"] = len(builder.gltf["accessors"]) - 1
    skin["joints"] = skin["joints"][:5]
    rig = rigtri.read(builder.glb(folder / "in.glb"))
    return str(rig.skins[0].inverse_bind.sum())


def _usd(folder: Path) -> str:
    rigtri.read(SAMPLES / "biped.usda")
    return ""


def _arcs(folder: Path) -> str:
    """A prim that six others make."""
    own = "".join(f'class "c{k}" {{ }}\n' for k in range(5))
    names = ", ".join(f"</c{k}>" for k in range(5))
    text = SAMPLES.joinpath("biped.usda").read_text("utf-8")
    path = folder / "in.usda"
    path.write_text(f'{text}\n{own}def "Made" (inherits = [{names}]) {{ }}\n', "utf-8")
    rigtri.read(path)
    return ""


def _shown(folder: Path) -> str:
    return spec_init.spec_init(SAMPLES / "tail.glb")


def _page(folder: Path) -> str:
    report = Report()
    viewer.view(SAMPLES / "tail.glb", report=report)
    return "\n".join(notice.text for notice in report.warnings)


@pytest.mark.parametrize(
    ("module", "name", "most", "run", "told"),
    [
        (parse, "MOST_BYTES", 24, _spec("steps: [{do: strip}]\n#\n#"), "has more than {} bytes"),
        (
            positions,
            "MOST_DEEP",
            5,
            _spec("variables: {a: [[[1]]]}"),
            "or deeper, than a spec can",
        ),
        (
            positions,
            "MOST_DIGITS",
            9,
            _spec(STEP + "[a], tolerance: 0.0000001}"),
            "a spec has none of more than {}",
        ),
        (expand, "MOST_WORDS", 5, _spec(STEP + '"{a,b,c,d,e}"}'), "braces have at most {} words"),
        (
            expand,
            "MOST_STEPS",
            3,
            _spec("steps: [{do: strip}, {do: strip}, {do: strip}]"),
            "at most {} steps",
        ),
        (
            expand,
            "MOST_TEXT",
            9,
            _spec("variables: {a: bcd}\n" + STEP + '"${a}_${a}12"}'),
            "at most {} letters",
        ),
        (expand, "MOST_EXTENDED", 5, _extended, "more than {} specs extend each other"),
        (accessors, "MOST_ZEROS", 80, _without_bytes, "claims 5 elements without bytes for them"),
        (composition_limits, "MOST_OPINIONS", 7, _usd, "make more than {} opinions on prims"),
        (composition_limits, "MOST_PLACES", 6, _arcs, "make more than {} arcs on one prim, </Made>"),
        (spec_init, "MOST_SHOWN", 9, _shown, "#   … 1 more; all with: rigtri inspect FILE"),
        (viewer, "DEEPEST", 9, _page, "nodes are one below the other"),
    ],
    ids=lambda value: value if isinstance(value, str) and value.isupper() else "",
)
def test_what_is_beyond_a_limit_is_told(
    module: ModuleType,
    name: str,
    most: int,
    run: Callable[[Path], str],
    told: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def of(limit: int) -> str:
        monkeypatch.setattr(module, name, limit)
        try:
            return run(tmp_path)
        except RigtriError as error:
            return str(error)

    assert told.format(most) not in of(most)
    assert told.format(most - 1) in of(most - 1)
