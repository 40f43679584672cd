"""The step orient-joints"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Any

from rigtri.errors import RigtriError, UsageError
from rigtri.files.text_files import check_plain, json_of
from rigtri.formats import read
from rigtri.model.rig import Rig
from rigtri.operations.axis_presets import PRESETS, AxisStyle
from rigtri.operations.joint_selection import Selection
from rigtri.operations.orient_joints.orient import OrientJointsOptions, orient_joints
from rigtri.pipeline.steps.request import Request, Step
from rigtri.recognition.limbs import given
from rigtri.report import Report

_BRANCHES = ("chain", "first", "average", "longest", "incoming", "keep")
# Options that say where axes go, which frames from elsewhere have said already.
_GEOMETRY = (
    "--preset",
    "--aim",
    "--up",
    "--up-from",
    "--aim-at",
    "--branch",
    "--end",
    "--per-joint-plane",
    "--facing",
    "--world",
)


def step(request: Request) -> Step:
    """Raises UsageError for options that contradict each other, FileError for files they name."""
    style, chain_styles = _styles(request)
    rules = [word for word in request["branch"] if word in _BRANCHES]
    _check(request)
    frames = json_of(request["frames"], "--frames") if request["frames"] else None
    like = _like(request["like"]) if request["like"] else None

    def applied(rig: Rig, report: Report) -> Rig:
        options = OrientJointsOptions(
            style=style,
            selection=_selection(request),
            chain_styles=chain_styles,
            branch=rules[-1] if rules else "chain",
            branch_to=tuple(word for word in request["branch"] if word not in _BRANCHES),
            end=request["end"],
            aim_at=tuple(_pair(rig, text) for text in request["aim_at"]),
            limbs=tuple(given(rig, *names) for names in request["limbs"]),
            per_joint_plane=request["per_joint_plane"],
            facing=request["facing"],
            pose=request["pose"],
            on_nonuniform_scale=request["on_nonuniform_scale"],
            on_constraint=request["on_constraint"],
            snap=request["snap"],
            offset=request["offset"],
            mirror=request["mirror"],
            from_side=request["from_side"],
            plane=request["plane"],
            root=request["root"],
            like=like,
            frames=frames,
            inverse=request["inverse"],
            tolerance=request["tolerance"],
        )
        return orient_joints(rig, options=options, report=report)

    return applied


def _styles(request: Request) -> tuple[AxisStyle, tuple[tuple[str, str, AxisStyle], ...]]:
    """The style for all, and the styles of chains: what stands behind a chain is for it."""
    base = PRESETS[request["preset"]] if request["preset"] else AxisStyle()
    base = replace(base, world=True) if request["world"] else base
    chains: list[tuple[str, str, AxisStyle]] = []
    order: Iterable[tuple[str, Any]] = request["order"]
    for name, value in order:
        if name == "chains":
            chains.append((*value, base))
        elif chains:
            start, end, style = chains[-1]
            chains[-1] = (start, end, replace(style, **{name: value}))
        else:
            base = replace(base, **{name: value})
    base.checked()
    return base, tuple((start, end, style.checked()) for start, end, style in chains)


def _check(request: Request) -> None:
    """UsageError for options that contradict each other."""
    if request["like"] and request["frames"]:
        raise UsageError("give --like or --frames, not both")
    if request["inverse"] and not request["frames"]:
        raise UsageError("--inverse goes with --frames")
    if request["mirror"] and (request["frames"] or request["like"]):
        raise UsageError("--mirror does not go with --like or --frames")
    if not request["mirror"]:
        request.refuse({"--from-side": "from_side", "--plane": "plane"}, "goes with --mirror")
    geometry = {flag: flag[2:].replace("-", "_") for flag in _GEOMETRY}
    if request["frames"]:
        request.refuse(geometry | {"--offset": "offset", "--snap": "snap"}, "does not go with --frames")
    if request["like"]:
        request.refuse(geometry, "does not go with --like")
    if request["world"] or request["preset"] == "vrm":
        axes = {"--aim": "aim", "--up": "up", "--up-from": "up_from"}
        request.refuse(axes, "does not go with axes parallel to the world")
    if request["world"] and request["preset"] not in (None, "vrm"):
        raise UsageError("give --preset or --world, not both")
    if sum(word in _BRANCHES for word in request["branch"]) > 1:
        raise UsageError("give one rule with --branch, and any number of names of children")


def _selection(request: Request) -> Selection:
    return Selection(
        joints=request["joints"],
        below=request["below"],
        skin=request["skin"],
        exclude=request["exclude"],
    )


def _pair(rig: Rig, text: str) -> tuple[str, str]:
    """JOINT=NODE; names may hold ``=`` themselves, so the cut is where both sides are found."""
    cuts = [k for k, letter in enumerate(text) if letter == "=" and 0 < k < len(text) - 1]
    if not cuts:
        raise UsageError(f"--aim-at {text}: give JOINT=NODE")
    pairs = [(text[:k], text[k + 1 :]) for k in cuts]
    found = [pair for pair in pairs if all(rig.has(name) for name in pair)]
    joint, node = found[0] if len(found) == 1 else pairs[0]
    if rig.find(joint) == rig.find(node, "node"):
        raise UsageError(f"--aim-at {text}: a joint cannot aim at itself")
    return joint, node


def _like(path: str) -> Rig:
    place = check_plain(path, "--like")
    try:
        return read(place).rig
    except RigtriError as error:
        raise type(error)(f"--like: {error}") from error
