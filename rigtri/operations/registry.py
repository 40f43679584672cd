"""All operations: each with its line of help, its function and its options."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

if TYPE_CHECKING:
    from rigtri.model.rig import Rig


class Registered(NamedTuple):
    """An operation. module: below `rigtri.operations`, where its function is.

    heading: under which its command stands in help. summary: what it does, in a line. page: of docs/.
    """

    module: str
    heading: Literal["Re-orient", "Build", "Motion", "Library"]
    summary: str
    page: str = "operations.md"


_SKELETON = "one-skeleton.md"
# By the names of their commands, in the order in which a rig is built.
OPERATIONS = {
    "freeze": Registered(
        "freeze",
        "Library",
        "Put scale and rotation above joints into the joints; nothing that can be seen moves.",
        _SKELETON,
    ),
    "rename-joints": Registered(
        "rename_joints",
        "Library",
        "Give joints the names of another scheme: Mixamo, Unreal, Unity, VRM, Rigify ...",
        _SKELETON,
    ),
    "set-rest": Registered(
        "set_rest",
        "Library",
        "Give joints another rest pose, T-pose or A-pose too; every clip plays as before.",
        _SKELETON,
    ),
    "conform": Registered(
        "conform",
        "Library",
        "Give a character the standard skeleton of Unreal, Unity, Godot, VRM or Mixamo.",
        _SKELETON,
    ),
    "add-root": Registered(
        "add_root",
        "Library",
        "Add a root joint on the ground, above a character's joints; nothing moves.",
        _SKELETON,
    ),
    "add-socket": Registered(
        "add_socket",
        "Library",
        "Add a node below a joint, to attach a weapon, a hat or an effect to.",
        _SKELETON,
    ),
    "root-motion": Registered(
        "root_motion",
        "Library",
        "Move motion over the ground from the hips to the root, or take it out.",
        _SKELETON,
    ),
    "prune-joints": Registered("prune_joints", "Library", "Remove joints that move nothing.", _SKELETON),
    "merge-joints": Registered(
        "merge_joints",
        "Library",
        "Merge joints into their parents: still ones, named ones, or down to a number.",
        _SKELETON,
    ),
    "limit-weights": Registered(
        "limit_weights",
        "Library",
        "Limit the number of joints that move a vertex, and normalise weights.",
        _SKELETON,
    ),
    "orient-joints": Registered(
        "orient_joints.orient",
        "Re-orient",
        "Give joints new axes; nothing that can be seen moves.",
        "tasks/straighten.md",
    ),
    "make-limb": Registered(
        "make_limb",
        "Build",
        "Make a chain of oriented joints from points or locators; three are a limb with its pole vector.",
    ),
    "add-twist": Registered(
        "add_twist.twist",
        "Build",
        "Put twist joints along bones, which avoids the candy-wrapper effect.",
    ),
    "add-controls": Registered(
        "add_controls",
        "Build",
        "Put a tree of controls over joints: fingers, spines, limbs, characters.",
    ),
    "add-polevector": Registered(
        "add_polevector", "Build", "Add a locator that says which way a limb bends."
    ),
    "constrain": Registered(
        "constrain.constrain",
        "Build",
        "Constrain a node to others: parent, point, orient, scale, aim, pole vector.",
        "constraints.md",
    ),
    "add-posereader": Registered(
        "add_posereader.posereader",
        "Build",
        "Drive morph targets, joints or values by the pose of a joint, baked to keys.",
    ),
    "add-rivet": Registered(
        "add_rivet.rivet",
        "Build",
        "Attach locators to the surface of a mesh, through skinning and morph targets, baked to keys.",
    ),
    "mirror": Registered(
        "mirror.mirror",
        "Re-orient",
        "Give one side of a character the axes of the other, and all that rigtri has built there.",
    ),
    "pose": Registered(
        "pose",
        "Motion",
        "Print the pose of one moment, evaluated, or make it the rest pose.",
        "evaluation.md",
    ),
    "snap": Registered(
        "snap",
        "Motion",
        "Match IK to FK, or FK to IK, at some frames: the joints do not move there.",
        "evaluation.md",
    ),
    "bake": Registered(
        "bake.bake",
        "Motion",
        "Bake controls and constraints to joint keys, or joints' motion to controls.",
        "evaluation.md",
    ),
    "take-clips": Registered(
        "take_clips.take_clips",
        "Motion",
        "Transfer the animation of an edited file back to the rig it was made from.",
        "take-clips.md",
    ),
    "strip": Registered("strip", "Build", "Remove what rigtri has added to a file."),
}
_FUNCTIONS = {"pose": "take_pose"}


def operation(name: str) -> Callable[..., Rig]:
    """The function of an operation, by its command's name."""
    function = _FUNCTIONS.get(name, name.replace("-", "_"))
    module = import_module(f"rigtri.operations.{OPERATIONS[name].module}")
    found: Callable[..., Rig] = getattr(module, function)
    return found


def options_class(name: str) -> type[Any]:
    """The dataclass of an operation's options."""
    module = import_module(f"rigtri.operations.options.{name.replace('-', '_')}")
    found: type[Any] = getattr(module, f"{name.title().replace('-', '')}Options")
    return found
