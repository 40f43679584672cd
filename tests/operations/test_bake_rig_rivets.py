"""bake --rig: rivets hold on to the points that they have in RIG, however an exporter numbers these."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from rigtri import add_rivet, bake, read
from rigtri.evaluation.skinning import Influences, influences
from rigtri.model.mesh import Mesh
from rigtri.model.metadata import RivetRecord
from rigtri.model.rig import Rig
from rigtri.operations.take_clips import restore_rivets
from rigtri.operations.take_clips.restore_metadata import as_described
from rigtri.report import Report


def with_meshes(rig: Rig, change: Callable[[Mesh], Mesh]) -> Rig:
    """The rig as another program wrote its meshes."""
    meshes = [change(mesh) for mesh in rig.meshes]
    return replace(rig, content=replace(rig.content, read_meshes=lambda: meshes))


def renumbered(mesh: Mesh) -> Mesh:
    """A mesh with its points in another order, the first of them twice, as along a seam."""
    order = np.r_[np.arange(len(mesh.points))[::-1], 0]
    return replace(
        mesh,
        points=mesh.points[order],
        joints=mesh.joints[order],
        weights=mesh.weights[order],
        morphs=mesh.morphs[:, order],
    )


@pytest.fixture
def rigged(samples: Path) -> Rig:
    return add_rivet(read(samples / "biped.glb"), mesh="body", triangle=(40,), name=("button",))


def record(rig: Rig) -> RivetRecord:
    return rig.records(RivetRecord)[rig.find("button")]


def test_rivets_find_their_points_again(rigged: Rig) -> None:
    """Before, the numbers of RIG were taken: a rivet was up to 0.075 of the size beside its place."""
    edited = with_meshes(rigged, renumbered)
    (body,) = [mesh for mesh in rigged.meshes if mesh.node == rigged.find("body")]
    (anew,) = [mesh for mesh in edited.meshes if mesh.node == edited.find("body")]
    there = record(rigged)
    report = Report()
    here = record(as_described(edited, rigged, report=report))
    assert here.vertices != there.vertices
    assert (anew.points[list(here.vertices)] == body.points[list(there.vertices)]).all()
    assert (anew.weights[list(here.vertices)] == body.weights[list(there.vertices)]).all()
    assert not [notice for notice in report.warnings if notice.code == "follower-kept"]


def test_rivets_keep_their_numbers_where_the_mesh_is_as_it_was(rigged: Rig) -> None:
    assert record(as_described(rigged, rigged, report=Report())) == record(rigged)


def test_a_rivet_whose_points_are_gone_keeps_its_keys(rigged: Rig) -> None:
    moved = with_meshes(rigged, lambda mesh: replace(mesh, points=mesh.points * [1.0, 1.2, 1.0]))
    report = Report()
    baked = as_described(moved, rigged, report=report)
    assert not baked.records(RivetRecord)
    assert [n.code for n in report.warnings if "button" in n.text] == ["follower-kept"]


def test_a_mesh_is_weighed_once_for_all_its_rivets(samples: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    names = ("button", "badge", "buckle")
    rigged = add_rivet(read(samples / "biped.glb"), mesh="body", triangle=(40, 41, 60), name=names)
    weighed = list[Mesh]()

    def counted(mesh: Mesh, rig: Rig) -> Influences:
        weighed.append(mesh)
        return influences(mesh, rig)

    monkeypatch.setattr(restore_rivets, "influences", counted)
    found = restore_rivets.with_rivets_of(
        with_meshes(rigged, renumbered), rigged, {node: node for node in range(len(rigged))}, Report()
    )
    assert len(found.records(RivetRecord)) == 3
    assert len(weighed) == 2  # of the one file and of the other


def test_points_that_were_numbered_anew_hold_no_rivet_without_the_file_from_before(rigged: Rig) -> None:
    """Custom properties come through Blender. Before, the rivet went to other points, without a word."""

    def reordered(mesh: Mesh) -> Mesh:
        order = np.random.default_rng(1).permutation(len(mesh.points))
        surface = mesh.surface_now
        assert surface is not None
        drawn = surface._replace(corners=np.argsort(order)[surface.corners], normals=surface.normals[order])
        parts = {name: getattr(mesh, name)[order] for name in ("points", "joints", "weights")}
        return replace(mesh, **parts, morphs=mesh.morphs[:, order], surface=lambda: drawn)

    report = Report()
    baked = bake(with_meshes(rigged, reordered), to="joints", report=report)
    node = baked.find("button")
    assert (baked.translation[node] == rigged.translation[node]).all()
    (text,) = [each.text for each in report.warnings if each.code == "follower-kept"]
    assert "its points are no triangle of mesh 'body'" in text
    assert "and the file from before" in text
