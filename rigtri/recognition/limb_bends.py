"""The side to which each limb bends, as orient-joints, add-polevector and check take it.

It comes from the pose, the motion, the twin of the limb, or its kind and the facing direction.

Half of all real limbs are straight at rest, and noise then looks like a bend plane; clips lock knees and
bend them a little backwards. So what is small is accepted only where limbs of that kind bend so.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import field

import numpy as np

from rigtri.maths.angle_limits import cosine_below, sine_below
from rigtri.maths.triangle import STRAIGHT_SINE, bend_angle
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import angle, cross, dot, length, normalise, perpendicular
from rigtri.model.dataclass import dataclass
from rigtri.model.limb import Limb
from rigtri.model.rig import Rig
from rigtri.recognition.bend_direction import (
    BENT,
    CLEAR,
    SOURCE_TEXT,
    Bend,
    in_motion,
    in_pose,
    mirrored,
    towards,
)
from rigtri.recognition.body_hinges import Body, body_of
from rigtri.recognition.thumb_bends import hides, noise_of_twins
from rigtri.report import Report

# A small bend is accepted within this of the natural side (a cosine), from the second on where its twin
# is so near to the mirror image, unless noise of joints may have turned its plane.
NATURAL, MIRRORED = cosine_below(60), cosine_below(30)
# Noise of joints is known by few bones: a small bend counts where so many deviations leave its plane.
DEVIATIONS = 2.0
# A bend is against a direction where it is farther from it than a right angle (a cosine).
AGAINST = -cosine_below(90)
# A knee that bends aside by less than this (a sine) may be the shape of a leg.
BANDY = sine_below(30)
# Below this sine (0.1°) a bend plane is float32 noise.
NO_PLANE = 1.7453283658983088e-3


@dataclass(frozen=True, eq=False)
class LimbBends:
    """What is known of the limbs of a rig in a pose, world (n, 4, 4).

    other_pose: (n, 4, 4), the other pose of the file. limbs: those among which twins are found. bodies: of
    the characters whose facing direction is known. facing: the user's word, (3,), where there is no body.
    """

    rig: Rig
    world: Floats
    other_pose: Floats | None
    limbs: Sequence[Limb]
    bodies: Sequence[Body]
    facing: Floats | None = None
    # Limbs are asked for as themselves and as twins, and the motion of each is read once.
    _moved: dict[tuple[int, ...], Bend | None] = field(default_factory=dict, init=False)
    _posed: dict[tuple[int, ...], Bend] = field(default_factory=dict, init=False)

    def of(self, limb: Limb, report: Report, given: Floats | None = None) -> Bend | None:
        """Where a limb bends to, or None when nothing shows it. given: the user's word, (3,).

        From 10° on a bend is the truth, in the pose or in the motion. Below, it is taken within 60° of what
        knees and elbows do where the body faces, but from 30° on only where it is no noise: where the limb
        of the other side mirrors it; and none whose plane noise of the joints may have turned. Else they bend
        as knees and elbows do, with a warning.

        Source: docs/presets.md, "Limbs".
        """
        if given is not None:
            return towards(limb, self.world, given, "given", 1.0)
        natural = self._natural(limb, self._facing_of(limb))
        taken, doubted = self._shown(limb, natural)
        taken = taken or self._other_side(limb, natural, doubted) or natural
        if taken is not None:
            shape = doubted is not None and natural is not None and self._is_shape(limb, doubted, natural)
            if doubted is not None and natural is not None and not shape:
                self._warn(limb, doubted, natural, taken, report)
            elif natural is not None:
                self._warn_aside(limb, natural, doubted or taken, report, shape=shape)
            elif limb.kind and taken.sine < CLEAR:
                self._warn_no_facing(limb, taken, report)
            return taken
        # What a format prescribes says where a straight limb bends, and is nobody's word against a bend.
        prescribed = self.rig.rules.facing
        natural = self._natural(limb, None if prescribed is None else np.array(prescribed))
        if natural is not None:
            return natural
        posed = self._in_pose(limb)
        return posed if posed.sine >= NO_PLANE else None

    def why_unheard(self, limb: Limb, found: Bend) -> str:
        """Why the facing direction has no say in how a limb bends, in words; "" where it has."""
        if not limb.kind:
            return "nothing says whether it is an arm or a leg"
        if found.source in ("facing", "given") or found.sine < CLEAR:
            return ""
        if found.source == "pose":
            return "it is clearly bent, and bends where it does"
        return f"it bends clearly in {SOURCE_TEXT[found.source]}"

    def is_against_facing(self, limb: Limb, found: Bend) -> bool:
        """Whether a limb bends to another side than knees and elbows do where the body faces."""
        natural = self._natural(limb, self._facing_of(limb))
        return natural is not None and bool(dot(found.direction, natural.direction) < AGAINST)

    def _facing_of(self, limb: Limb) -> Floats | None:
        """Where the body looks as a limb has it, unit, (3,)."""
        body = body_of(self.bodies, limb.start)
        return (
            self.facing
            if body is None
            else body.facing_of(self.world[list(limb.triple), 3, :3], arm=limb.kind == "arm")
        )

    def _natural(self, limb: Limb, facing: Floats | None) -> Bend | None:
        """Knees bend forward, and elbows back."""
        if facing is None or not limb.kind:
            return None
        return towards(limb, self.world, -facing if limb.bends_back else facing, "facing", 1.0)

    def _shown(self, limb: Limb, natural: Bend | None) -> tuple[Bend | None, Bend | None]:
        """What a limb shows that is accepted, and what it shows before that is not.

        What noise may have bent near the natural side is neither. Of a pose that is not accepted the motion
        says on which side it errs, and not which plane is right: where it is near the natural one, that is
        taken.
        """
        doubted = None
        for found in self._own(limb):
            if natural is None or self._is_believable(limb, found, natural):
                errs = doubted is not None and natural is not None
                near = natural is not None and bool(dot(found.direction, natural.direction) >= NATURAL)
                return natural if errs and near else found, doubted
            if natural is not None and dot(found.direction, natural.direction) < MIRRORED:
                doubted = doubted or found
        return None, doubted

    def _other_side(self, limb: Limb, natural: Bend | None, doubted: Bend | None) -> Bend | None:
        """What the limb of the other side shows, in the mirror.

        Against what the limb shows counts only a clear motion of the other side: what that does in one pose
        may be its own.
        """
        twin = self._twin(limb)
        if twin is None:
            return None
        theirs, _ = self._shown(twin, self._natural(twin, self._facing_of(twin)))
        if theirs is None or theirs.source == "facing":
            return None
        if doubted is not None and (theirs.source == "pose" or theirs.sine < CLEAR):
            return None
        found = towards(limb, self.world, self._image(limb, theirs, twin), "other side", theirs.sine)
        if found is None or natural is None or self._is_believable(limb, found, natural):
            return found
        return None

    def _own(self, limb: Limb) -> Iterator[Bend]:
        """What the pose shows of a limb, and the motion: where the pose is straight, or a clear bend."""
        posed = self._in_pose(limb)
        if posed.sine >= STRAIGHT_SINE:
            yield posed
        if limb.triple not in self._moved:
            twin = self._twin(limb)  # which is asked next, as often as not
            both = [limb] if twin is None or twin.triple in self._moved else [limb, twin]
            found = in_motion(self.rig, both, self.world, self.other_pose)
            self._moved.update(zip([k.triple for k in both], found, strict=True))
        moved = self._moved[limb.triple]
        if moved is not None and (posed.sine < STRAIGHT_SINE or moved.sine >= CLEAR):
            yield moved

    def _in_pose(self, limb: Limb) -> Bend:
        """What the pose shows of a limb; one look at all limbs takes as long as one at one."""
        if limb.triple not in self._posed:
            every = [*self.limbs, limb]
            self._posed.update(zip([k.triple for k in every], in_pose(every, self.world), strict=True))
        return self._posed[limb.triple]

    def _is_believable(self, limb: Limb, found: Bend, natural: Bend) -> bool:
        near = float(dot(found.direction, natural.direction))
        if self._is_clear(limb, found):
            return near >= MIRRORED or not self._is_shape(limb, found, natural)
        if found.source == "pose" and self._is_noise(limb):
            return False
        return near >= MIRRORED or (near >= NATURAL and self._is_mirrored(limb, found, natural))

    def _is_noise(self, limb: Limb) -> bool:
        """Whether noise of joints may have turned the plane of a limb, as the bones of both sides show it."""
        a, b, c = self.world[list(limb.triple), 3, :3]
        height = float(length(cross(b - a, c - b)) / length(c - a))
        body = body_of(self.bodies, limb.start)
        mine = [k for k in self.limbs if k.side == "left" and (body is None or k.start in body.nodes)]
        twins = [(k, twin) for k in mine if (twin := self._twin(k)) is not None]
        one, other = ([bone for pair in twins for bone in self._bones(pair[k])] for k in (0, 1))
        return hides(DEVIATIONS * noise_of_twins(one, other), height)

    def _bones(self, limb: Limb) -> list[float]:
        """The lengths of the upper and the lower bone, file units."""
        points = self.world[list(limb.triple), 3, :3]
        return [float(bone) for bone in length(points[1:] - points[:-1])]

    def _is_shape(self, limb: Limb, found: Bend, natural: Bend) -> bool:
        """Whether a knee that bends little and aside is bandy or a knock knee: the foot points ahead.

        Of a leg that is turned out, as a frog's, the foot points where the knee does.
        """
        body = body_of(self.bodies, limb.end)
        foot = None if body is None else body.feet.get(limb.end)
        if foot is None or not self._is_aside(limb, found, natural) or not self._is_clear(limb, found):
            return False
        a, _, c = self.world[list(limb.triple), 3, :3]
        foot = normalise(perpendicular(foot, normalise(c - a)))
        ahead, aside = (float(dot(foot, each.direction)) for each in (natural, found))
        return ahead >= NATURAL > abs(aside)

    def _is_aside(self, limb: Limb, found: Bend, natural: Bend) -> bool:
        """Whether a knee bends in the pose by less than 30°, and more than 60° off forward and back."""
        aside = abs(float(dot(found.direction, natural.direction))) < NATURAL
        return aside and not limb.bends_back and found.source == "pose" and found.sine < BANDY

    def _is_clear(self, limb: Limb, found: Bend) -> bool:
        """Whether a bend is the truth; of two poses that mirror each other by the mean, so that both are."""
        twin = self._twin(limb) if found.source == "pose" else None
        if twin is not None:
            theirs = self._in_pose(twin)
            alike = abs(found.sine - theirs.sine) < BENT
            if alike and dot(found.direction, self._image(limb, theirs, twin)) >= MIRRORED:
                return 0.5 * (found.sine + theirs.sine) >= CLEAR
        return found.sine >= CLEAR

    def _is_mirrored(self, limb: Limb, found: Bend, natural: Bend) -> bool:
        """Whether the limb of the other side shows that a small bend is no noise; or there is none."""
        twin = self._twin(limb)
        if twin is None:
            return True
        theirs = next(self._own(twin), None)
        if theirs is None:
            return False
        if theirs.source == "pose" and theirs.sine >= CLEAR:
            return True  # of a pose in which both sides do different things
        image = self._image(limb, theirs, twin)
        alike = dot(found.direction, image) >= MIRRORED
        return found.source != "other side" and bool(
            alike and dot(theirs.direction, natural.direction) >= NATURAL
        )

    def _twin(self, limb: Limb) -> Limb | None:
        """The limb of the other side."""
        kind = limb.kind, limb.front
        twins = [
            k for k in self.limbs if (k.kind, k.front) == kind and {k.side, limb.side} == {"left", "right"}
        ]
        # Of several characters in a file, the nearest twin is the limb's own.
        return min(twins, key=lambda k: abs(k.start - limb.start), default=None)

    def _image(self, limb: Limb, theirs: Bend, twin: Limb) -> Floats:
        """The direction of a bend of the twin, (3,), seen in the mirror."""
        return mirrored(theirs.direction, self.world[limb.start, 3, :3], self.world[twin.start, 3, :3])

    def _warn(self, limb: Limb, doubted: Bend, natural: Bend, taken: Bend, report: Report) -> None:
        off = float(np.degrees(angle(doubted.direction, natural.direction)))
        title, bent = self.rig.chain_title(limb.triple), self._bent(limb, doubted)
        does = "elbows bend back" if limb.bends_back else "knees bend forward"
        report.warn(
            "bends-otherwise",
            f"{title} is bent {bent} to a side {off:.0f}° off the one that is natural ({does}); bend "
            f"direction: from {SOURCE_TEXT[taken.source]}. Another --facing, or a bend of more than 10°, "
            "changes that.",
            joint=title,
            geometry=True,
        )

    def _bent(self, limb: Limb, found: Bend) -> str:
        """How far a bend below 10° is, in words."""
        if found.source != "pose":
            return f"less than 10° in {SOURCE_TEXT[found.source]}"
        return f"{float(np.degrees(bend_angle(*self.world[list(limb.triple), 3, :3]))):.2g}°"

    def _warn_no_facing(self, limb: Limb, found: Bend, report: Report) -> None:
        """Warn of a knee or elbow of which nothing shows whether a small bend is the natural one."""
        title = self.rig.chain_title(limb.triple)
        report.warn(
            "no-facing",
            f"{title} is bent {self._bent(limb, found)}, and nothing shows where its body faces, so that "
            "this is taken as the bend direction, be it noise or not. Say where it faces with --facing",
            joint=title,
            geometry=True,
        )

    def _warn_aside(self, limb: Limb, natural: Bend, seen: Bend, report: Report, *, shape: bool) -> None:
        """Warn of a knee that bends little and aside: bandy legs and knock knees have that shape, too."""
        if not self._is_aside(limb, seen, natural):
            return
        bent = float(np.degrees(bend_angle(*self.world[list(limb.triple), 3, :3])))
        off = float(np.degrees(angle(seen.direction, natural.direction)))
        title = self.rig.chain_title(limb.triple)
        what = (
            "but the foot points ahead: it is taken for the shape of the leg, and the knee bends forward. If "
            "it is a bend"
            if shape
            else "and this is taken as the bend direction of the knee. If only the leg has this shape"
        )
        report.warn(
            "bends-aside",
            f"{title} is bent {bent:.2g}° to the side, {off:.0f}° off forward, {what}, name the direction: "
            "add-polevector --bend, orient-joints --chain with --up-from.",
            joint=title,
            geometry=True,
        )
