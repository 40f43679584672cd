"""The samples themselves: where their joints stand, what skin they wear, how they move."""

from __future__ import annotations

import numpy as np
from figure import Figure, Motion, Node, Skinless, about, size, wave

from rigtri.maths.quaternions import IDENTITY, conjugate, rotate
from rigtri.maths.quaternions import multiply as then
from rigtri.maths.trigonometry import Floats, sin_cos
from rigtri.maths.vectors import cross, normalise

X, Y, Z = (1, 0, 0), (0, 1, 0), (0, 0, 1)
SIDES = (("L", 1.0), ("R", -1.0))


def arm() -> Figure:
    """Three locators in centimetres; the two halves have lengths 37 and 20, the chord 51."""
    figure = Figure("arm", crooked=0.0)
    shoulder = figure.space("shoulder", (20, 140, 0))
    figure.nodes[shoulder].space = False
    figure.chain("shoulder", ("elbow", (55, 140, -12)), ("wrist", (71, 140, 0)))
    for node in figure.nodes:
        node.joint = False
    figure.animate(
        "reach",
        (0.0, 0.5, 1.0),
        {"shoulder": lambda t: about(Z, 40 * t), "elbow": lambda t: about(Y, 30 * wave(t / 2))},
    )
    return figure


def flat_ik() -> Figure:
    """A leg whose foot hangs under the root, as game rigs with IK have it."""
    figure = Figure("flat_ik")
    figure.joint("root", -1, (0, 0, 0))
    figure.chain("root", ("thigh", (0, 0.92, 0)), ("shin", (0.01, 0.5, 0.06)))
    figure.chain("root", ("foot", (0.02, 0.09, -0.02)), ("toe", (0.02, 0.03, 0.12)))
    figure.joint("knee_pole", "root", (0.01, 0.5, 0.6))
    ankle = figure.at("foot")
    figure.wrap(["thigh", "shin"], [0.09, 0.065, 0.045], tip=ankle)
    figure.wrap(["foot", "toe"], [0.045, 0.035, 0.02], side=X, tip=(0.02, 0.025, 0.19))
    times = tuple(k / 8 for k in range(9))
    thigh: Motion = lambda t: about(X, -25 * wave(t))  # noqa: E731
    shin: Motion = lambda t: about(X, 20 - 20 * wave(t + 0.25))  # noqa: E731
    turn: Motion = lambda t: about(X, 12 * wave(t))  # noqa: E731
    figure.animate("step", times, {"thigh": thigh, "shin": shin, "foot": turn})
    knee, hip = figure.at("shin"), figure.at("thigh")
    path = []
    for t in times:
        upper = thigh(t)
        path.append(hip + rotate(upper, knee - hip) + rotate(then(upper, shin(t)), ankle - knee))
    root = figure.nodes[0]
    inward = conjugate(root.axes)
    figure.key("step", "foot", "translation", times, rotate(inward, np.stack(path) - root.position))
    return figure


def biped() -> Figure:
    """A character with crooked joint axes that walks and waves."""
    figure = Figure("biped")
    figure.space("biped")
    spine = [("hips", (0, 0.96, 0)), ("spine", (0, 1.08, 0.012)), ("chest", (0, 1.24, 0.0))]
    figure.chain(0, *spine, ("neck", (0, 1.47, -0.035)), ("head", (0, 1.56, -0.01)))
    for side, sign in SIDES:
        _arm(figure, side, sign, bend=12)
        _leg(figure, side, sign)
    _leaf(figure, "head_end", "head", (0, 1.78, -0.01))
    for side, sign in SIDES:
        _leaf(figure, f"toe_{side}_end", f"toe_{side}", (0.115 * sign, 0.02, 0.2))
    staff = Skinless((-0.012, -0.55, -0.012), (0.012, 0.45, 0.012))
    grip = figure.at("hand_R") * 0.3 + figure.at("fingers_R") * 0.7
    _leaf(figure, "staff", "hand_R", grip).mesh = staff
    # A camera looks along its own −z; this one looks where the head does.
    _leaf(figure, "eyes", "head", (0, 1.66, 0.1), about(Y, 180)).camera = True
    _torso(figure)
    for side, sign in SIDES:
        _limbs(figure, side, sign)
    _walk(figure)
    _wave(figure)
    return figure


