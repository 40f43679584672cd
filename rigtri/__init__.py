"""Re-orient joints and build rigs in glTF, VRM and USD files; everything else stays as it was.

The names below are the library: each operation is the twin of a command. They
are loaded when first used, so that the core needs numpy alone.

`vectors`, `matrices`, `quaternions`, `triangle` and `euler` are the mathematics, for arrays of any
shape: ``rigtri.triangle.pole_position([0, 0, 0], [3, 4, 0], [6, 0, 0])``, or
``from rigtri.maths.triangle import pole_position``.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from rigtri._version import __version__ as __version__

_WHERE = {
    "read": "rigtri.pipeline.files",
    "write": "rigtri.pipeline.files",
    "from_pygltflib": "rigtri.pipeline.pygltflib",
    "to_pygltflib": "rigtri.pipeline.pygltflib",
    "edit": "rigtri.pipeline.edit",
    "build": "rigtri.pipeline.rigspec.build",
    "auto": "rigtri.pipeline.rigspec.auto",
    "freeze": "rigtri.operations.freeze",
    "limit_weights": "rigtri.operations.limit_weights",
    "merge_joints": "rigtri.operations.merge_joints",
    "add_root": "rigtri.operations.add_root",
    "add_socket": "rigtri.operations.add_socket",
    "root_motion": "rigtri.operations.root_motion",
    "conform": "rigtri.operations.conform",
    "convert": "rigtri.pipeline.convert",
    "set_rest": "rigtri.operations.set_rest",
    "prune_joints": "rigtri.operations.prune_joints",
    "rename_joints": "rigtri.operations.rename_joints",
    "orient_joints": "rigtri.operations.orient_joints.orient",
    "add_polevector": "rigtri.operations.add_polevector",
    "make_limb": "rigtri.operations.make_limb",
    "add_twist": "rigtri.operations.add_twist.twist",
    "add_posereader": "rigtri.operations.add_posereader.posereader",
    "add_rivet": "rigtri.operations.add_rivet.rivet",
    "add_controls": "rigtri.operations.add_controls",
    "constrain": "rigtri.operations.constrain.constrain",
    "mirror": "rigtri.operations.mirror.mirror",
    "as_described": "rigtri.operations.take_clips.restore_metadata",
    "bake": "rigtri.operations.bake.bake",
    "take_clips": "rigtri.operations.take_clips.take_clips",
    "take_pose": "rigtri.operations.pose",
    "snap": "rigtri.operations.snap",
    "strip": "rigtri.operations.strip",
    "describe": "rigtri.export.text_description",
    "matrix_table": "rigtri.export.matrix_table",
    "verify": "rigtri.pipeline.files",
    "diff": "rigtri.pipeline.files",
    "check": "rigtri.verification.checks",
    "recognise": "rigtri.recognition.recognise",
    "draw": "rigtri.export.drawing.picture",
    "explain": "rigtri.export.explain.limb_points",
    "view": "rigtri.export.viewer.view",
    "export_blender": "rigtri.export.blender.script",
    "spec_init": "rigtri.pipeline.rigspec.spec_init",
    "register_usd_schemas": "rigtri.formats.usd.codeless_schemas",
    "ReadOptions": "rigtri.formats",
    "Rig": "rigtri.model.rig",
    "Report": "rigtri.report",
    "RigtriError": "rigtri.errors",
}

# The public mathematics: what is in modules of rigtri.maths.
_MODULES = ("vectors", "matrices", "quaternions", "triangle", "euler")

# Written out, as tools that do not run the package read it.
__all__ = [
    "ReadOptions",
    "Report",
    "Rig",
    "RigtriError",
    "add_controls",
    "add_polevector",
    "add_posereader",
    "add_rivet",
    "add_root",
    "add_socket",
    "add_twist",
    "as_described",
    "auto",
    "bake",
    "build",
    "check",
    "conform",
    "constrain",
    "convert",
    "describe",
    "diff",
    "draw",
    "edit",
    "euler",
    "explain",
    "export_blender",
    "freeze",
    "from_pygltflib",
    "limit_weights",
    "make_limb",
    "matrices",
    "matrix_table",
    "merge_joints",
    "mirror",
    "orient_joints",
    "prune_joints",
    "quaternions",
    "read",
    "recognise",
    "register_usd_schemas",
    "rename_joints",
    "root_motion",
    "set_rest",
    "snap",
    "spec_init",
    "strip",
    "take_clips",
    "take_pose",
    "to_pygltflib",
    "triangle",
    "vectors",
    "verify",
    "view",
    "write",
]

if TYPE_CHECKING:
    from rigtri.errors import RigtriError as RigtriError
    from rigtri.export.blender.script import export_blender as export_blender
    from rigtri.export.drawing.picture import draw as draw
    from rigtri.export.explain.limb_points import explain as explain
    from rigtri.export.matrix_table import matrix_table as matrix_table
    from rigtri.export.text_description import describe as describe
    from rigtri.export.viewer.view import view as view
    from rigtri.formats import ReadOptions as ReadOptions
    from rigtri.formats.usd.codeless_schemas import register_usd_schemas as register_usd_schemas
    from rigtri.maths import euler as euler
    from rigtri.maths import matrices as matrices
    from rigtri.maths import quaternions as quaternions
    from rigtri.maths import triangle as triangle
    from rigtri.maths import vectors as vectors
    from rigtri.model.rig import Rig as Rig
    from rigtri.operations.add_controls import add_controls as add_controls
    from rigtri.operations.add_polevector import add_polevector as add_polevector
    from rigtri.operations.add_posereader.posereader import add_posereader as add_posereader
    from rigtri.operations.add_rivet.rivet import add_rivet as add_rivet
    from rigtri.operations.add_root import add_root as add_root
    from rigtri.operations.add_socket import add_socket as add_socket
    from rigtri.operations.add_twist.twist import add_twist as add_twist
    from rigtri.operations.bake.bake import bake as bake
    from rigtri.operations.conform import conform as conform
    from rigtri.operations.constrain.constrain import constrain as constrain
    from rigtri.operations.freeze import freeze as freeze
    from rigtri.operations.limit_weights import limit_weights as limit_weights
    from rigtri.operations.make_limb import make_limb as make_limb
    from rigtri.operations.merge_joints import merge_joints as merge_joints
    from rigtri.operations.mirror.mirror import mirror as mirror
    from rigtri.operations.orient_joints.orient import orient_joints as orient_joints
    from rigtri.operations.pose import take_pose as take_pose
    from rigtri.operations.prune_joints import prune_joints as prune_joints
    from rigtri.operations.rename_joints import rename_joints as rename_joints
    from rigtri.operations.root_motion import root_motion as root_motion
    from rigtri.operations.set_rest import set_rest as set_rest
    from rigtri.operations.snap import snap as snap
    from rigtri.operations.strip import strip as strip
    from rigtri.operations.take_clips.restore_metadata import as_described as as_described
    from rigtri.operations.take_clips.take_clips import take_clips as take_clips
    from rigtri.pipeline.convert import convert as convert
    from rigtri.pipeline.edit import edit as edit
    from rigtri.pipeline.files import diff as diff
    from rigtri.pipeline.files import read as read
    from rigtri.pipeline.files import verify as verify
    from rigtri.pipeline.files import write as write
    from rigtri.pipeline.pygltflib import from_pygltflib as from_pygltflib
    from rigtri.pipeline.pygltflib import to_pygltflib as to_pygltflib
    from rigtri.pipeline.rigspec.auto import auto as auto
    from rigtri.pipeline.rigspec.build import build as build
    from rigtri.pipeline.rigspec.spec_init import spec_init as spec_init
    from rigtri.recognition.recognise import recognise as recognise
    from rigtri.report import Report as Report
    from rigtri.verification.checks import check as check


def __dir__() -> list[str]:
    """What consoles complete."""
    return [*__all__, "__version__"]


def __getattr__(name: str) -> Any:
    if name in _WHERE:
        return getattr(import_module(_WHERE[name]), name)
    if name in _MODULES:
        return import_module(f"rigtri.maths.{name}")
    raise AttributeError(f"module 'rigtri' has no attribute '{name}'")
