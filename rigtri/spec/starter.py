"""A spec to start from: what a character's own joints suggest."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from rigtri.formats import Options, read
from rigtri.inputs import opened
from rigtri.limbs import Limb, recognise
from rigtri.rig import Rig
from rigtri.skeleton import Skeleton, skeleton

# So many joints are shown as a comment; inspect shows all.
MOST_SHOWN = 200


def spec_init(path: Path | str, *, options: Options | None = None) -> str:
    """A spec in YAML to start from, with steps for the joints of a file, as `rigtri spec-init` writes it.

    Raises FileError for a file that cannot be read, or is without joints.
    """
    with opened(path) as file:
        return starter(read(file, options or Options()).rig, Path(path).name)


def starter(rig: Rig, file: str) -> str:
    """A spec in YAML for ``rig``, with its joints as a comment; what is uncertain is commented out.

    Raises FileError for a file without joints.
    """
    tree = skeleton(rig)
    lines = [
        f"# A rig spec to start from, for {_quoted(file)}.",
        "# Steps and options are those of the commands: rigtri COMMAND --help.",
        "# Editors check and complete it with the schema: rigtri schema spec > spec.schema.json",
        "version: 1",
        "",
        "steps:",
        "  # New axes for all joints that carry weight; nothing that can be seen moves. Other presets:",
        "  # maya, unreal-editor, mgear, cmt, blender, rigify, talk, article, openxr, three-ik, vrm.",
        "  - do: orient-joints",
        f"    preset: {'vrm' if rig.frozen else 'maya'}",
        "",
        *_limbs(rig),
        *_fingers(rig, tree),
        *_joints(rig, tree),
    ]
    return "\n".join(lines).rstrip() + "\n"


def plain_values(text: str) -> Any:
    """A spec in YAML as plain values, without its comments."""
    from ruamel.yaml import YAML

    return YAML(typ="safe", pure=True).load(text)


def _limbs(rig: Rig) -> Iterator[str]:
    known = recognise(rig)
    limbs = [limb for limb in known if _chained(rig, limb)]
    if not limbs:
        yield "  # No arms or legs in chains are known by their names. Name three joints of a limb:"
        yield "  # - do: add-polevector"
        yield "  #   limb: [upper_arm, forearm, hand]"
        yield "  # - do: add-controls"
        yield "  #   ik: [upper_arm, forearm, hand]"
        yield from _left_out(rig, known)
        yield ""
        return
    yield "  # Twist joints, so that the skin of these limbs does not wring."
    yield "  - do: add-twist"
    yield "    limb:"
    yield from (f"      - {_flow(rig, limb)}" for limb in limbs)
    yield "    count: 2"
    if lacking := _lacking(known):
        yield f"  # Not known by its name, so not here: {', '.join(lacking)}. Name three joints of each."
    yield from _left_out(rig, known)
    yield ""
    yield "  # A root control, an FK control for each joint, IK ends and pole vectors for these limbs."
    yield "  - do: add-controls"
    yield "    whole-character: true"
    yield ""
    yield "  # The motion of the clips on the controls too, for animators."
    yield "  # - do: bake"
    yield "  #   to: controls"
    yield ""


def _lacking(known: Iterable[Limb]) -> list[str]:
    """The arms and legs of a character that are not among those that are known, where it has sides."""
    found = {(limb.kind, limb.side) for limb in known}
    return [
        f"{side} {kind}"
        for kind in ("arm", "leg")
        for side in ("left", "right")
        if (kind, side) not in found and (kind, "") not in found
    ]


def _left_out(rig: Rig, known: Iterable[Limb]) -> Iterator[str]:
    for limb in known:
        if not _chained(rig, limb):
            yield f"  # Left out, as its joints do not hang below each other: {_flow(rig, limb)}"


def _chained(rig: Rig, limb: Limb) -> bool:
    """Whether each joint of a limb hangs below the one before; in some IK rigs the foot does not."""
    return rig.is_below(limb.middle, limb.start) and rig.is_below(limb.end, limb.middle)


def _flow(rig: Rig, limb: Limb) -> str:
    return f"[{_names(rig, limb.triple)}]"


def _names(rig: Rig, nodes: Iterable[int]) -> str:
    return ", ".join(_name(rig, node) for node in nodes)


def _name(rig: Rig, node: int) -> str:
    """What finds a node, as YAML has it."""
    ways = (rig.address(node), rig.path(node), rig.labels[node])
    return _quoted(next((way for way in ways if _plain(way) and rig.known(way) == node), rig.labels[node]))


def _plain(way: str) -> bool:
    """Whether a node's name or path means nothing else in a spec: no braces, no index, no bone of VRM."""
    return "{" not in way and not way.startswith(("#", "vrm:"))


def _quoted(text: str) -> str:
    """A text as YAML has it in quotes, what would end a line or cannot be seen as an escape."""
    words = json.dumps(text, ensure_ascii=False)
    return "".join(letter if letter.isprintable() else _escape(ord(letter)) for letter in words)


def _escape(code: int) -> str:
    return f"\\u{code:04x}" if code < 0x10000 else f"\\U{code:08x}"


def _fingers(rig: Rig, tree: Skeleton) -> Iterator[str]:
    """Chains that hang below the end of a limb, as an example of controls for a few joints."""
    chains = []
    for limb in recognise(rig):
        for top in tree.below.get(limb.end, ()):
            chain = _chain(tree, top)
            if len(chain) > 1 and limb.kind == "arm":
                chains.append(chain)
    if not chains:
        return
    yield "  # Fingers alone, with shapes of their own."
    yield "  # - do: add-controls"
    yield "  #   chain:"
    yield from (f"  #     - [{_names(rig, (chain[0], chain[-1]))}]" for chain in chains)
    yield "  #   shape: {fk: square}"
    yield ""


def _chain(tree: Skeleton, top: int) -> list[int]:
    chain = [top]
    while len(tree.below.get(chain[-1], ())) == 1:
        chain.append(tree.below[chain[-1]][0])
    return chain


def _joints(rig: Rig, tree: Skeleton) -> Iterator[str]:
    yield "# The joints, as steps may call them:"
    depths: dict[int, int] = {}
    for number, joint in enumerate(_depth_first(rig, frozenset(tree.joints))):
        if number == MOST_SHOWN:
            yield f"#   … {len(tree.joints) - MOST_SHOWN} more; all with: rigtri inspect FILE"
            break
        depths[joint] = depths.get(tree.above[joint], -1) + 1
        yield f"#   {'  ' * depths[joint]}{_name(rig, joint)}"


def _depth_first(rig: Rig, joints: frozenset[int]) -> Iterator[int]:
    """Joints as inspect lists them: below each, all that hangs there, before its next sibling."""
    left = [node for node in range(len(rig) - 1, -1, -1) if rig.parents[node] < 0]
    while left:
        node = left.pop()
        left += reversed(rig.children[node])
        if node in joints:
            yield node