def tpose() -> Figure:
    """A T-pose whose arms and legs are straight; only the clip knows how they bend."""
    figure = Figure("tpose", crooked=0.5)
    figure.space("tpose")
    figure.chain(0, ("hips", (0, 0.96, 0)), ("spine", (0, 1.1, 0)), ("chest", (0, 1.25, 0)))
    figure.chain("chest", ("neck", (0, 1.46, 0)), ("head", (0, 1.56, 0)))
    for side, sign in SIDES:
        points = [(x * sign, 1.42, 0.0) for x in (0.04, 0.17, 0.45, 0.7, 0.78)]
        names = ("clavicle", "upper_arm", "forearm", "hand", "fingers")
        pairs = [(f"{name}_{side}", at) for name, at in zip(names, points, strict=True)]
        figure.chain("chest", *pairs)
        legs = [("thigh", 0.92, 0.0), ("shin", 0.5, 0.0), ("foot", 0.09, 0.0), ("toe", 0.03, 0.13)]
        figure.chain("hips", *((f"{n}_{side}", (0.1 * sign, y, z)) for n, y, z in legs))
    _leaf(figure, "head_end", "head", (0, 1.78, 0))
    _torso(figure)
    for side, sign in SIDES:
        _limbs(figure, side, sign)
    motions: dict[str, Motion] = {}
    for side, sign in SIDES:
        motions[f"shin_{side}"] = lambda t: about(X, 60 * wave(t / 2))
        motions[f"thigh_{side}"] = lambda t: about(X, -35 * wave(t / 2))
        motions[f"forearm_{side}"] = lambda t, sign=sign: about(Y, -70 * sign * wave(t / 2))
    figure.animate("crouch", tuple(k / 4 for k in range(5)), motions)
    return figure


def hand() -> Figure:
    """A hand, modelled in centimetres with z up: one node above it makes it metres with y up."""
    figure = Figure("hand")
    top = figure.space("hand_rig", axes=about(X, -90), scale=(0.01, 0.01, 0.01))
    figure.modelled_in = top
    figure.joint("hand", top, (0, 0, 100))
    fingers = {
        "thumb": ((3.5, -1.5, 101), (2.4, -1.2, 2.2), (3.2, 2.4), 25),
        "index": ((2.6, 0, 108.5), (0.15, 0, 1), (4.2, 2.6, 2.2), 12),
        "middle": ((0.8, 0, 109), (0.0, 0, 1), (4.6, 2.9, 2.3), 10),
        "ring": ((-1.0, 0, 108.5), (-0.1, 0, 1), (4.2, 2.7), 14),
        "little": ((-2.7, 0, 107.5), (-0.2, 0, 1), (5.5,), 0),
    }
    motions: dict[str, Motion] = {}
    for name, (start, toward, lengths, bend) in fingers.items():
        at, along = np.array(start, float), normalise(np.array(toward, float))
        root = at - along * 1.2
        hinge = normalise(cross(along, [0.0, -1.0, 0.0]))
        parent = "hand"
        joints = [f"{name}_{k + 1}" for k in range(len(lengths))]
        for joint, bone in zip(joints, lengths, strict=True):
            figure.joint(joint, parent, at)
            at, parent = at + along * bone, joint
            along = rotate(about(hinge, bend), along)
            motions[joint] = lambda t, hinge=hinge: about(hinge, 55 * wave(t / 2))
        radii = [0.85, *([0.75] * (len(lengths) - 1)), 0.55]
        figure.wrap(joints, radii, side=(0, 1, 0), above="hand", start=root, tip=at)
    figure.wrap(["hand"], [3.2, 4.0], side=X, flat=0.35, tip=(0, 0, 108), corners=8)
    figure.animate("fist", tuple(k / 4 for k in range(5)), motions)
    return figure


def tail() -> Figure:
    """A tail that bends one way and then the other, so that its bend normals change side."""
    figure = Figure("tail")
    figure.joint("pelvis", -1, (0, 1.02, 0.18))
    sine, _ = sin_cos(np.arange(8) * (2 * np.pi / 7))
    points = [(0.02 * k, 1 + 0.22 * s - 0.03 * k, -0.16 * k) for k, s in enumerate(sine.tolist(), 0)]
    names = [f"tail_{k + 1:02}" for k in range(8)]
    figure.chain("pelvis", *zip(names, points, strict=True))
    radii = [0.09 - 0.009 * k for k in range(9)]
    tip = np.array(points[-1]) + (np.array(points[-1]) - np.array(points[-2])) * 0.8
    figure.wrap(names, radii, side=X, above="pelvis", tip=tip)
    motions: dict[str, Motion] = {
        name: (lambda t, k=k: about(Y, 14 * wave(t - k / 9))) for k, name in enumerate(names)
    }
    figure.animate("sway", tuple(k / 6 for k in range(7)), motions)
    return figure


