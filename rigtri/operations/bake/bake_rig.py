"""bake --rig: a file that another program has edited, with what it has lost of the rig that it came from."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

from rigtri.model.characters import characters
from rigtri.model.rig import Rig
from rigtri.operations.options.bake import BakeOptions
from rigtri.operations.rigtri_nodes import readdressed
from rigtri.operations.take_clips.exact_scales import with_exact_scales
from rigtri.operations.take_clips.ik_switches import ik_ends, switches
from rigtri.operations.take_clips.messages import warn_shown_otherwise
from rigtri.operations.take_clips.node_matching import pairs
from rigtri.operations.take_clips.rejoin_clips import joined
from rigtri.operations.take_clips.restore_metadata import as_described
from rigtri.recognition.one_character import alone, of_character
from rigtri.report import Report
from rigtri.text import unnumbered


def with_rig(rig: Rig, rigged: Rig, options: BakeOptions, report: Report) -> Rig:
    """The edited rig with the metadata of RIG, and in unedited clips RIG's keys between frames."""
    names = rig.names
    if options.character is not None:
        rigged = _same_character(rig, rigged, options.character)
        rig = _as_in_asset(of_character(rig, options.character), rigged, options.character)
    if rig.rules.raw_quaternions:  # USD, where Blender leaves out scale keys
        of = pairs(rigged, rig).of
        ends = {of[node]: of[node] for node in ik_ends(rigged) if node in of}
        rig = with_exact_scales(rig, rigged, of, drives=switches(rig, ends).drives)
    shown, rig = rig, joined(rig, rigged, names=options.as_, between=options.between, report=report)
    seen = as_described(rig, rigged, report=report)
    if options.to == "joints":
        # Before RIG's keys between frames came back, all keys are where Blender has shown the rig.
        warn_shown_otherwise(as_described(shown, rigged, report=Report()), report)
    rig = replace(seen, names=(*names, *seen.names[len(names) :]))
    # A name that other characters have, too, means one of them only by its path.
    return readdressed(seen, rig, range(len(rig))) if options.character is not None else rig


def _as_in_asset(rig: Rig, rigged: Rig, name: str) -> Rig:
    """The rig with names that RIG has once for what is at or below a node alone.

    Blender numbers what a second character of an asset has, ``hand_ctl_001``; the first has RIG's names.
    """
    inside, counts = rig.below(rig.find(name, "character")), Counter(rigged.names)
    names, known = list(rig.names), {rig.names[node] for node in inside}
    for node in inside:
        plain = unnumbered(names[node])
        if names[node] not in counts and counts[plain] == 1 and plain not in known:
            names[node] = plain
    mine = {names[node] for node in inside} - known
    held = {*inside}
    return replace(rig, names=tuple("" if n in mine and k not in held else n for k, n in enumerate(names)))


def _same_character(rig: Rig, rigged: Rig, name: str) -> Rig:
    """RIG as an edit sees that of its characters that has this name in the edited rig."""
    mine = set(rig.below(rig.find(name, "character")))
    of = pairs(rigged, rig).of
    same = [nodes for nodes in characters(rigged) if any(of.get(node) in mine for node in nodes)]
    return alone(rigged, frozenset[int]().union(*same)) if same else rigged
