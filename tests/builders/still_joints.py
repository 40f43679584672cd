"""Joints in the middle of chains that never move against their parents."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from rigtri.maths.matrices import compose, inverse, multiply
from rigtri.maths.quaternions import conjugate, from_axis_angle, rotate
from rigtri.maths.quaternions import multiply as product
from rigtri.model.animation import Track
from rigtri.model.rig import Rig

PLACE = np.array([0.02, -0.01, 0.03])
TURN = from_axis_angle(np.array([0.6, 0.0, 0.8]), 0.7)


def with_still_joints(rig: Rig, above: Mapping[str, str], size: float = 1.0) -> Rig:
    """The rig with joints between joints and their parents, which stand to these by PLACE, TURN and a size.

    above: the joints, each with the name of the new one. All moves as before.
    """
    for joint, name in above.items():
        child = rig.find(joint)
        grown = rig.insert_above({child: name})
        helper, child = child, child + 1
        parts = {path: getattr(grown, path).copy() for path in ("translation", "rotation", "scale", "matrix")}
        back = conjugate(TURN)
        parts["translation"][child] = rotate(back, parts["translation"][child] - PLACE) / size
        parts["rotation"][child] = product(back, parts["rotation"][child])
        parts["scale"][child] /= size
        parts["translation"][helper], parts["rotation"][helper], parts["scale"][helper] = PLACE, TURN, size
        local = compose(PLACE, TURN, np.full(3, size))
        parts["matrix"][helper] = local
        parts["matrix"][child] = multiply(parts["matrix"][child], inverse(local))

        def seen(track: Track, child: int = child) -> Track:
            if track.node != child:
                return track
            if track.path == "rotation":
                return track.having(product(conjugate(TURN), track.values))
            if track.path == "scale":
                return track.having(track.values / size)
            values = track.values.copy()
            (values[:, 1] if track.interpolation == "CUBICSPLINE" else values)[:] -= PLACE
            return track.having(rotate(conjugate(TURN), values) / size)

        skins = []
        for skin in grown.skins:
            row = np.flatnonzero(skin.joints == grown.parents[helper])
            if len(row) and child in skin.joints:
                bind = multiply(skin.inverse_bind[row], inverse(local))
                binds = np.concatenate([skin.inverse_bind, bind])
                skin = replace(skin, joints=np.append(skin.joints, helper), inverse_bind=binds, weigh=None)
            skins.append(skin)
        clips = tuple(replace(clip, tracks=tuple(map(seen, clip.tracks))) for clip in grown.clips)
        rig = replace(grown, clips=clips, skins=tuple(skins), **parts)
    return rig
