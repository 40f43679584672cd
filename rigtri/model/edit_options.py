"""Options that all edits have, whatever they do: how files are read and written, and what a result must be.

Commands (`cli/shared_options.py`), keywords (`rigtri.ReadOptions`, `rigtri.pipeline.edit.EditRequest`) and
heads of rig specs (`rigtri.pipeline.rigspec.models.spec`) are derived from them.
"""

from __future__ import annotations

from typing import Annotated, Literal

from rigtri.limits import TOLERANCE
from rigtri.model.dataclass import dataclass
from rigtri.model.options import Kind, option

Resources = Literal["copy", "relink"]
UnknownExtension = Literal["freeze", "ignore", "error"]
Root = Annotated[str, Kind("name", "NODE", help="Use this node and all below it as the rig.", group="joints")]
Tolerance = Annotated[
    float,
    Kind("tolerance", low=0, help="Movement of a vertex, as a share of the size, that counts as none."),
]


@dataclass(frozen=True, kw_only=True)
class FileOptions:
    """How files are read and written. Help names the format that an option is for; the other ignores it."""

    root: Root | None = option(
        None,
        help="Use this node and all below it as the rig, in a file without a skeleton.",
        group="joints",
        rare=True,
    )
    lenient: bool = option(
        False,
        help="Read nodes that glTF forbids where the meaning is clear (matrix together with TRS).",
        group="safety",
        rare=True,
    )
    allow_external_paths: bool = option(
        False,
        help="Read buffers and USD layers outside the folder of the file. Nothing is ever fetched.",
        group="safety",
        rare=True,
    )
    allow_missing: bool = option(
        False,
        help="USD: leave out damaged layers, as missing ones always are, with a warning, and convert a file "
        "of which nothing is left.",
        group="safety",
        rare=True,
    )
    unknown_node_ext: UnknownExtension = option(
        "freeze",
        help="What to do with a glTF node that has an unknown extension, which may hold directions in its "
        "axes.",
        values={"freeze": "it stays as it is", "ignore": "it is re-oriented", "error": "nothing is written"},
        rare=True,
    )
    bake_xform: bool = option(
        False,
        help="USD without a skeleton: write each transform as translate, orient and scale instead of "
        "adding two ops.",
        group="output",
        rare=True,
    )
    allow_rename: bool = option(
        False,
        help="USD: let orient-joints --on-nonuniform-scale split rename joints, because their names are "
        "paths.",
        group="safety",
        rare=True,
    )
    edit_target: str = option(
        "root",
        metavar="root|new|bare|LAYER",
        help="USD: the layer that gets the opinions and becomes the output.",
        values={
            "root": "the root layer",
            "new": "a new layer, with IN as its sublayer",
            "bare": "the opinions alone, for any layer stack",
            "LAYER": "a sublayer, by its file name",
        },
        group="output",
        rare=True,
    )
    resources: Resources = option(
        "copy",
        help="Copy the files of a .gltf to its new folder, or link to them where they are. Links out of "
        "the folder are read only with --allow-external-paths.",
        group="output",
        rare=True,
    )


@dataclass(frozen=True, kw_only=True)
class RunOptions:
    """What must hold for a result, and whether it is written."""

    tolerance: Tolerance = option(
        TOLERANCE,
        help="Refuse a result that differs by more than this share of the bounding-box diagonal.",
        group="safety",
        rare=True,
    )
    verify: bool = option(
        True,
        help="Compare source and result in every pose before the output is written.",
        group="safety",
        rare=True,
    )
    strict: bool = option(False, help="Make any warning an error (exit code 5).", group="safety")
    dry_run: bool = option(False, help="Do everything except write the output.", group="safety")
    overwrite: bool = option(False, help="Replace the output if it exists.", group="safety")


@dataclass(frozen=True, kw_only=True)
class EditOptions(RunOptions, FileOptions):
    """All of them."""

    sidecar: bool = option(
        False,
        help="Also write rigtri's metadata to NAME.rig.json beside the output, for engines and exporters "
        "that drop extras.",
        group="output",
        rare=True,
    )


# Whether anything is written is for who builds a rig spec, not for the spec.
OF_BUILDS = ("verify", "dry_run", "overwrite")