def mirrored_pair() -> Figure:
    """A left arm, and a right arm that is the left one under a scale of −1 in x."""
    figure = Figure("mirrored_pair")
    points = [np.array([0.035, 1.42, 0.01]), *_arm_points(bend=15)]
    for side, sign in SIDES:
        figure.space(f"side_{side}", scale=(sign, 1, 1))
        axes = [figure.nodes[figure.index(n)].axes for n in _ARM] if side == "R" else [None] * 5
        parent: int = len(figure.nodes) - 1
        for name, at, turn in zip(_ARM, points, axes, strict=True):
            parent = figure.joint(name.replace("_L", f"_{side}"), parent, at, turn)
    names, radii = ["upper_arm_L", "forearm_L", "hand_L"], [0.055, 0.042, 0.035, 0.03]
    figure.wrap(names, radii, above="clavicle_L", tip=figure.at("fingers_L"))
    _reflect(figure)
    for side in "LR":
        flex: Motion = lambda t: about((0.5, -0.6, 0), 50 * wave(t / 2))  # noqa: E731
        figure.animate("flex", tuple(k / 4 for k in range(5)), {f"forearm_{side}": flex})
    return figure


_ARM = ("clavicle_L", "upper_arm_L", "forearm_L", "hand_L", "fingers_L")


def _reflect(figure: Figure) -> None:
    """Skin for the other side: the same points with x negated, wound the other way."""
    skin, count = figure.skin, len(figure.skin.points)
    other = {
        k: figure.index(node.name.replace("_L", "_R"))
        for k, node in enumerate(figure.nodes)
        if "_L" in node.name
    }
    skin.points += [point * np.array([-1.0, 1.0, 1.0]) for point in skin.points]
    skin.weights += [{other[k]: w for k, w in weights.items()} for weights in skin.weights]
    skin.triangles += [(b + count, a + count, c + count) for a, b, c in skin.triangles]


def _arm_points(*, bend: float) -> list[Floats]:
    """Shoulder, elbow, wrist and knuckles of a left arm that hangs half down and bends forward."""
    down = rotate(about(Z, -38), np.array([1.0, 0.0, 0.0]))
    forward = rotate(about(cross(down, Z), bend), down)
    shoulder = np.array([0.18, 1.43, -0.03])
    elbow = shoulder + down * 0.28
    wrist = elbow + forward * 0.25
    return [shoulder, elbow, wrist, wrist + rotate(about(Z, -4), forward) * 0.09]


def _arm(figure: Figure, side: str, sign: float, *, bend: float) -> None:
    names = (f"{part}_{side}" for part in ("upper_arm", "forearm", "hand", "fingers"))
    points = [point * np.array([sign, 1.0, 1.0]) for point in _arm_points(bend=bend)]
    clavicle = (f"clavicle_{side}", (0.035 * sign, 1.42, 0.01))
    figure.chain("chest", clavicle, *zip(names, points, strict=True))


def _leg(figure: Figure, side: str, sign: float) -> None:
    figure.chain(
        "hips",
        (f"thigh_{side}", (0.095 * sign, 0.92, 0)),
        (f"shin_{side}", (0.1 * sign, 0.51, 0.03)),
        (f"foot_{side}", (0.105 * sign, 0.09, -0.015)),
        (f"toe_{side}", (0.115 * sign, 0.025, 0.12)),
    )


def _leaf(
    figure: Figure,
    name: str,
    parent: str,
    position: tuple[float, float, float] | Floats,
    axes: Floats | None = None,
) -> Node:
    """A node at the end of a joint that is no joint itself."""
    node = figure.nodes[figure.joint(name, parent, position, IDENTITY if axes is None else axes)]
    node.joint = False
    return node


def _torso(figure: Figure) -> None:
    crown = figure.at("head") + np.array([0.0, 0.2, 0.02])
    trunk = ["hips", "spine", "chest"]
    ends = {"start": (0, 0.86, 0), "tip": (0, 1.45, -0.02)}
    figure.wrap(trunk, [0.165, 0.13, 0.17, 0.1], side=X, flat=0.62, corners=8, **ends)
    neck = ["neck", "head"]
    figure.wrap(neck, [0.055, 0.085, 0.07], side=X, flat=1.15, above="chest", tip=crown, corners=8)


