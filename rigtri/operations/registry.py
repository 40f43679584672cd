"""All operations: their names, their functions, and their options."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import Any

from rigtri.model.rig import Rig

# Where their functions are, in the order in which a rig is built.
OPERATIONS = {
    "freeze": "freeze",
    "rename-joints": "rename_joints",
    "prune-joints": "prune_joints",
    "merge-joints": "merge_joints",
    "limit-weights": "limit_weights",
    "set-rest": "set_rest",
    "add-root": "add_root",
    "add-socket": "add_socket",
    "root-motion": "root_motion",
    "conform": "conform",
    "orient-joints": "orient_joints.orient",
    "make-limb": "make_limb",
    "add-twist": "add_twist.twist",
    "add-controls": "add_controls",
    "add-polevector": "add_polevector",
    "constrain": "constrain.constrain",
    "add-rivet": "add_rivet.rivet",
    "add-posereader": "add_posereader.posereader",
    "mirror": "mirror.mirror",
    "take-clips": "take_clips.take_clips",
    "snap": "snap",
    "bake": "bake.bake",
    "pose": "pose",
    "strip": "strip",
}
_FUNCTIONS = {"pose": "take_pose"}


def operation(name: str) -> Callable[..., Rig]:
    """The function of an operation, by its command's name."""
    function = _FUNCTIONS.get(name, name.replace("-", "_"))
    found: Callable[..., Rig] = getattr(import_module(f"rigtri.operations.{OPERATIONS[name]}"), function)
    return found


def options_class(name: str) -> type[Any]:
    """The dataclass of an operation's options."""
    module = import_module(f"rigtri.operations.options.{name.replace('-', '_')}")
    found: type[Any] = getattr(module, f"{name.title().replace('-', '')}Options")
    return found
