"""About which axis a hand closes: one for its fingers and the wrist, and the thumb's own.

Source: docs/presets.md, "One body, one sense"; measured on real characters.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from typing import NamedTuple

import numpy as np

from rigtri.maths.angle_limits import cosine_below, radians_below
from rigtri.maths.arrays import Integers
from rigtri.maths.quaternions import from_axis_angle, rotate
from rigtri.maths.triangle import bend_angle
from rigtri.maths.trigonometry import Floats, arc_tangent
from rigtri.maths.vectors import angle, cross, dot, length, normalise, perpendicular
from rigtri.model.dataclass import dataclass
from rigtri.model.joint_names import Side
from rigtri.recognition.bend_direction import facing_along
from rigtri.recognition.finger_bends import Curl, curl_of, lone_bends_count, mean_of_pair, shown_by_all
from rigtri.recognition.hands_feet import BY_PLACE
from rigtri.recognition.layout import Chain
from rigtri.recognition.thumb_bends import (
    ALIKE,
    BENT,
    NOISE,
    OPENS,
    SHAPE,
    ThumbBend,
    noise_of_twins,
    own_hinges_count,
)

# Fingers that bend by more than this at rest (radians) say themselves about which axis they close.
CURLED = radians_below(20)
# … and so does one finger without a thumb that bends by more than this: nothing else shows where its palm is.
LONE_CURLED = radians_below(10)
# Fingers whose first bones are folded over the palm by more than this (radians); no finger bends so far back.
FOLDED, BENT_BACK = radians_below(45), radians_below(35)
# Of fingers whose own hinges agree to this part the common one counts.
AGREEMENT = 0.7
# No finger bends more than 60° aside of the line of the knuckles (a cosine): what looks so is noise.
ASIDE = cosine_below(60)
# A thumb points by more than this to the side of the fingers (a cosine).
THUMB_APART = cosine_below(20)
# From the root of the one finger of a hand to the other side of the palm, as a part of its length.
HALF_AS_WIDE = 0.5
# … and at rest by this to the side of the palm (cosine and sine of 29°), amid the 0° to 58° of real
# hands.
INTO_PALM = 0.8746197071393957, 0.48480962024633706
# So far beyond a right angle (a cosine) is what points the other way: a square hand is no matter of rounding.
BEYOND_SQUARE = 1e-4
# How much the palm of a hanging hand, which is at the thigh, is turned back (a sine): squarely turned hands
# close back, and those that are raised ahead, down.
TURNED_BACK = 0.01
# Fingers that begin nearer to each other than this part of the lower arm begin at one place, as those of the
# mocap of CMU do: noise says nothing of the palm.
_NO_WIDTH = 1e-4
# The rule of hands that show neither a thumb nor a bend: which way their fingers close is a guess.
AS_HANDS_HANG = "palm of a hand hanging at the side"
# The rule of hands with neither a second finger nor a bend: that of the arm, as it swings. Where the lower
# arm is raised ahead by more than this (a cosine) it is a guess: it may be turned about itself there.
AS_ARMS_SWING, AS_ARMS_SWING_AHEAD = "arm, for hands hanging at the sides", "arm, for hands raised ahead"
RAISED_AHEAD = cosine_below(45)
# … and one with a bent elbow, which is no guess.
AS_ELBOWS_BEND = "arm, turned as its elbow bends"
# … and on a body with a tail, whose hands may be front paws, which close as feet do.
AS_PAWS_SWING = "arm, for hands or paws hanging at the sides"
# The rule of one straight finger beside a bent thumb, which may be bent at its base as well, or there alone.
BESIDE_BENT_THUMB = "palm of the hand by a bent thumb"
# An elbow that bends by more than this (radians) shows how the arm is turned: without a turn of the lower arm
# the palm is on the side of the elbow's hinge, as at the thigh.
ELBOW_BENT = radians_below(30)
# The rule of thumbs whose bend, which is more than none, may be their joints' noise or the shape of the hand.
NOT_ITS_BEND = "palm of the hand, not the thumb's own bend"
FOUR = ("index", "middle", "ring", "little")


class Hinge(NamedTuple):
    """What a body says of a joint: the rule, and a direction of the world, (3,), not yet square to the bone.

    ahead: the direction is where the bone's end moves as the joint flexes, else it is the hinge.
    """

    rule: str
    direction: Floats
    ahead: bool = False

    def of(self, bone: Floats) -> Floats:
        """The hinge of a bone, unit, (3,) each; NaN where the bone runs along the direction."""
        across = cross(bone, self.direction) if self.ahead else perpendicular(self.direction, bone)
        return normalise(across)


def hand_hinges(
    chains: Sequence[Chain],
    sides: Mapping[Side, bool | None],
    at: Floats,
    body: tuple[Floats, Floats, Floats] | None,
) -> Iterator[tuple[int, Hinge]]:
    """The hinge that the fingers of each hand and its wrist share, and the thumb's own, of all hands.

    sides: of the hands, and whether each is a left one, None where nobody knows. at: the places of all
    nodes, (n, 3). body: where it faces, its up, and the front of its chest, which may be bent down, (3,)
    each; None for a hand alone.
    """
    hands = {side: _by_hand(chains, side) for side in sides}
    has_tail = any(chain.kind == "tail" for chain in chains)
    for number in range(max(map(len, hands.values()), default=0)):
        pair = ((sides[side], own[number]) for side, own in hands.items() if number < len(own))
        found = (_posed_hand(own, is_left, at, body, has_tail) for is_left, own in pair)
        yield from _pair_hinges([hand for hand in found if hand is not None])


def with_palms(
    parents: Integers, chains: Sequence[Chain], hinges: Mapping[int, Hinge]
) -> Iterator[tuple[int, Hinge]]:
    """The hinges of hands, and those of the bones of the palm that hold several fingers: the hand's.

    As Rigify's first palm holds thumb and index finger, and a cup ring and little finger. parents: of all
    nodes, (n,).
    """
    taken = {joint for chain in chains for joint in chain.joints}
    wrists = {chain.joints[0] for chain in chains if chain.kind == "hand"}
    for finger in (k for k in chains if k.kind == "finger" and "thumb" not in k.name):
        above = [int(parents[finger.joints[0]])]
        while above[-1] >= 0 and above[-1] not in wrists:
            above.append(int(parents[above[-1]]))
        if above[-1] in hinges:
            yield from ((joint, hinges[above[-1]]) for joint in above[:-1] if joint not in taken)
    yield from hinges.items()


def _by_hand(chains: Sequence[Chain], side: Side) -> list[list[Chain]]:
    """The chains of each hand of a side, with its arm and the fingers that follow it, in order."""
    own = [k for k in chains if k.kind in ("finger", "hand", "arm") and k.side == side]
    hands = [k for k in own if k.kind == "hand"]
    if len(hands) < 2:
        return [own]
    found = [[k for k in own if k.kind == "arm" and k.bend[2:] == hand.joints[:1]] for hand in hands]
    number = -1
    for chain in own:
        number += chain.kind == "hand"
        if chain.kind != "arm" and number >= 0:
            found[number].append(chain)
    return found


def _pair_hinges(hands: Sequence[_PosedHand]) -> Iterator[tuple[int, Hinge]]:
    """As `hand_hinges`, of the two hands of a pair, or of one."""
    curls, noise = mean_of_pair([hand.curl for hand in hands]), _noise(hands)
    asides = [hand.aside(curl) for hand, curl in zip(hands, curls, strict=True)]
    shown = lone_bends_count(curls, asides, noise)
    palms = [hand.palm(curl, is_own=is_own) for hand, curl, is_own in zip(hands, curls, shown, strict=True)]
    closing = [(hand, palm) for hand, palm in zip(hands, palms, strict=True) if palm is not None]
    thumbs = [hand.thumb_bend(palm.direction) for hand, palm in closing]
    own = own_hinges_count(thumbs, noise)
    for (hand, palm), thumb, is_own in zip(closing, thumbs, own, strict=True):
        # A further finger closes with the others, whichever it is.
        for joint in hand.joints:
            yield joint, palm
        if hand.thumb:
            hinge = hand.thumb_hinge(palm.direction, thumb, is_own=is_own)
            for joint in hand.thumb:
                yield joint, hinge


def _noise(hands: Sequence[_PosedHand]) -> float:
    """The noise of the places of joints in the hands of a pair, or in one, file units."""
    least = NOISE * max((float(length(hand.arm)) for hand in hands), default=0.0)
    if len(hands) < 2:
        return least
    lines = ([hand.thumb, *hand.fingers] for hand in hands)
    pairs = [pair for pair in zip(*lines, strict=False) if len(pair[0]) == len(pair[1])]
    one, other = ([hand.bones(pair[k]) for pair in pairs] for k, hand in enumerate(hands))
    return max(
        least, noise_of_twins([k for bones in one for k in bones], [k for bones in other for k in bones])
    )


def _posed_hand(
    own: Sequence[Chain],
    is_left: bool | None,
    at: Floats,
    body: tuple[Floats, Floats, Floats] | None,
    has_tail: bool,
) -> _PosedHand | None:
    fingers = [k for k in own if k.kind == "finger"]
    thumb = next((k.joints for k in fingers if "thumb" in k.name), ())
    # From the index finger to the little one, in whatever order the file has them.
    four = list({name: k for name in FOUR for k in fingers if name in k.name}.values())
    four = four or [k for k in fingers if k.joints != thumb]
    wrist = next((k.joints for k in own if k.kind == "hand"), ())
    arm = next((k.bend for k in own if k.kind == "arm" and len(k.bend) == 3), wrist[:1])
    if not fingers and len(wrist) < 2:
        return None
    lower = at[wrist[0]] - at[arm[-2:][0]]
    natural, swings = None, AS_ARMS_SWING
    if body is not None and is_left is not None:
        natural = facing_along(lower, *body[:2]) * (-1.0 if is_left else 1.0)
        if len(arm) == 3 and float(bend_angle(*at[list(arm)])) > ELBOW_BENT:
            inside = cross(at[arm[1]] - at[arm[0]], lower) * (1.0 if is_left else -1.0)
            natural, swings = normalise(cross(lower, inside)), AS_ELBOWS_BEND
    lines = [k.joints for k in four] or [wrist[1:]] * (len(wrist) > 1)
    joints = (*wrist, *(joint for finger in fingers for joint in finger.joints))
    guessed = all(k.evidence[0] == BY_PLACE for k in four)
    swings = AS_PAWS_SWING if has_tail and lines else swings
    if body is not None and lines:
        facing, _, chest = body
        ahead = max(float(dot(normalise(lower), way)) for way in (facing, chest))
        swings = AS_ARMS_SWING_AHEAD if ahead > RAISED_AHEAD else swings
    return _PosedHand(joints, lines, thumb, wrist[0], lower, at, natural, is_left, guessed, swings)


@dataclass(frozen=True, eq=False)
class _PosedHand:
    """A hand in a pose. fingers: from the index finger on, without the thumb. arm: of the lower arm, (3,).

    at: the places of all nodes, (n, 3). natural: about which hands close that hang, palms at the thighs, or
    are raised from there, unit, (3,). guessed: which finger is the first is known by place alone. swings:
    the rule where the arm alone says how the hand closes.
    """

    joints: Sequence[int]
    fingers: Sequence[Sequence[int]]
    thumb: Sequence[int]
    wrist: int
    arm: Floats
    at: Floats
    natural: Floats | None
    is_left: bool | None
    guessed: bool
    swings: str = AS_ARMS_SWING

    def line(self, finger: Sequence[int]) -> Floats:
        """Where a finger points, unit, (3,); one of a single joint as the hand does there."""
        start = finger[0] if len(finger) > 1 else self.wrist
        return normalise(self.at[finger[-1]] - self.at[start])

    @property
    def along(self) -> Floats:
        """Where the fingers point together, unit, (3,); without any as the lower arm does."""
        lines = [self.line(finger) for finger in self.fingers]
        return normalise(np.nan_to_num(lines).cumsum(axis=0)[-1]) if lines else normalise(self.arm)

    def palm(self, curl: Curl, *, is_own: bool) -> Hinge | None:
        """About which axis the hand closes; None where nothing shows it.

        is_own: the bend of one finger alone is no noise.
        """
        across, natural = self._across, self.natural
        known = across is not None and self.is_left is not None and (self._is_apart or not self.guessed)
        lone = len(self.fingers) < 2
        # One finger that bends clearly knows better than a thumb, which may be bent over the palm.
        aside = known and not lone and abs(self.curl.closes) < ASIDE
        clear = LONE_CURLED if across is None else CURLED
        if curl.bend > clear and (is_own or not lone) and curl.agreement > AGREEMENT and not aside:
            # Knuckles may be bent back more than fingers are bent, and a hand closes all the same.
            turned = known and not self.guessed and curl.closes < (-ASIDE if lone else -BEYOND_SQUARE)
            turned = turned and not (lone and curl.bend > BENT_BACK)
            return Hinge("plane of the bent fingers", -curl.hinge if turned else curl.hinge)
        if across is None:
            return None if natural is None else Hinge(self.swings, natural)
        rule = BESIDE_BENT_THUMB if lone and self._thumb_bends > BENT else "palm of the hand"
        if not known:
            shown = shown_by_all(self.fingers, self.at)
            if shown is not None:
                towards = float(dot(shown, across))
            elif natural is not None:
                back = cross(-natural if self.is_left else natural, normalise(self.arm))
                rule, towards = AS_HANDS_HANG, float(dot(natural + TURNED_BACK * back, across))
            else:
                towards = self._side_of_thumb(across)
            across = -across if towards < -BEYOND_SQUARE else across
        return Hinge(rule, across)

    def aside(self, curl: Curl) -> float | None:
        """By how much a bend turns off how the arm says that the hand closes, radians, mirrored on the right.

        None beside a thumb, or where the arm says nothing.
        """
        if self.natural is None or self._across is not None:
            return None
        off = arc_tangent(dot(cross(self.natural, curl.hinge), self.along), dot(self.natural, curl.hinge))
        return -float(off) if self.is_left is False else float(off)

    def _side_of_thumb(self, across: Floats) -> float:
        """Whether ``across`` closes the hand of a body that nobody knows, positive."""
        if len(self.thumb) < 2 or not self.fingers:
            return 1.0
        # The thumb stands on the side to which the fingers close.
        aside = self.at[self.thumb[-1]] - self.at[self.fingers[0][0]]
        return float(dot(aside, cross(across, self.along)))

    @cached_property
    def _across(self) -> Floats | None:
        """The hinge by the order of the fingers, unit, (3,); None for one finger without a thumb, or none."""
        is_left = self.is_left is not False
        if len(self.fingers) > 1:
            across = self.at[self.fingers[-1][0]] - self.at[self.fingers[0][0]]
        elif self.fingers and self.thumb:  # as if the thumb were the first of two fingers
            (finger,) = self.fingers
            across = perpendicular(self.at[finger[0]] - self.at[self._thumb_aside], self.along)
            # At rest it stands ahead of the palm.
            inside = cross(across, self.along) * (1.0 if is_left else -1.0)
            across = across * INTO_PALM[0] + inside * INTO_PALM[1]
            across = self._by_bent_thumb(normalise(across if is_left else -across), across)
        else:
            return None
        if length(across) < _NO_WIDTH * length(self.arm):
            return None
        across = normalise(across)
        # Seen along the fingers of a left hand with its palm down, the little finger is to the left.
        return (across if is_left else -across) if np.isfinite(across).all() else None

    @cached_property
    def _thumb_bends(self) -> float:
        """By how much the first two bones of the thumb are bent, radians."""
        return float(bend_angle(*self.at[list(self.thumb[:3])])) if len(self.thumb) > 2 else 0.0

    @property
    def _thumb_aside(self) -> int:
        """The joint that shows where the thumb stands: its last, or its second if it is bent."""
        return self.thumb[1 if self._thumb_bends > BENT else -1]

    def _by_bent_thumb(self, palm: Floats, across: Floats) -> Floats:
        """The line of the knuckles, (3,), of a hand with one finger; ``across`` where its thumb is straight.

        The palm is on the side midway between where a thumb stands and where it moves as it flexes. It may
        be as bent at its base as beyond, or not at all: half of that is between the two.
        """
        bend = self.thumb_bend(palm)
        if not (bend.bend > SHAPE and abs(bend.aside) < OPENS):
            return across
        first = normalise(self.at[self.thumb[1]] - self.at[self.thumb[0]])
        line = rotate(from_axis_angle(bend.hinge, -0.5 * bend.bend), first)
        ahead = normalise(self.at[self.fingers[0][0]] - self.at[self.wrist])
        inside = normalise(perpendicular(line, ahead)) + normalise(
            perpendicular(cross(bend.hinge, line), ahead)
        )
        found = normalise(cross(ahead, inside)) * (-1.0 if self.is_left is False else 1.0)
        return found if np.isfinite(found).all() else across

    @property
    def _is_apart(self) -> bool:
        """Whether the thumb points elsewhere than the fingers do, so that it surely is one."""
        return len(self.thumb) > 1 and float(dot(self.line(self.thumb), self.along)) < THUMB_APART

    @cached_property
    def curl(self) -> Curl:
        """What the bends of the fingers show."""
        return curl_of(self.fingers, self.wrist, self.at, self._across)

    def bones(self, finger: Sequence[int]) -> list[float]:
        """The lengths of the bones from the wrist to the end of a finger, file units."""
        places = self.at[[self.wrist, *finger]]
        return [float(bone) for bone in length(places[1:] - places[:-1])]

    def thumb_bend(self, palm: Floats) -> ThumbBend:
        """What the thumb shows of a hand that closes about ``palm``, (3,)."""
        if len(self.thumb) < 3:
            return ThumbBend(np.full(3, np.nan), 0.0, 0.0, 0.0)
        a, b, c = (self.at[joint] for joint in self.thumb[:3])
        across, closing = cross(b - a, c - b), self._over_palm(palm)
        own, line = normalise(across), normalise(c - a)
        aside = float(arc_tangent(dot(cross(closing, own), line), dot(closing, own)))
        height = float(length(across) / length(c - a))
        return ThumbBend(own, float(bend_angle(a, b, c)), height, -aside if self.is_left is False else aside)

    def thumb_hinge(self, palm: Floats, bend: ThumbBend, *, is_own: bool) -> Hinge:
        """A thumb closes over the palm: by its own bend, else towards the root of the little finger."""
        if is_own:
            return Hinge("plane of the thumb", bend.hinge)
        closing = self._over_palm(palm)
        if not np.isfinite(closing).all():
            return Hinge("palm of the hand", palm)
        if not (bend.bend > BENT and ALIKE < abs(bend.aside) < OPENS):
            return Hinge("palm of the hand", closing)
        bent, aside = np.degrees([bend.bend, abs(bend.aside)])
        return Hinge(f"{NOT_ITS_BEND} of {bent:.0f}°, {aside:.0f}° aside", closing)

    def _over_palm(self, palm: Floats) -> Floats:
        """The hinge of a thumb that closes towards the root of the little finger, unit, (3,)."""
        at, thumb = self.at, self.thumb
        towards = at[self.fingers[-1][0]] - at[thumb[0]] if self.fingers else self.arm
        along = [finger[:2] for finger in self.fingers if len(finger) > 1]
        ahead = normalise(at[along[0][1]] - at[along[0][0]]) if along else normalise(towards)
        over = at[self.fingers[0][0]] - at[self.wrist] if along else ahead
        ahead = ahead if float(angle(over, ahead)) < FOLDED else normalise(over)  # of a fist, the palm's
        inside = cross(palm, ahead)  # where finger tips move as they close
        line = self.line(thumb)
        if len(self.fingers) == 1 and self.is_left is not None:  # the little finger would be further
            width = HALF_AS_WIDE * length(at[self.fingers[0][0]] - at[self.wrist])
            towards = towards + palm * width * (1.0 if self.is_left else -1.0)
        if len(self.fingers) == 1 and self._thumb_aside != thumb[-1]:
            line = normalise(at[thumb[1]] - at[thumb[0]])  # its tip may be beyond the finger
        return normalise(cross(line, normalise(towards) + inside))
