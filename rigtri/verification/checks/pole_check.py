"""Pole vectors that stand where a limb does not bend."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress

import numpy as np

from rigtri.errors import NameNotFoundError
from rigtri.maths.triangle import bend_sine
from rigtri.maths.vectors import angle, length, normalise, perpendicular
from rigtri.model.limb import Limb
from rigtri.model.metadata import PoleVectorRecord
from rigtri.model.rig import Rig
from rigtri.operations.add_polevector import posed
from rigtri.recognition.bend_direction import CLEAR
from rigtri.recognition.body_hinges import bodies
from rigtri.recognition.layout import Character
from rigtri.recognition.limb_bends import LimbBends
from rigtri.report import Report
from rigtri.text import identifier

# Degrees from the side to which a limb bends, from which on its pole vector is elsewhere.
POLE = 60.0


def pole_findings(rig: Rig, character: Character, known: list[Limb]) -> Iterator[tuple[str, int, str]]:
    """Pole vectors that would bend a nearly straight limb against its nature, at rest."""
    joints = {part.joint for part in character.parts}
    limbs = [limb for limb in known if limb.start in joints]
    poles = _of_all_limbs(rig, limbs)
    body = bodies(rig, [character], rig.world, None) if any(poles) else []
    if not body:
        return
    ref = posed(rig, "nodes")
    bends = LimbBends(rig, ref.world, ref.other, limbs, body)
    for limb, its in zip(limbs, poles, strict=True):
        a, b, c = ref.world[list(limb.triple), 3, :3]
        found = bends.of(limb, Report()) if its else None
        if found is None or float(bend_sine(a, b, c)) >= CLEAR:
            continue
        for pole in its:
            side = perpendicular(ref.position(pole) - b, normalise(c - a))
            off = float(np.degrees(angle(side, found.direction)))
            if length(side) > 0.1 * length(c - a) and off > POLE:
                where = "behind the elbow" if limb.bends_back else "ahead of the knee"
                where = where if found.source == "facing" else "to which it bends at"
                text = f"the pole vector of the nearly straight {limb.side} {limb.kind} is {off:.0f}° off"
                yield "axes.pole", pole, f"{text} the side {where} '{rig.title(limb.middle)}'"


def _of_all_limbs(rig: Rig, limbs: Sequence[Limb]) -> list[list[int]]:
    """The pole vectors of each limb: by what rigtri has stored, and by name."""
    stored: dict[tuple[int, ...], list[int]] = {}
    for node, record in rig.records(PoleVectorRecord).items():
        if record.source != "given":
            with suppress(NameNotFoundError):
                stored.setdefault(tuple(rig.find(name) for name in record.chain), []).append(node)
    wanted: dict[str, list[int]] = {}
    for number, limb in enumerate(limbs):
        if name := rig.names[limb.middle]:
            for called in {f"{name}_pole", identifier(name) + "_pole"}:
                wanted.setdefault(called, []).append(number)
    found = [list(stored.get(limb.triple, ())) for limb in limbs]
    for node, known in enumerate(rig.names):
        if known in wanted and rig.type_of(node) != PoleVectorRecord.type:
            for number in wanted[known]:
                found[number].append(node)
    return found
