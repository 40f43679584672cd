"""How far two rigs are apart: laws, then numbers one can check by hand."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from characters import ARM, CAMERA, HAND, HIPS, NAMES, SPINE, SWORD, Held, character, many, stored, with_track
from morphs import arm
from numpy.testing import assert_allclose
from rigs import chain, random_rig, random_turns, rig_of

from rigtri.errors import FileError
from rigtri.evaluation.sampling import Motion, between_keys, locals_at, worlds
from rigtri.formats import read
from rigtri.frames.reframe import reframe
from rigtri.limits import TOLERANCE
from rigtri.maths.quaternions import from_axis_angle, multiply
from rigtri.maths.trigonometry import Floats
from rigtri.model.animation import Clip, Track
from rigtri.model.mesh import Mesh
from rigtri.model.rig import Rig
from rigtri.verification.compare.compare import DocumentView, Source, self_check, verify
from rigtri.verification.compare.deviation import joined
from rigtri.verification.compare.morph_changes import without_changes
from rigtri.verification.compare.probes import LinearMeshPoints, MeshPoints, SampledPoses, mesh_points
from rigtri.verification.compare.unit_rotations import denormalisation
from rigtri.verification.compare.verdict import Comparison

BOTH = pytest.mark.parametrize("compare", [self_check, verify])
Compare = Callable[[Source, Source], Comparison]


def turned(held: Held, seed: int = 1) -> Held:
    return replace(held, rig=reframe(held.rig, random_turns(seed, len(held.rig))))


def opened_again(held: Held) -> Held:
    """As after writing and reading: nodes that were new have keys and show something of their own."""
    rig, count = held.rig, len(held.rig)
    was = rig.attachment
    attachment = np.where(was >= 0, np.arange(count), -1)
    shows = {int(old): new for new, old in enumerate(was) if old >= 0}
    drawn = tuple(replace(mesh, node=shows.get(mesh.node, mesh.node)) for mesh in held.drawn)
    return Held(replace(rig, attachment=attachment, keys=tuple(range(count))), drawn)


def nudged(rig: Rig, node: int, by: float = 0.01) -> Rig:
    translation = rig.translation.copy()
    translation[node, 0] += by
    return replace(rig, translation=translation)


@BOTH
@pytest.mark.parametrize("seed", range(4))
def test_a_rig_is_nowhere_apart_from_itself(compare: Compare, seed: int) -> None:
    held = character(seed)
    result = compare(held, held)
    assert result.deviation == result.raw_deviation == 0
    assert result.passes(0.0)
    assert result.lost + result.added + result.changed == ()


@BOTH
@pytest.mark.parametrize("seed", range(8))
def test_new_axes_move_nothing(compare: Compare, seed: int) -> None:
    before = character(seed)
    result = compare(before, opened_again(turned(before, seed)))
    assert result.deviation < 1e-12
    assert not result.lost
    # At rest; 6 keys, 2 x 5 times between them, 2 beyond the ends.
    assert result.poses == 19


@pytest.mark.parametrize("seed", range(4))
def test_new_axes_move_nothing_whatever_scales_and_matrices_there_are(seed: int) -> None:
    rig = random_rig(seed)
    after = reframe(rig, random_turns(seed, len(rig)))
    result = self_check(Held(rig), Held(after))
    assert result.deviation < 1e-12
    assert not result.lost


@BOTH
def test_storing_as_float32_costs_far_less_than_the_tolerance(compare: Compare) -> None:
    before = character()
    after = opened_again(turned(before))
    result = compare(before, replace(after, rig=stored(after.rig)))
    assert 1e-9 < result.deviation < TOLERANCE / 10


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("node", [HIPS, SPINE, ARM, HAND])
def test_the_self_check_is_never_below_what_points_show(seed: int, node: int) -> None:
    before = character(seed)
    for rig in (nudged(before.rig, node), turned_inverse_bind(before.rig)):
        after = replace(before, rig=rig)
        assert self_check(before, after).deviation >= verify(before, after).deviation * (1 - 1e-12) > 0


@pytest.mark.parametrize("node", [HIPS, SPINE, ARM, HAND])
def test_weights_that_count_as_they_are_move_points_farther_than_their_joints(node: int) -> None:
    """Points of 2.5 in all: boxes leave room for it."""
    before = character(3)
    body, *others = before.drawn
    heavy = replace(
        body, weights=2.5 * body.weights / body.weights.sum(axis=1)[:, np.newaxis], raw_weights=True
    )
    before = replace(before, drawn=(heavy, *others))
    for rig in (nudged(before.rig, node), turned_inverse_bind(before.rig)):
        after = replace(before, rig=rig)
        assert self_check(before, after).deviation >= verify(before, after).deviation * (1 - 1e-12) > 0


def turned_inverse_bind(rig: Rig) -> Rig:
    matrices = rig.skins[0].inverse_bind.copy()
    matrices[2, 0] += 0.01
    return replace(rig, skins=(replace(rig.skins[0], inverse_bind=matrices),))


@pytest.mark.parametrize("mesh", range(3))
def test_the_fast_way_to_move_points_is_the_plain_way(mesh: int) -> None:
    before, after = character(), replace(character(), rig=nudged(turned(character()).rig, SPINE))
    pair = before.drawn[mesh], replace(before.drawn[mesh])
    fast = mesh_points(before.rig, after.rig, *pair)
    assert isinstance(fast, LinearMeshPoints)
    clips = before.rig.clips[0], after.rig.clips[0]
    for times in (np.array([0.0, 0.1]), np.array([0.6, 1.9, 2.5])):
        motions = Motion(before.rig, clips[0]), Motion(after.rig, clips[1])
        poses = SampledPoses(*(worlds(m.rig, m.locals_at(times)) for m in motions), clips, times)
        plain = MeshPoints((before.rig, after.rig), pair)
        assert_allclose(fast.distances(poses), plain.distances(poses), rtol=1e-9, atol=1e-12)


@BOTH
def test_what_is_not_a_number_in_both_is_the_same(compare: Compare) -> None:
    held = character()
    weights = held.drawn[0].weights.copy()
    weights[3] = np.nan
    body = replace(held.drawn[0], weights=weights)
    before = replace(held, drawn=(body, *held.drawn[1:]))
    assert compare(before, opened_again(turned(before))).deviation < 1e-12


def test_what_is_not_a_number_in_one_only_is_infinitely_apart() -> None:
    before = character()
    points = before.drawn[0].points.copy()
    points[3, 1] = np.nan
    body = replace(before.drawn[0], points=points)
    result = verify(before, replace(before, drawn=(body, *before.drawn[1:])))
    assert result.deviation == np.inf
    assert not result.passes(1e9)
    assert result.as_json()["deviation"] is None


def test_a_mesh_without_a_number_in_both_is_said_to_be_unmeasured() -> None:
    held = character()
    body = replace(held.drawn[0], points=np.full_like(held.drawn[0].points, np.nan))
    before = replace(held, drawn=(body, *held.drawn[1:]))
    result = verify(before, opened_again(turned(before)))
    (gone,) = result.unmeasured
    assert result.passes()
    assert result.worst is not None
    assert result.as_json()["meshes"][gone] is None
    line = f"{gone}: nothing could be measured, nothing of it is a number in either file"
    assert line in result.describe()
    assert f"nothing could be measured of {gone}" in result.summary()
    assert len(result.per_mesh) > 1
    assert verify(held, opened_again(turned(held))).unmeasured == []


def test_a_joint_that_is_not_a_number_in_one_only_is_infinitely_apart() -> None:
    before = character()
    assert self_check(before, replace(before, rig=nudged(before.rig, ARM, np.nan))).deviation == np.inf


@BOTH
def test_numbers_come_from_the_box_of_all_points(compare: Compare) -> None:
    rig = rig_of(["box"], [-1], np.zeros((1, 3)), attachment=np.array([0]))
    mesh = Mesh("box", 0, np.array([[0.0, 0, 0], [2, 3, 6]]))  # diagonal 7
    result = compare(Held(rig, (mesh,)), Held(nudged(rig, 0, 0.7), (mesh,)))
    assert_allclose([result.diagonal, result.absolute, result.deviation], [7, 0.7, 0.1])
    assert result.per_mesh == pytest.approx({"box": 0.1})
    assert result.worst is not None
    assert str(result.worst) == "mesh box, at rest"


@BOTH
def test_without_meshes_joints_are_measured(compare: Compare) -> None:
    rig = chain((0, 0, 0), (3, 4, 0))
    result = compare(Held(rig), Held(nudged(rig, 1, 0.5)))
    assert result.diagonal == pytest.approx(5)
    assert result.deviation >= 0.1
    assert not result.passes()


@BOTH
def test_a_reoriented_joint_without_children_and_meshes_is_seen(compare: Compare) -> None:
    rig = chain((0, 0, 0), (3, 4, 0))
    rotation = rig.rotation.copy()
    rotation[1] = from_axis_angle([0, 0, 1], 0.01)
    assert not compare(Held(rig), Held(replace(rig, rotation=rotation))).passes()


@BOTH
def test_a_rig_without_anything_is_like_itself(compare: Compare) -> None:
    empty = Held(rig_of([], [], np.zeros((0, 3)), np.zeros((0, 4))))
    result = compare(empty, empty)
    assert (result.deviation, result.diagonal, result.worst) == (0, 1, None)
    assert result.passes()
    assert not compare(character(), empty).passes()


@BOTH
def test_meshes_that_cannot_be_read_leave_the_joints(compare: Compare) -> None:
    class Unreadable(Held):
        def meshes(self) -> Sequence[Mesh]:
            raise FileError("the points are compressed")

        def outlines(self, *, closely: bool = False) -> Sequence[Mesh]:
            return self.meshes()

    before = character()
    after = turned(before)
    fine = compare(Unreadable(before.rig), Unreadable(opened_again(after).rig))
    assert fine.passes()
    assert not compare(Unreadable(before.rig), Unreadable(nudged(after.rig, ARM))).passes()


@BOTH
def test_a_mesh_that_names_joints_the_skin_does_not_have_is_left_out(compare: Compare) -> None:
    held = character()
    body = replace(held.drawn[0], joints=held.drawn[0].joints + 9)
    broken = replace(held, drawn=(body, *held.drawn[1:]))
    assert compare(broken, opened_again(turned(broken))).passes()


@BOTH
def test_rotations_that_are_not_unit_are_distinguished(compare: Compare) -> None:
    held = character()
    rotation = held.rig.rotation * 1.001
    before = replace(held, rig=replace(held.rig, rotation=rotation))
    result = compare(before, opened_again(turned(before)))
    assert result.denormalisation == pytest.approx(1e-3)
    assert result.deviation < 1e-12 < 1e-6 < result.raw_deviation
    assert result.passes()
    assert "off unit length by 0.001" in result.describe()


@BOTH
def test_rotations_that_lose_their_unit_length_are_a_loss(compare: Compare) -> None:
    before = character()
    stretched = replace(before, rig=replace(before.rig, rotation=before.rig.rotation * 1.1))
    result = compare(before, stretched)
    assert result.deviation < 1e-12
    assert not result.passes()
    assert "unit rotations" in result.lost[0]


@BOTH
@pytest.mark.parametrize("again", [False, True], ids=["in memory", "opened again"])
def test_what_a_reoriented_node_shows_is_found_at_its_new_node(compare: Compare, again: bool) -> None:
    before = character()
    turns = random_turns(1, len(before.rig))
    turns[[SWORD, CAMERA]] = random_turns(2, 5)[1:3]
    rig = reframe(before.rig, turns)
    after = opened_again(replace(before, rig=rig))
    if not again:
        after = replace(after, rig=rig)
    result = compare(before, after)
    assert result.deviation < 1e-12
    assert not result.lost


def test_nodes_found_by_name_need_no_keys() -> None:
    before = character()
    order = np.array([6, 0, 1, 2, 3, 5, 4, 7])
    back = np.argsort(order)
    rig = before.rig
    shuffled = replace(
        rig,
        names=tuple(rig.names[k] for k in order),
        parents=np.where(rig.parents[order] >= 0, back[rig.parents[order]], -1),
        translation=rig.translation[order],
        rotation=rig.rotation[order],
        attachment=np.where(rig.attachment[order] >= 0, np.arange(8), -1),
        skins=(replace(rig.skins[0], joints=back[rig.skins[0].joints]),),
        clips=tuple(
            replace(c, tracks=tuple(replace(t, node=int(back[t.node])) for t in c.tracks)) for c in rig.clips
        ),
    )
    drawn = tuple(replace(mesh, node=int(back[mesh.node])) for mesh in before.drawn)
    result = verify(before, Held(shuffled, drawn))
    assert result.deviation < 1e-12
    assert result.lost + result.added + result.changed == ()


def test_what_is_new_is_reported() -> None:
    before = character()
    rig = before.rig.with_nodes(["pole"], [-1], np.zeros((1, 3)), np.array([[0.0, 0, 0, 1]]))
    for result in (self_check(before, replace(before, rig=rig)), verify(before, replace(before, rig=rig))):
        assert result.added == ("node pole",)
        assert result.passes()


def test_other_key_times_are_reported() -> None:
    before = character()
    moved = with_track(before.rig, ARM, "rotation", times=np.array([0.0, 0.6, 1.25, 2.0]))
    result = verify(before, replace(before, rig=moved))
    assert result.changed == ("clip walk: rotation of arm has other key times",)
    assert result.worst is not None
    assert result.worst.clip == "walk"
    assert 0.5 <= result.worst.time < 0.6


def test_only_the_branch_that_changed_is_evaluated(monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[int] = []
    plain = Motion.locals_at

    def counting(self: Motion, times: object, *, normalised: bool = True) -> object:
        seen.append(len(self.rig))
        return plain(self, times, normalised=normalised)  # type: ignore[arg-type]

    monkeypatch.setattr(Motion, "locals_at", counting)
    before = character()
    self_check(before, replace(before, rig=nudged(before.rig, ARM)))
    # hips, spine, arm and what hangs on it, of both; not body and face
    assert max(seen) == 2 * 6
    seen.clear()
    result = self_check(before, replace(before, rig=replace(before.rig)))
    assert result.poses == 0
    assert result.identical
    assert result.summary() == (
        "largest vertex movement: 0 of the model's size; everything that was in the file is unchanged"
    )
    assert result.as_json()["identical"] is True
    assert not replace(result, poses=1).identical
    assert not replace(result, changed=("node a",)).identical
    assert not seen


@BOTH
def test_what_a_clip_does_not_move_is_where_it_is_at_rest(
    compare: Compare, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In a crowd each clip moves one of many: the result is that of posing all of them."""
    before, at = many(3), len(NAMES) + ARM
    others = (
        replace(before, rig=nudged(before.rig, at)),
        replace(before, rig=with_track(before.rig, at, "rotation", interpolation="LINEAR")),
        opened_again(turned(before)),
    )
    found = [compare(before, after) for after in others]
    assert found[0].deviation > 1e-3 < found[1].deviation
    monkeypatch.setattr(
        "rigtri.verification.compare.deviation._moved", lambda rig, _: np.ones(len(rig), dtype=bool)
    )
    for now, after in zip(found, others, strict=True):
        plain = compare(before, after)
        assert now.worst == plain.worst
        assert now.poses == plain.poses
        for mine, theirs in ((now.per_clip, plain.per_clip), (now.per_mesh, plain.per_mesh)):
            assert mine.keys() == theirs.keys()
            assert_allclose([*mine.values()], [*theirs.values()], atol=1e-12)


