"""Rename joints: their tokens, and those of all below them, wherever joints are listed.

No value changes; the passes after this one write the rig as into any other file.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace

import numpy as np

from rigtri.errors import FileError
from rigtri.formats.usd.composition.stage import refuse, tokens_of
from rigtri.formats.usd.composition.variants import variants_of
from rigtri.formats.usd.opinions.edits import Edit, set_tokens
from rigtri.formats.usd.opinions.joint_influences import influence_edits, stale_names
from rigtri.formats.usd.opinions.joint_lists import JointLists
from rigtri.formats.usd.opinions.skeleton_edits import bound_in, joint_names
from rigtri.formats.usd.passes.usd_edit import UsdEdit, new_names
from rigtri.formats.usd.reading.joint_tokens import renamer
from rigtri.formats.usd.reading.skeleton_reader import nearest_listed
from rigtri.formats.usd.reading.source import Source
from rigtri.model.rig import Rig
from rigtri.text import and_more

# By the path of a skeleton what becomes of its tokens.
Renaming = Mapping[str, Callable[[str], str]]


def rename_joints(edit: UsdEdit) -> None:
    """Read the source again with the new names; FileError where not all that names joints can be edited."""
    source, names = edit.source, new_names(edit.source, edit.rig)
    if not names:
        return
    renaming: Renaming = {path: renamer(source.skeletons[path].tokens, each) for path, each in names.items()}
    for path, renamed in renaming.items():
        _check(source, path, renamed)
    lists = JointLists(source, renaming)
    played = {path: _played(source, path) for path in source.skeletons}
    edits = [
        *lists.settings([*_skeleton_edits(source, renaming), *_animation_edits(source, renaming, played)]),
        *influence_edits(source, renaming, grown=False),
    ]
    edit.notices += stale_names(source, renaming, edits)
    edit.prepare(edits)
    lists.expect(edit.expected)
    edit.rig = replace(edit.rig, keys=_keys(source, edit.source, edit.rig))


def _check(source: Source, path: str, renamed: Callable[[str], str]) -> None:
    """FileError where the skeleton or what drives and binds it cannot be edited, or names move joints."""
    skeleton = source.skeletons[path]
    refuse(skeleton.locked)
    now = nearest_listed(list(map(renamed, skeleton.tokens)))
    if (moved := np.flatnonzero(nearest_listed(skeleton.tokens) != now)).size:
        raise FileError(
            f"<{path}>: joint '{skeleton.tokens[moved[0]]}' is not a path of names, so it has no parent in "
            "UsdSkel; new names would give it one, and move it. Give joints paths first, parent/child"
        )


def _played(source: Source, path: str) -> set[str]:
    """The animations of a skeleton in all variants that the stage has."""
    skeleton = source.skeletons[path]
    found = set(skeleton.every_animation)
    if path in source.animations:
        return found
    for variants in variants_of(source.stage, path, skeleton.varied):
        found |= bound_in(variants)
    return found


def _skeleton_edits(source: Source, renaming: Renaming) -> Iterator[Edit]:
    for path, renamed in renaming.items():
        skeleton = source.skeletons[path]
        if path in source.animations:
            continue
        tokens = list(map(renamed, skeleton.tokens))
        yield set_tokens(path, "joints", tokens)
        names = joint_names(source.stage, skeleton)
        leaves = [token.rpartition("/")[2] for token in skeleton.tokens]
        if names is not None:
            pairs = zip(names, leaves, tokens, strict=True)
            yield set_tokens(
                path, "jointNames", [new.rpartition("/")[2] if n == leaf else n for n, leaf, new in pairs]
            )


def _animation_edits(source: Source, renaming: Renaming, played: Mapping[str, set[str]]) -> Iterator[Edit]:
    listed = {path: animation.tokens for path, animation in source.animations.items()}
    read = {path for skeleton in source.skeletons.values() for path in skeleton.every_animation}
    for path in sorted(set[str]().union(*played.values()) - read):
        listed[path] = tokens_of(source.stage.GetPrimAtPath(path), "joints")
    for path, before in listed.items():
        users = [source.skeletons[user] for user, paths in played.items() if path in paths or user == path]
        tokens: list[str] = []
        for token in before:
            mine = [skeleton.path for skeleton in users if token in skeleton.tokens]
            new = {renaming[user](token) if user in renaming else token for user in mine}
            if len(new) > 1:
                shared = and_more([f"<{user}>" for user in mine], 3)
                raise FileError(
                    f"Animation <{path}> drives {shared}, for which '{token}' would have to have several "
                    "names in it. Rename the joint in all of them alike, or give each an animation of its own"
                )
            tokens += new or {token}
        if tokens != list(before):
            yield set_tokens(path, "joints", tokens)


def _keys(before: Source, after: Source, rig: Rig) -> tuple[object, ...]:
    now = dict(zip(before.rig.keys, after.rig.keys, strict=True))
    return tuple(now.get(key) for key in rig.keys)
