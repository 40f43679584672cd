"""snap: FK controls take over from IK at a frame, or IK from FK, and the joints stay where they are.

A limb is solved by IK in a clip where its IK end or pole has keys (docs/evaluation.md). So IK's keys go
where FK takes over, and the keys of the limb's FK controls where IK does.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from rigtri.errors import FileError, GeometryError, UsageError
from rigtri.following import Parts
from rigtri.ops.posing import at_rest
from rigtri.pose import sample
from rigtri.records import Clip, Interpolation, Path, Track
from rigtri.report import Report
from rigtri.rig import Rig
from rigtri.solve.at_work import NOTHING, keyed_in, moved_at_rest, size_of
from rigtri.solve.evaluate import Solver
from rigtri.solve.fk import Fk
from rigtri.solve.ik import Ik
from rigtri.solve.match import Matched, match_limb
from rigtri.solve.posed import Posed, sampled
from rigtri.solve.reference import Reference
from rigtri.timelines import Timeline, moment, single
from rigtri.trigonometry import Floats
from rigtri.vectors import length

_PATHS: tuple[Path, ...] = ("translation", "rotation", "scale")
# Joints that move by more, as a share of the size, are told.
NEAR = 1e-5


@dataclass(frozen=True)
class Options:
    """to: what takes over. at: moments, ``CLIP@TIME`` or ``rest``. limbs: root, middle and end joint of
    each, by name; all with an IK end where there is none.
    """

    to: Literal["ik", "fk"]
    at: tuple[str, ...]
    limbs: tuple[tuple[str, str, str], ...] = ()

    def checked(self) -> Options:
        """These options. UsageError for what cannot be."""
        if self.to not in ("ik", "fk"):
            raise UsageError(f"--to {self.to}: choose of ik, fk")
        if not self.at:
            raise UsageError("say when: --at CLIP@TIME, or --at rest")
        return self


def snap(rig: Rig, *, options: Options, report: Report | None = None) -> Rig:
    """Give IK ends and poles, or FK controls, the values with which joints stand as they do at some moments.

    What was done to each limb goes to ``report.added``, with how far its joints have moved. Raises
    UsageError, NameNotFoundError, GeometryError (no such limb, no FK controls), FileError (splines).
    """
    options, report = options.checked(), report if report is not None else Report()
    chains = _chains(rig, options)
    moments: dict[tuple[int, ...], list[tuple[str, float]]] = {}
    for text in options.at:
        timeline, time = moment(rig, text)
        moments.setdefault(timeline.members if timeline else (), []).append((text, time))
    for together in moments.values():
        at = single(np.unique([time for _, time in together]))
        for chain in chains:
            timeline, _ = moment(rig, together[0][0])
            rig = _Limb(rig, chain, timeline, at, options.to, report).snapped()
    return rig


def _chains(rig: Rig, options: Options) -> list[tuple[int, int, int]]:
    """The limbs, as nodes. GeometryError for one without an IK end."""
    known = [limb.chain for limb in Reference(rig).limbs]
    chains = [(rig.find(a), rig.find(b), rig.find(c)) for a, b, c in options.limbs] or known
    for chain in chains:
        if chain not in known:
            told = ", ".join(f"'{rig.title(node)}'" for node in chain)
            raise GeometryError(f"The limb {told} has no IK end; make one with: rigtri add-controls --ik")
    if not chains:
        raise GeometryError(
            "No limb here has an IK end; make some with: rigtri add-controls --whole-character"
        )
    return chains


@dataclass(frozen=True, eq=False)
class _Limb:
    """One limb at some times of a timeline, or at rest where there is none."""

    rig: Rig
    chain: tuple[int, int, int]
    timeline: Timeline | None
    times: Floats
    to: Literal["ik", "fk"]
    report: Report

    def snapped(self) -> Rig:
        before = self._posed(self.rig)
        ik = self._ik()
        ends = [node for node in (ik.limb.control, ik.limb.pole) if node >= 0]
        was_ik = bool(self._at_work(self.rig).intersection(ends))
        channels = self._to_ik(ik, before) if self.to == "ik" else self._to_fk(ik, before)
        below = [fk.own.control for fk in ik.fk.values()]
        gone = [] if was_ik == (self.to == "ik") else (ends if self.to == "fk" else below)
        fresh = below if self.to == "fk" and was_ik else []
        if self.timeline is None:
            if self.to == "fk" and was_ik:
                zero = Parts(np.zeros((1, 3)), np.array([[0.0, 0.0, 0.0, 1.0]]), np.ones((1, 3)))
                channels[ik.limb.control] = zero
            rig, _ = at_rest(self.rig, channels, np.full(len(self.rig), 0.1 * NOTHING * size_of(self.rig)))
        else:
            rig = self._keyed(channels, {*gone, *fresh})
        self._record(rig, before)
        return rig

    def _at_work(self, rig: Rig) -> frozenset[int]:
        timeline = self._now(rig)
        return keyed_in(rig, timeline) if timeline else moved_at_rest(rig, size_of(rig))

    def _now(self, rig: Rig) -> Timeline | None:
        """The timeline, with the tracks that a later state of the rig has in it."""
        if self.timeline is None:
            return None
        tracks = {(t.node, t.path): t for k in self.timeline.members for t in rig.clips[k].played.tracks}
        return replace(self.timeline, clip=Clip(self.timeline.clip.name, tuple(tracks.values())))

    def _sampled(self, rig: Rig) -> dict[int, Parts]:
        timeline = self._now(rig)
        return sampled(rig, timeline.clip, self.times) if timeline else {}

    def _posed(self, rig: Rig) -> Posed:
        return Solver(rig, self._at_work(rig)).run(self._sampled(rig))

    def _ik(self) -> Ik:
        reference = Reference(self.rig)
        limb = next(limb for limb in reference.limbs if limb.chain == self.chain)
        solver = Solver(self.rig, {limb.control})
        return next(ik for ik in solver.limbs if ik.limb.chain == self.chain)

    def _to_ik(self, ik: Ik, before: Posed) -> dict[int, Parts]:
        found = Matched(Posed(self.rig, before.parts))
        match_limb(found, ik, before, Solver(self.rig, ()).rules, lambda node, parts: _single(parts))
        return dict(found.controls)

    def _to_fk(self, ik: Ik, before: Posed) -> dict[int, Parts]:
        missing = [node for node in self.chain if node not in ik.fk]
        if missing:
            raise GeometryError(
                f"'{self.rig.title(missing[0])}' has no FK control; make one with: rigtri add-controls"
            )
        built, found = Posed(self.rig, before.parts), {}
        nodes = [node for node in (self.chain[0], *ik.paths[0], *ik.paths[1]) if node in ik.reference.fk]
        for node in nodes:
            fk = Fk(ik.reference, ik.reference.fk[node])
            found[fk.own.control] = _single(fk.channels(built, before.part(node)))
        return found

    def _keyed(self, channels: Mapping[int, Parts], replaced: Collection[int]) -> Rig:
        """The rig with keys at the times. replaced: nodes whose other keys go."""
        assert self.timeline is not None
        clips = list(self.rig.clips)
        still = Posed(self.rig)
        wanted = {
            (node, path): values
            for node, parts in channels.items()
            for path, values in zip(_PATHS, parts, strict=True)
        }
        for k in self.timeline.members:
            tracks = []
            # Of a track that goes, the self-check is to know that it was meant to.
            self.report.reposed |= any(t.node in replaced for t in clips[k].tracks)
            for track in clips[k].tracks:
                now = wanted.pop((track.node, track.path), None)
                if track.node in replaced:
                    if now is not None:
                        tracks.append(_only(track, self.times, now))
                else:
                    tracks.append(track if now is None else _with(self.rig, clips[k], track, self.times, now))
            clips[k] = replace(clips[k], tracks=tuple(tracks))
        home = self.timeline.members[0]
        for (node, path), values in wanted.items():
            rest = still.part(node)[_PATHS.index(path)]
            if np.abs(values - rest).max() > NOTHING or (path == "translation" and node not in replaced):
                track = _only(Track(node, path, "STEP", self.times, values), self.times, values)
                clips[home] = replace(clips[home], tracks=(*clips[home].tracks, track))
        return replace(self.rig, clips=tuple(clips))

    def _record(self, rig: Rig, before: Posed) -> None:
        after, far = self._posed(rig), 0.0
        for joint in np.flatnonzero(rig.is_joint).tolist():
            apart = length(after.world(joint)[:, 3, :3] - before.world(joint)[:, 3, :3])
            far = max(far, float(np.nan_to_num(apart).max()))
        far /= size_of(rig)
        name = rig.title(self.chain[2])
        if far > NEAR:
            self.report.warn(
                "snap-off", f"The limb that ends in '{name}' moves by {far:.2g} of the size", geometry=True
            )
        self.report.added.append(
            {
                "type": "snap",
                "limb": [rig.title(node) for node in self.chain],
                "to": self.to,
                "clip": self.timeline.name if self.timeline else None,
                "times": self.times.tolist() if self.timeline else [],
                "deviation": far,
            }
        )


def _single(parts: Parts) -> Parts:
    return Parts(*(single(each) for each in parts))


def _rows(values: Floats, count: int) -> Floats:
    return np.broadcast_to(values, (count, values.shape[-1])).copy()


def _only(track: Track, times: Floats, values: Floats) -> Track:
    """A track with keys at some times alone."""
    way: Interpolation = "LINEAR" if len(times) > 1 else "STEP"
    return replace(track, interpolation=way, times=times, values=_rows(values, len(times)))


def _with(rig: Rig, clip: Clip, track: Track, times: Floats, values: Floats) -> Track:
    """A track with more keys, or others at some times."""
    if track.interpolation == "CUBICSPLINE" and len(track.times) > 1:
        raise FileError(
            f"Clip '{clip.name}': the keys of '{rig.title(track.node)}' are splines (CUBICSPLINE), which "
            "cannot take other keys; store them as LINEAR first, e.g. with rigtri bake"
        )
    together = np.unique(np.concatenate([track.times, times]))
    rows = _rows(sample(track, together), len(together))
    rows[np.searchsorted(together, times)] = _rows(values, len(times))
    way = track.interpolation if len(track.times) > 1 else "LINEAR"
    return replace(track, interpolation=way, times=together, values=rows)
