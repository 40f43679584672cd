"""Whether the body stands in EDITED's clips as it does in RIG's.

Bind poses and rests say which way is up in EDITED. Where it rests in a frame of a clip, or its armature was
turned, they do not agree, and a file with z up in a format with y up looks like one that a DCC has bound in
a space of its own. Then the clips decide: both files have them.

Source: docs/take-clips.md.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rigtri.errors import GeometryError
from rigtri.evaluation.sampling import locals_at, sorted_unique, thinned, worlds
from rigtri.maths.matrices import from_frame, inverse, multiply, nearest_rotation, transform_directions
from rigtri.maths.trigonometry import Floats
from rigtri.maths.vectors import angle, length
from rigtri.operations.take_clips.axis_mapping import Counterparts
from rigtri.operations.take_clips.bind_space import world_turns
from rigtri.operations.take_clips.clip_matching import Taken
from rigtri.operations.take_clips.generated_names import span
from rigtri.recognition.limbs import upright
from rigtri.report import Report
from rigtri.text import list_names

# Degrees between the up of the body in both files: beyond half a right angle another axis is nearer.
_LIES = 45.0
# Of a clip: the mean of all joints at so many times says how the body stands.
_LOOKS = 8
_REMEDY = "if that is not intended, export EDITED with the up axis of its format (glTF: +Y up)"


def stood_up(both: Counterparts, every: Sequence[Taken], report: Report) -> Counterparts:
    """``both``, or with EDITED's world turned by 90° about x where all clips of both files stand only so.

    A warning where a clip lies though nothing else shows that the file does. Raises GeometryError where the
    file lies, but no such turn sets its clips upright, unless both rest in one standard pose.
    """
    carriers = _carriers(both)
    moving = [
        taken for taken in every if any(t.node in carriers and t.path != "weights" for t in taken.clip.tracks)
    ]
    lying = [taken for taken in moving if _lies(both, taken)]
    if not lying:
        return both
    known = [taken for taken in moving if taken.home is not None] or moving
    names = list_names(taken.name for taken in lying)
    notice = "lies", f"In {names} of EDITED the body lies, compared with RIG; {_REMEDY}"
    if any(taken not in lying for taken in known) or not _may_lie(both, known):
        report.warn(*notice)
        return both
    # One standard pose that lies in EDITED is upright as RIG's.
    turns = [] if both.at_rest is None else [both.at_rest]
    for sign in (-1.0, 1.0):
        about_x = from_frame([[1.0, 0.0, 0.0], [0.0, 0.0, sign], [0.0, -sign, 0.0]], np.zeros(3))
        upright = multiply(from_frame(nearest_rotation(both.space), np.zeros(3)), about_x)
        turns.append(np.asarray(upright)[:3, :3])
    for turn in turns:
        stood = Counterparts(both.rig, both.other, turn, both.at_rest)
        if not any(_lies(stood, taken) for taken in known):
            return stood
    if both.at_rest is not None:
        report.warn(*notice)  # its limbs point as they should, whatever its format says is up
        return both
    raise GeometryError(
        f"The body lies in {names} of EDITED, and so does the whole file, but no rotation by 90° about x "
        "sets all of these clips upright as in RIG. Export EDITED with the up axis of its format (glTF: "
        "+Y up)"
    )


def _may_lie(both: Counterparts, known: Sequence[Taken]) -> bool:
    """Whether EDITED's bind poses lie, or, without any and of clips that RIG has, its rest.

    A new clip may lie, and its file rest in a frame of it. A hand lays down one clip of RIG, a file all.
    """
    if len(known) > 1 and known[0].home is not None:
        return True
    if both.bind_turn is None:
        leans = _leans(both, both.other.world[np.newaxis], both.rig.world[np.newaxis])
        return known[0].home is not None and leans
    return not any(both.stands(turn) for turn in world_turns(both.rig, both.other, both.bind_turn))


def _carriers(both: Counterparts) -> set[int]:
    """The topmost joints of EDITED, and what carries them."""
    rig = both.rig
    under = rig.under(np.flatnonzero(rig.is_joint).tolist())
    tops = [n for n in both.of if rig.is_joint[n] and not under[n]]
    return {k for n in tops for k in both.other.path_to_root(both.of[n])}


def _lies(both: Counterparts, taken: Taken) -> bool:
    """Whether up is elsewhere for the body in EDITED's clip than in RIG's, or in its rest for a new clip."""
    times = thinned(sorted_unique(np.concatenate([track.times for track in taken.clip.tracks])), _LOOKS)
    theirs = worlds(both.other, locals_at(both.other, taken.clip, times))
    if taken.home is None:
        return _leans(both, theirs, both.rig.world[np.newaxis])
    lasts = float(times[-1] - times[0])
    start, end = span(taken.home.clip)
    ours = start + (times - times[0]) * ((end - start) / lasts if lasts > 0 else 0.0)
    return _leans(both, theirs, worlds(both.rig, locals_at(both.rig, taken.home.clip, ours)))


def _leans(both: Counterparts, theirs: Floats, ours: Floats) -> bool:
    """Whether the rotation between two motions, (f, n, 4, 4), that suits all joints best tilts up far."""
    joints = [n for n in both.of if both.rig.is_joint[n]]
    seen = multiply([both.turns[n] for n in joints], theirs[:, [both.of[n] for n in joints]])
    fits = multiply(inverse(_axes(multiply(seen, both.space))), _axes(ours[:, joints]))
    fits = fits[..., :3, :3].reshape(-1, 3, 3)
    fits = fits[np.isfinite(fits).all(axis=(1, 2))]
    if not len(fits):
        return False
    turn = nearest_rotation(from_frame(fits.cumsum(axis=0)[-1], np.zeros(3)))
    up = upright(both.rig)[np.newaxis]
    return bool(np.degrees(angle(up, transform_directions(up, from_frame(turn, np.zeros(3)))))[0] > _LIES)


def _axes(matrices: Floats) -> Floats:
    """Matrices with unit axes at the origin, (..., 4, 4)."""
    axes = matrices[..., :3, :3]
    with np.errstate(divide="ignore", invalid="ignore"):
        return from_frame(axes / length(axes)[..., np.newaxis], np.zeros(3))
