"""Re-orient joints and build rigs in glTF, VRM and USD files; everything else stays as it was.

The names below are the library: each operation is the twin of a command. They
are loaded when first used, so that the core needs numpy alone.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

_WHERE = {
    "read": "rigtri.on_disk",
    "write": "rigtri.on_disk",
    "from_pygltflib": "rigtri.in_memory",
    "to_pygltflib": "rigtri.in_memory",
    "edit": "rigtri.pipeline",
    "build": "rigtri.spec.building",
    "auto": "rigtri.spec.automatic",
    "orient_joints": "rigtri.ops.orient",
    "add_polevector": "rigtri.ops.polevector",
    "make_limb": "rigtri.ops.limb",
    "add_twist": "rigtri.ops.twist",
    "add_posereader": "rigtri.ops.posereader",
    "add_rivet": "rigtri.ops.rivet",
    "add_controls": "rigtri.ops.controls",
    "constrain": "rigtri.ops.constrain",
    "mirror": "rigtri.ops.mirror",
    "as_described": "rigtri.ops.described",
    "bake": "rigtri.ops.bake",
    "take_clips": "rigtri.ops.take_clips",
    "take_pose": "rigtri.ops.posing",
    "snap": "rigtri.ops.snap",
    "strip": "rigtri.ops.strip",
    "describe": "rigtri.descriptions",
    "verify": "rigtri.on_disk",
    "diff": "rigtri.difference",
    "check": "rigtri.checks",
    "recognise": "rigtri.recognition.engine",
    "draw": "rigtri.drawing.picture",
    "explain": "rigtri.explanation.steps",
    "view": "rigtri.viewer.shown",
    "export_blender": "rigtri.bridge.exported",
    "spec_init": "rigtri.spec.starter",
    "register_usd_schemas": "rigtri.formats.usd.schemas",
    "Options": "rigtri.formats",
    "Rig": "rigtri.rig",
    "Report": "rigtri.report",
    "RigtriError": "rigtri.errors",
}

__all__ = [
    "Options",
    "Report",
    "Rig",
    "RigtriError",
    "add_controls",
    "add_polevector",
    "add_posereader",
    "add_rivet",
    "add_twist",
    "as_described",
    "auto",
    "bake",
    "build",
    "check",
    "constrain",
    "describe",
    "diff",
    "draw",
    "edit",
    "explain",
    "export_blender",
    "from_pygltflib",
    "make_limb",
    "mirror",
    "orient_joints",
    "read",
    "recognise",
    "register_usd_schemas",
    "snap",
    "spec_init",
    "strip",
    "take_clips",
    "take_pose",
    "to_pygltflib",
    "verify",
    "view",
    "write",
]

if TYPE_CHECKING:
    from rigtri.bridge.exported import export_blender
    from rigtri.checks import check
    from rigtri.descriptions import describe
    from rigtri.difference import diff
    from rigtri.drawing.picture import draw
    from rigtri.errors import RigtriError
    from rigtri.explanation.steps import explain
    from rigtri.formats import Options
    from rigtri.formats.usd.schemas import register_usd_schemas
    from rigtri.in_memory import from_pygltflib, to_pygltflib
    from rigtri.on_disk import read, verify, write
    from rigtri.ops.bake import bake
    from rigtri.ops.constrain import constrain
    from rigtri.ops.controls import add_controls
    from rigtri.ops.described import as_described
    from rigtri.ops.limb import make_limb
    from rigtri.ops.mirror import mirror
    from rigtri.ops.orient import orient_joints
    from rigtri.ops.polevector import add_polevector
    from rigtri.ops.posereader import add_posereader
    from rigtri.ops.posing import take_pose
    from rigtri.ops.rivet import add_rivet
    from rigtri.ops.snap import snap
    from rigtri.ops.strip import strip
    from rigtri.ops.take_clips import take_clips
    from rigtri.ops.twist import add_twist
    from rigtri.pipeline import edit
    from rigtri.recognition.engine import recognise
    from rigtri.report import Report
    from rigtri.rig import Rig
    from rigtri.spec.automatic import auto
    from rigtri.spec.building import build
    from rigtri.spec.starter import spec_init
    from rigtri.viewer.shown import view


def __dir__() -> list[str]:
    """What consoles complete."""
    return [*__all__, "__version__"]


def __getattr__(name: str) -> Any:
    if name in _WHERE:
        return getattr(import_module(_WHERE[name]), name)
    raise AttributeError(f"module 'rigtri' has no attribute '{name}'")
