"""The nodes that the script of export-blender adds to a scene, as they are found in what comes from there.

For each IK end a switch, whose scale says whether its IK was on; for each control one whose place is the
control's scale, of which USD keeps half floats; and where nothing has IK, one that says that pose readers
drive. A switch is a child of its IK end, or called after it: ``rigtri_ik_hand_L_ik_ctl``. In USD, whose
joints have no prims below them, it is beside the Skeleton, below the prim of the armature. Blender numbers
bones in their armature and objects in the scene: of several characters of one kind a node has a number that
its control has not, or another one. So what it is below says whose it is, and its name without the number
which control.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence

from rigtri.model.hierarchy import Hierarchy
from rigtri.text import identifier, unnumbered

IK, SCALE, DRIVE = "rigtri_ik", "rigtri_scale", "rigtri_drive"
# With the name of a control; switches of older scripts had Blender's number.
_NAME = re.compile(r"rigtri_((ik|scale)([._].+)?|drive([._][0-9]+)?)")


def is_script_node(name: str, kind: str = "") -> bool:
    """Whether a name is one that the script gives, of one kind or of any."""
    return name.startswith(kind) and _NAME.fullmatch(name) is not None


def script_nodes(names: Sequence[str], tree: Hierarchy, controls: Collection[int]) -> list[int]:
    """All that the script has added for some controls, and those that say that pose readers drive."""
    drives = [k for k, name in enumerate(names) if is_script_node(name, DRIVE)]
    return [*drives, *(node for kind in (IK, SCALE) for node in controls_of(names, tree, controls, kind))]


def controls_of(names: Sequence[str], tree: Hierarchy, ends: Collection[int], kind: str) -> dict[int, int]:
    """The nodes of one kind among those of these names, with the one of the controls that each is for.

    ends: the controls that may have one. Those furthest down come first, so that a rider's switch is none of
    the horse below it; then those whose names need the fewest numbers taken off.
    """
    alike = [k for k, name in enumerate(names) if is_script_node(name, kind)]
    named, plain = dict[tuple[int, str], list[int]](), dict[tuple[int, str], list[int]]()
    for end in ends if alike else ():
        name = identifier(f"{kind}_{names[end]}")
        for above in (*tree.path_to_root(end)[1:], -1):
            named.setdefault((above, name), []).append(end)
            plain.setdefault((above, unnumbered(name)), []).append(end)
    found, looks = dict[int, int](), list[tuple[int, int, int, list[int]]]()
    for node in alike:
        above, own = int(tree.parents[node]), identifier(names[node])
        short = unnumbered(own)
        if above in ends:
            found[node] = above
        else:
            ways = named.get((above, own)), named.get((above, short)), plain.get((above, short))
            looks += [(-tree.depth[node], k, node, way) for k, way in enumerate(ways) if way]
    taken = set(found.values())
    for _, _, node, way in sorted(looks):
        free = [end for end in way if end not in taken]
        if node not in found and len(free) == 1:
            found[node] = free[0]
            taken.add(free[0])
    return found
