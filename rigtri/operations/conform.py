"""conform: the standard skeleton of an engine, by the steps that make it.

Two characters that conform to one skeleton have the same names, rest pose, axes and root, and differ in the
lengths of their bones: clips of one fit the other.

Source: Godot, SkeletonProfileHumanoid; VRMC_vrm 1.0, humanoid.md and tpose.md; Unity, HumanBodyBones; Unreal
Engine, the mannequin.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from rigtri.errors import UsageError
from rigtri.model.rig import Rig
from rigtri.operations.operation import operation
from rigtri.operations.options.conform import ConformOptions as ConformOptions
from rigtri.operations.registry import operation as function_of
from rigtri.report import Report

Steps = tuple[tuple[str, Mapping[str, Any]], ...]
# What each skeleton takes, in this order: what it is like at rest before its axes.
_STEPS: Mapping[str, Steps] = {
    "unreal": (
        ("set-rest", {"pose": "apose"}),
        ("add-root", {"name": "root"}),
        ("orient-joints", {"preset": "unreal-editor"}),
    ),
    "unity": (("set-rest", {"pose": "tpose"}), ("orient-joints", {"preset": "vrm"})),
    "godot": (
        ("set-rest", {"pose": "tpose"}),
        ("add-root", {"name": "Root"}),
        ("orient-joints", {"preset": "blender"}),
    ),
    "vrm": (("set-rest", {"pose": "tpose"}), ("orient-joints", {"preset": "vrm"})),
    "mixamo": (("set-rest", {"pose": "tpose"}), ("orient-joints", {"preset": "blender"})),
}


def steps_of(options: ConformOptions) -> Steps:
    """The steps, as a rig spec has them: names of operations and their options."""
    facing = {} if options.facing is None else {"facing": options.facing}
    own = [
        (name, {**values, **(facing if name in ("set-rest", "orient-joints") else {})})
        for name, values in _STEPS[options.to]
    ]
    # Names before all that is recognised: a second run reads the same names, and finds the same body.
    return (("freeze", {}), ("rename-joints", {"to": options.to}), *own)


@operation(ConformOptions)
def conform(rig: Rig, *, options: ConformOptions, report: Report) -> Rig:
    """The rig with the standard skeleton of an engine; every clip looks as before.

    Raises as the steps do (`steps_of`): freeze, rename-joints, set-rest, add-root, orient-joints.
    """
    for name, values in steps_of(options):
        known = len(report.joints)
        try:
            rig = function_of(name)(rig, report=report, **values)
        except UsageError as error:
            raise UsageError(f"{name}: {error}") from error
        del report.joints[known:]
        report.added.append({"type": "step", "do": name, "node": "", "new": False, **_shown(values)})
    return rig


def _shown(values: Mapping[str, Any]) -> dict[str, Any]:
    return {key: list(value) if isinstance(value, tuple) else value for key, value in values.items()}