@BOTH
def test_a_character_is_posed_in_its_own_clips_alone(
    compare: Compare, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each clip of a crowd costs what one character does, however many there are."""
    posed: list[int] = []
    plain = Motion.locals_at

    def counting(self: Motion, times: object, *, normalised: bool = True) -> object:
        posed.append(len(self.rig))
        return plain(self, times, normalised=normalised)  # type: ignore[arg-type]

    monkeypatch.setattr(Motion, "locals_at", counting)
    most = []
    for count in (2, 8):
        before = many(count)
        compare(before, opened_again(turned(before)))
        most.append(max(posed))
        posed.clear()
    assert most[0] == most[1] < 3 * len(NAMES)


def test_blocks_of_times_do_not_change_the_result(monkeypatch: pytest.MonkeyPatch) -> None:
    before = character()
    after = replace(before, rig=nudged(before.rig, ARM))
    whole = [compare(before, after).as_json() for compare in (self_check, verify)]
    monkeypatch.setattr("rigtri.verification.compare.deviation._BLOCK", 1)
    split = [compare(before, after).as_json() for compare in (self_check, verify)]
    for one, other in zip(whole, split, strict=True):
        assert one["deviation"] == pytest.approx(other["deviation"], rel=1e-12)
        assert (one["poses"], one["worst"]) == (other["poses"], other["worst"])


def test_a_long_chain_is_posed_no_more_often_than_a_short_one(monkeypatch: pytest.MonkeyPatch) -> None:
    # A pose of a chain takes a step for each joint: more poses, too, would cost the square of its length.
    monkeypatch.setattr("rigtri.verification.compare.deviation._DEEP_BLOCK", 1 << 8)
    monkeypatch.setattr("rigtri.verification.compare.deviation._BLOCK", 1)
    posed: list[int] = []

    def counted(rig: Rig, local: Floats) -> Floats:
        posed.append(len(local))
        return worlds(rig, local)

    monkeypatch.setattr("rigtri.evaluation.sampling.worlds", counted)
    needed = []
    for joints in (3, 30):
        rig = chain(*((float(k), 0.0, 0.0) for k in range(joints)), names=[f"j{k}" for k in range(joints)])
        track = Track(joints - 1, "translation", "LINEAR", np.arange(6.0), np.zeros((6, 3)))
        rig = replace(rig, clips=(Clip("c", (track,)),))
        posed.clear()
        self_check(Held(rig), Held(nudged(rig, joints - 1)))
        needed.append(len(posed))
    assert needed[0] == needed[1]


def test_both_rigs_in_one_stand_as_each_by_itself() -> None:
    mine, theirs = random_rig(3), random_rig(4)
    theirs = replace(theirs, clips=theirs.clips[: len(mine.clips)])
    mine = replace(mine, clips=mine.clips[: len(theirs.clips)])
    both, times = joined(mine, theirs), np.linspace(-0.5, 2.5, 40)
    for k, clip in enumerate(both.clips):
        apart = [worlds(rig, locals_at(rig, rig.clips[k], times)) for rig in (mine, theirs)]
        assert np.array_equal(
            worlds(both, locals_at(both, clip, times)), np.concatenate(apart, axis=1), equal_nan=True
        )


def test_times_lie_at_keys_between_them_and_beyond() -> None:
    assert_allclose(between_keys(np.array([1.0, 2.0])), [0.9, 1.0, 1.29, 1.5, 2.0, 2.1])
    assert_allclose(between_keys(np.array([3.0])), [2.999, 3.0, 3.001])
    assert_allclose(between_keys(np.zeros(0)), [0.0])


def test_of_a_clip_with_many_keys_the_gaps_are_looked_into_that_may_differ() -> None:
    """Joints that agree at 3000 keys, and go opposite ways round between two of them."""
    times = np.arange(3000.0)

    def swung(last: float) -> Held:
        angles = np.where(times < 2000, 0.001 * times, 2.0 + last)
        keys = from_axis_angle(np.broadcast_to([0.0, 0.0, 1.0], (len(times), 3)), angles)
        clip = Clip("long", (Track(1, "rotation", "LINEAR", times, keys),))
        return Held(replace(chain((0, 0, 0), (1, 0, 0), (2, 0, 0)), clips=(clip,)))

    one, other = np.pi - 1e-7 - 0.001, np.pi + 1e-7 - 0.001
    apart, same = self_check(swung(one), swung(other)), self_check(swung(one), swung(one))
    assert apart.deviation > 0.1
    assert apart.worst is not None
    assert 1999 < apart.worst.time < 2000
    assert same.deviation == 0
    assert 3000 < apart.poses < 4500


def test_tangents_do_not_count_as_rotations() -> None:
    assert denormalisation(character().rig) < 1e-12


def test_what_looks_different_comes_before_a_deviation_of_0() -> None:
    before = character()
    less = verify(before, replace(before, drawn=before.drawn[:1]))
    assert less.deviation == 0
    assert less.summary() == "lost: mesh sword, mesh face; what both have does not move"
    nothing = verify(before, replace(before, rig=chain((0, 0, 0), (1, 0, 0)), drawn=()))
    assert nothing.poses == 0
    assert nothing.lost
    assert nothing.summary().endswith("; no pose was compared")
    assert nothing.as_json()["deviation"] is None
    assert nothing.describe().startswith("deviation   not measured: no pose was compared\nlost ")


def test_turning_in_the_world_is_seen_although_no_joint_origin_moves() -> None:
    before = character()
    rotation = before.rig.rotation.copy()
    rotation[CAMERA] = multiply(rotation[CAMERA], from_axis_angle([0, 1, 0], 1e-3))
    result = self_check(before, replace(before, rig=replace(before.rig, rotation=rotation)))
    assert result.worst is not None
    assert result.worst.what == "frame of camera"
    assert 1e-3 < result.deviation < 2e-3


def test_the_summary_reports_what_rotations_that_are_not_unit_show() -> None:
    held = character()
    assert "as stored" not in self_check(held, opened_again(turned(held))).summary()
    before = replace(held, rig=replace(held.rig, rotation=held.rig.rotation * 1.001))
    line = self_check(before, opened_again(turned(before))).summary()
    assert "; rotations as stored: " in line
    assert line.endswith(", off unit length by 0.001")


@BOTH
def test_another_up_axis_is_named(compare: Compare) -> None:
    held = character()
    after = replace(held, rig=replace(held.rig, rules=replace(held.rig.rules, up=(0.0, 0.0, 1.0))))
    assert compare(held, after).changed == ("up is Z, was Y",)


def test_an_upper_bound_holds_where_a_clip_carries_morphs_far_out(tmp_path: Path) -> None:
    document = read(arm().glb(tmp_path / "in.glb"))
    clips = tuple(
        replace(
            clip,
            tracks=tuple(
                replace(t, values=t.values * 1e9) if t.path == "weights" else t for t in clip.tracks
            ),
        )
        for clip in document.rig.clips
    )
    rig = replace(document.rig, clips=clips)
    rotation = multiply(rig.rotation, from_axis_angle([0.0, 0.0, 1.0], 1e-8))
    before = DocumentView(document, rig)
    after = DocumentView(document, replace(rig, rotation=rotation))
    bound, exact = self_check(before, after), verify(before, after)
    assert bound.deviation > 0.9 * exact.deviation > 0.1


def test_morph_weights_that_change_on_purpose_are_set_aside_at_common_times(tmp_path: Path) -> None:
    document = read(arm().glb(tmp_path / "in.glb"))
    (clip,), node = document.rig.clips, document.rig.find("Skin")

    def driven(share: float, other: float = 1.0, key: int = 0) -> DocumentView:
        tracks = tuple(
            replace(t, values=t.values * [share, other]) if t.path == "weights" else t for t in clip.tracks
        )
        rig = replace(document.rig, clips=(replace(clip, key=key, tracks=tracks),))
        return DocumentView(document, rig)

    def weights(view: Source) -> Floats:
        return next(track.values for track in view.rig.clips[0].tracks if track.path == "weights")

    changes = {document.rig.keys[node]: (0,)}
    before, after = without_changes(driven(1.0), driven(0.3), changes)
    assert np.array_equal(weights(before), weights(after))
    assert not weights(before)[:, 0].any()
    assert_allclose(weights(before)[[0, 3, -1], 1], [0.25, 0.75, 0.5])
    # What is another clip, or of another node, stays, and so does what has changed besides.
    after = without_changes(driven(1.0), driven(0.3, 0.5), changes)[1]
    assert_allclose(weights(after), weights(before) / 2.0)
    for views in (
        without_changes(driven(1.0), driven(0.3, key=1), changes),
        without_changes(before, after, {}),
    ):
        assert weights(views[0]).shape == weights(views[1]).shape
    assert weights(without_changes(driven(1.0), driven(0.3, key=1), changes)[1])[1, 0] == 0.3