def _limbs(figure: Figure, side: str, sign: float) -> None:
    arm = [f"{part}_{side}" for part in ("upper_arm", "forearm", "hand", "fingers")]
    knuckles, wrist = figure.at(arm[3]), figure.at(arm[2])
    tip = knuckles + (knuckles - wrist) * 0.9
    figure.wrap(arm, [0.055, 0.042, 0.032, 0.034, 0.02], flat=0.8, above=f"clavicle_{side}", tip=tip)
    thigh, shin, foot, toe = (f"{part}_{side}" for part in ("thigh", "shin", "foot", "toe"))
    figure.wrap([thigh, shin, foot], [0.09, 0.062, 0.045], above="hips")
    end = figure.at(toe) + np.array([0.0, -0.005, 0.08])
    figure.wrap([foot, toe], [0.05, 0.042, 0.03], side=X, flat=0.8, tip=end)


def _walk(figure: Figure) -> None:
    times = tuple(k / 8 for k in range(9))
    motions: dict[str, Motion] = {
        "hips": lambda t: about(Y, 6 * wave(t)),
        "spine": lambda t: about(Y, -3 * wave(t)),
        "chest": lambda t: about(Y, -8 * wave(t)),
        "neck": lambda t: about(Y, 3 * wave(t)),
        "head": lambda t: then(about(Y, 2 * wave(t)), about(X, 2 * wave(2 * t))),
    }
    for side, sign in SIDES:
        shift = 0.0 if side == "L" else 0.5
        motions |= _walking_leg(side, shift) | _walking_arm(figure, side, sign, shift + 0.5)
    figure.animate("walk", times, motions)
    bounce = [(0.012 * wave(t), 0.96 + 0.018 * wave(2 * t + 0.1), 0.0) for t in times]
    figure.key("walk", "hips", "translation", times, np.array(bounce))


def _walking_leg(side: str, shift: float) -> dict[str, Motion]:
    """Thigh forward where the sine is positive; the knee bends while it swings forward."""
    return {
        f"thigh_{side}": lambda t: about(X, -26 * wave(t + shift) - 4),
        f"shin_{side}": lambda t: about(X, 20 + 20 * wave(t + shift + 0.25)),
        f"foot_{side}": lambda t: about(X, -6 + 12 * wave(t + shift - 0.2)),
        f"toe_{side}": lambda t: about(X, -8 - 8 * wave(t + shift)),
    }


def _walking_arm(figure: Figure, side: str, sign: float, shift: float) -> dict[str, Motion]:
    hinge = _elbow(figure, side)
    return {
        f"clavicle_{side}": lambda t: about(Z, 2 * sign * wave(2 * t)),
        f"upper_arm_{side}": lambda t: then(about(X, -22 * wave(t + shift)), about(Z, -34 * sign)),
        f"forearm_{side}": lambda t: about(hinge, 14 + 10 * wave(t + shift)),
        f"hand_{side}": lambda t: about(hinge, 5 * wave(t + shift - 0.1)),
        f"fingers_{side}": lambda t: about(Z, -12 * sign),
    }


def _wave(figure: Figure) -> None:
    """The right arm waves on splines, the head glances in steps, the chest breathes in lines."""
    hinge = _elbow(figure, "R")
    times = (0.0, 0.4, 0.7, 1.0, 1.3, 1.7)
    up = dict(zip(times, (0, -70, -75, -68, -75, 0), strict=True))
    bend = dict(zip(times, (0, 60, 95, 50, 90, 0), strict=True))
    figure.animate(
        "wave",
        times,
        {
            "upper_arm_R": lambda t: about(Z, up[t]),
            "forearm_R": lambda t: about(hinge, bend[t]),
            "hand_R": lambda t: about(Z, 12 * wave(t)),
        },
        mode="CUBICSPLINE",
    )
    glance = {0.0: 0.0, 0.5: -20.0, 1.5: 0.0}
    figure.animate("wave", tuple(glance), {"head": lambda t: about(Y, glance[t])}, mode="STEP")
    breath = np.array([[1.0] * 3, [1.03] * 3, [1.0] * 3])
    figure.key("wave", "chest", "scale", (0.0, 0.85, 1.7), breath)


def _elbow(figure: Figure, side: str) -> tuple[float, float, float]:
    a, b, c = (figure.at(f"{part}_{side}") for part in ("upper_arm", "forearm", "hand"))
    normal = cross(b - a, c - b) / size(cross(b - a, c - b))
    return (float(normal[0]), float(normal[1]), float(normal[2]))


ALL = (arm, flat_ik, biped, hand, tpose, tail, mirrored_pair)
