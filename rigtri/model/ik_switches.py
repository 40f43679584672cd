"""The nodes by which the script of export-blender tells of controls in a file, as they are found.

They say whether the IK of an IK end was on, and how a control was scaled. A switch is a child of its IK end,
or called after it: ``rigtri_ik_hand_L_ik_ctl``. In USD, whose joints have no
prims below them, it is beside the Skeleton, below the prim of the armature. Blender numbers bones in their
armature and objects in the scene: of several characters of one kind a switch has a number that its end has
not, or another one. So what a switch is below says whose it is, and its name without the number which end.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence

from rigtri.model.hierarchy import Hierarchy
from rigtri.model.metadata import SWITCH
from rigtri.text import identifier, unnumbered

IK, SCALE = "rigtri_ik", "rigtri_scale"


def switch_ends(
    names: Sequence[str], tree: Hierarchy, ends: Collection[int], kind: str = IK
) -> dict[int, int]:
    """The nodes of one kind among those of these names, with the one of the controls that each tells of.

    Those furthest down come first, so that a rider's switch is none of the horse below it; then those whose
    names need the fewest numbers taken off.
    """
    alike = [k for k, name in enumerate(names) if name.startswith(kind) and SWITCH.fullmatch(name)]
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
