"""Give a skeleton whose joints get other paths an animation of its own, where others play it, too.

An animation lists its joints by path, so skeletons can share it while these agree. The copy holds what the
animation holds; the passes after this one write the rig as into any other file.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import partial

from rigtri.errors import FileError
from rigtri.formats.usd.composition.stage import refuse
from rigtri.formats.usd.opinions.edits import Edit, bind_animation
from rigtri.formats.usd.opinions.skeleton_edits import check_motion_editable, copy_animation
from rigtri.formats.usd.passes.usd_edit import UsdEdit, holder_names, new_above, new_names
from rigtri.formats.usd.reading.animation_reader import Animation
from rigtri.formats.usd.reading.joint_tokens import renamer, split_token
from rigtri.formats.usd.reading.node_keys import kind, parts
from rigtri.formats.usd.reading.skeleton_reader import Skeleton
from rigtri.formats.usd.reading.source import Source
from rigtri.model.animation import Clip
from rigtri.model.rig import Rig
from rigtri.report import Notice
from rigtri.text import and_more

# By the path of a skeleton what becomes of its tokens: by names, and by joints that come between.
Paths = Mapping[str, Callable[[str], tuple[str, str]]]


def unshare_animations(edit: UsdEdit) -> None:
    """Read the source again with a copy of each animation for the skeletons whose joints get other paths.

    FileError where a skeleton cannot be bound to one.
    """
    source = edit.source
    changed = _new_paths(source, edit.rig)
    edits: list[Edit] = []
    copied: dict[str, tuple[str, list[str]]] = {}
    for animation in source.animations.values() if changed else ():
        for number, users in enumerate(_groups(source, animation, changed)):
            if not number:
                continue  # the animation stays theirs
            copy, made = copy_animation(source.stage, animation.path, number + 1)
            edits += made
            for skeleton in users:
                _check(source, skeleton, animation)
                edits += bind_animation(skeleton.path, copy)
            copied[copy] = (animation.path, [skeleton.path for skeleton in users])
            shown = and_more([f"<{skeleton.path}>" for skeleton in users], 3)
            text = (
                f"Animation <{animation.path}> drives skeletons whose joints get different paths; {shown} "
                f"got a copy of it, <{copy}>."
            )
            edit.notices.append(Notice("animation-split", text))
    if edits:
        edit.prepare(edits)
        edit.rig = replace(edit.rig, clips=tuple(_clips(edit.source, edit.rig, copied)))


def _new_paths(source: Source, rig: Rig) -> Paths:
    names, holders = new_names(source, rig), holder_names(source, rig)
    found: dict[str, Callable[[str], tuple[str, str]]] = {}
    for path in {**names, **holders}:
        renamed = renamer(source.skeletons[path].tokens, names.get(path, {}))
        found[path] = partial(_new_path, renamed, holders.get(path, {}))
    return found


def _new_path(renamed: Callable[[str], str], holders: Mapping[str, str], token: str) -> tuple[str, str]:
    return renamed(token), split_token(token, holders)


def _same_path(token: str) -> tuple[str, str]:
    return token, token


def _groups(source: Source, animation: Animation, changed: Paths) -> list[list[Skeleton]]:
    """The skeletons that an animation moves, together where its joints have the same new paths in them.

    First those that keep theirs or cannot be edited. One group where nothing plays it.
    """
    users = [
        s for s in source.skeletons.values() if animation.path in s.animations and s.path != animation.path
    ]
    users.sort(key=lambda skeleton: (not skeleton.locked, skeleton.path in changed))
    groups: list[tuple[dict[str, tuple[str, str]], list[Skeleton]]] = []
    for skeleton in users:
        new = changed.get(skeleton.path, _same_path)
        known = set(skeleton.tokens)
        mine = {token: new(token) for token in animation.tokens if token in known}
        for theirs, group in groups:
            if all(theirs.get(token, path) == path for token, path in mine.items()):
                theirs.update(mine)
                group.append(skeleton)
                break
        else:
            groups.append((mine, [skeleton]))
    return [group for _, group in groups]


def _check(source: Source, skeleton: Skeleton, animation: Animation) -> None:
    """FileError where a skeleton cannot play a copy of an animation in place of it."""
    refuse(skeleton.locked)
    change = f"<{skeleton.path}> needs a copy of <{animation.path}>, for joints of others keep their paths"
    if len(skeleton.animations) > 1:
        raise FileError(
            f"{change}, and its instances play several animations. Change the joints of all alike, or make "
            "the one to edit no instance (instanceable = false)."
        )
    check_motion_editable(source.stage, skeleton, change)


def _clips(source: Source, rig: Rig, copied: Mapping[str, tuple[str, list[str]]]) -> Iterator[Clip]:
    """The clips of a rig with those of the copies, each with the keys of the nodes that it moves."""
    known = {clip.key: clip for clip in rig.clips}
    users = {path: set(skeletons) for path, (_, skeletons) in copied.items()}
    joints = {
        node: parts(skin.key)[1]
        for skin in rig.skins
        if kind(skin.key) == "skeleton"
        for node in skin.joints.tolist()
    }
    joints |= {holder: joints[node] for node, holder in new_above(rig).items() if node in joints}
    moved = {path: {node for node, skeleton in joints.items() if skeleton in users[path]} for path in copied}
    for clip in source.rig.clips:  # blend shapes go with their skeleton
        path = parts(clip.key)[-1]
        if path in copied:
            moved[path] |= {track.node for track in clip.tracks if track.path == "weights"}
    gone: dict[str, set[int]] = {}
    for path, (origin, _) in copied.items():
        gone.setdefault(origin, set()).update(moved[path])
    for clip in source.rig.clips:
        moment, path = (*parts(clip.key), "")[:2]
        if path in copied:
            own = known.get((moment, copied[path][0]), clip)
            yield replace(clip, tracks=tuple(t for t in own.tracks if t.node in moved[path]))
        elif path in gone:
            own = known.get(clip.key, clip)
            yield replace(own, tracks=tuple(t for t in own.tracks if t.node not in gone[path]))
        else:
            yield known.get(clip.key, clip)
    read = {clip.key for clip in source.rig.clips}
    yield from (clip for clip in rig.clips if clip.key not in read)
