"""What does not live: names of parts of plants, buildings or machines, and limbs that may be of such."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import cache, lru_cache
from pathlib import Path
from typing import Any

from rigtri.maths.scalar_vector import Vector
from rigtri.maths.triangle import bend_angle
from rigtri.recognition.body_shape import Body
from rigtri.recognition.character_draft import Draft, once
from rigtri.recognition.facing import feet_ahead
from rigtri.recognition.found_limb import Found
from rigtri.recognition.front_or_hind import head_end
from rigtri.recognition.joint_tree import Tree
from rigtri.recognition.limb_ends import HAND
from rigtri.recognition.limb_pairs import Limbs
from rigtri.recognition.limb_triples import beside
from rigtri.recognition.limb_words import NO_WORDS
from rigtri.recognition.name_parsing import NAMES, parse_name
from rigtri.recognition.naming_schemes import roles_in_name
from rigtri.recognition.shape_doubts import ZIGZAG, hangs_from_a_lying_trunk
from rigtri.recognition.word_tables import our_table, role_words

# A gun points ahead by this (a cosine, 25°), and goes down by less than this part of its length.
_AIMED, _DROOPS = 0.906, 0.5
# What lives has feet that point ahead this far, 0 to 1, or moves a knee in clips by this (15°, in radians).
_POINTED, _MOVED = 0.5, 0.26
# Legs go down by this (a cosine), of those that sit, too; and by the second (45°) where they carry a trunk
# that lies: fins go aside.
_STANDS, _CARRIES = 0.5, 0.7
# Wings go aside by more than this (a cosine, 60°). The bone below a hock goes down by as much, and is so long
# a part of the one above it.
_SPREAD, _DOWN, _LONG = 0.5, 0.5, 0.4
# Of a body one of these names alone does not tell: planes have tails, and vices jaws.
_HEADS = frozenset(["skull", "tail", "face"])
_ALONE = _HEADS | {"body"}
# A clavicle is at most so long a part of the upper arm.
_CLAVICLE = 0.6


@cache
def _things() -> frozenset[str]:
    """The words of inanimate.toml, and those of parts of machines that hang in pairs."""
    return _words(line for line in _table().values() if isinstance(line, str))


@cache
def _objects() -> frozenset[str]:
    """Words of whole things, and those of parts of machines that hang in pairs."""
    return _words(_table()["objects"].values())


@cache
def _devices() -> frozenset[str]:
    """Words of what stands on legs, or has arms, beside people: furniture, vehicles and instruments."""
    objects = _table()["objects"]
    return frozenset(f"{objects['furniture']} {objects['vehicles']} {objects['instruments']}".split())


@cache
def _garments() -> frozenset[str]:
    return frozenset(_table()["objects"]["garments"].split())


@cache
def _parts() -> frozenset[str]:
    """Words of devices and of parts of machines and buildings, without those that bodies or rigs have."""
    table = _table()
    parts = frozenset(f"{table['buildings']} {table['fittings']} {table['machines']}".split())
    return _devices() | (parts - frozenset(table["neutral"]["parts"].split()))


@cache
def whole_rigs() -> frozenset[str]:
    """Words of joints that hold a whole rig, whatever it is of."""
    return frozenset(_table()["neutral"]["rigs"].split())


@lru_cache(NAMES)
def thing_in_name(name: str) -> bool:
    """Whether a name is of a device, or of a part of a machine or building."""
    return not _parts().isdisjoint(parse_name(name).words)


def garment_in_name(name: str) -> bool:
    """Whether a name has a word for what is worn.

    >>> garment_in_name("trousers_L_thigh"), garment_in_name("thigh_L")
    (True, False)
    """
    return not _garments().isdisjoint(parse_name(name).words)


@cache
def _machines() -> frozenset[str]:
    """Words of vehicles, and those of parts of machines that hang in pairs."""
    return _words([_table()["objects"]["vehicles"]])


def _words(lines: Iterable[str]) -> frozenset[str]:
    return frozenset(word for line in lines for word in line.split()) | role_words()["machine"]


@cache
def _table() -> dict[str, Any]:
    return our_table(Path(__file__).with_name("inanimate.toml"))


@once
def trunk_names(draft: Draft) -> list[str]:
    """Names of trunk, head and tail, without a thing's, which has a ``cart_body`` or a ``tail_rotor``."""
    names = [draft.tree.rig.names[k] for k in draft.tree.nodes if draft.words.get(k, NO_WORDS).trunk]
    return [name for name in names if _objects().isdisjoint(parse_name(name).words)]


@once
def has_trunk(draft: Draft) -> bool:
    """Whether names tell of a trunk: a head, a tail or a body alone do not, nor all beside those of a device.

    Scales have a head, planes a tail, drones, grills and pianos a body, and cameras and lamps all of these.
    """
    if is_of_device(draft):
        return has_hips_or_spine(draft)
    names = trunk_names(draft)
    alone = [name for name in names if not _ALONE.isdisjoint((*roles_in_name(name), *parse_name(name).words))]
    return len(names) > min(1, len(alone))


@once
def has_hips_or_spine(draft: Draft) -> bool:
    """Whether names tell of a trunk beside head and neck: a guitar has a body, a neck and a head."""
    names = [name for name in trunk_names(draft) if _HEADS.isdisjoint(roles_in_name(name))]
    return any("body" not in parse_name(name).words for name in names)


@once
def has_head(draft: Draft) -> bool:
    """Whether a name of the trunk is of a head or neck."""
    return any("skull" in roles_in_name(name) for name in trunk_names(draft))


@once
def is_of_device(draft: Draft) -> bool:
    """Whether a name is of furniture, a vehicle or an instrument."""
    names = (draft.tree.rig.names[k] for k in draft.tree.nodes)
    return any(not _devices().isdisjoint(parse_name(name).words) for name in names)


@once
def is_of_machine(draft: Draft) -> bool:
    """Whether a name is of a vehicle or a machine's part, which nobody holds, and none of a trunk."""
    names = (draft.tree.rig.names[k] for k in draft.tree.nodes)
    return any(not _machines().isdisjoint(parse_name(name).words) for name in names) and not has_trunk(draft)


def of_machine(draft: Draft, each: Found) -> str:
    """A limb without a name of one, where names are of a machine's parts, and none of a trunk or limb."""
    if (each.pair is not None and each.pair.kind) or not is_of_machine(draft):
        return ""
    limbs = any(word.kind for word in draft.words.values())
    return "" if limbs else "names here are of parts of a machine, and none of a body"


def only_things(draft: Draft, each: Found) -> str:
    """That the joints of a limb, and all others here that have a name, are called as parts of things."""
    names = draft.tree.rig.names
    words = [parse_name(names[node]).words for node in draft.tree.nodes if parse_name(names[node]).plain]
    own = [parse_name(names[node]).words for node in each.joints]
    if not all(map(_things().intersection, [*words, *own])):
        return ""
    return "its name, and all others here, are of parts of things and not of a body"


def called_a_device(draft: Draft, each: Found) -> str:
    """A limb whose joints are called as of furniture or a vehicle, beside a trunk that is not: a stool's.

    Where the trunk is called so, too, it is who stands there: a lamp that walks.
    """
    words = [_devices().intersection(parse_name(draft.tree.rig.names[joint]).words) for joint in each.joints]
    common = sorted(frozenset.intersection(*words))
    if not common or not has_hips_or_spine(draft):
        return ""
    return f"its joints are called as of a {common[0]}, and the hips or spine are not"


def points_ahead(draft: Draft, each: Found) -> str:
    """An arm without fingers whose lower bone is level and points ahead, and that does not hang: a gun."""
    mine, at = each.pair, draft.tree.at
    if each.kind != "arm" or mine is None or mine.fingers >= 2 or mine.named > 0.0:
        return ""
    start, middle, end = (at[joint] for joint in each.joints)
    drop = (start - end).dot(draft.up)
    # Machines may be seen the wrong way round: their knees and feet are as they like.
    aimed = abs((end - middle).unit.dot(draft.facing)) > _AIMED
    return "it points ahead as a gun does" if aimed and drop < _DROOPS * end.distance(start) else ""


def may_be_wings(draft: Draft, each: Found) -> str:
    """Arms without names or hands that go aside, of a body whose legs have hocks or whose trunk lies: wings.

    Below a trunk that lies a few feathers pass for fingers.
    """
    mine, body, plane = each.pair, draft.shape.body, draft.shape.plane
    if each.kind != "arm" or mine is None or body is None or body.legs is None or plane is None:
        return ""
    lies = hangs_from_a_lying_trunk(body, mine)
    if mine.named > 0.0 or mine.kind or mine.fingers >= (HAND if lies else 2):
        return ""
    start, _, end = (draft.tree.at[joint] for joint in each.joints)
    aside = abs((end - start).unit.dot(plane.normal)) > _SPREAD
    if aside and lies:
        return "it goes aside from a trunk that lies, so it may be a wing"
    hocks = all(_has_hock(draft, path) for path in body.legs.pair.paths)
    return "its legs have hocks, so it may be a wing" if aside and hocks else ""


def _has_hock(draft: Draft, path: Sequence[int]) -> bool:
    """Whether a leg bends back at a joint from which a long bone goes on down, as no foot does."""
    tree = draft.tree
    for over, node, under in zip(path, path[1:], path[2:], strict=False):
        back = beside(tree, (over, node, under)).dot(draft.facing) < -ZIGZAG
        down = (tree.at[node] - tree.at[under]).unit.dot(draft.up) > _DOWN
        if back and down and tree.bone[under] > _LONG * tree.bone[node]:
            return True
    return False


def may_be_a_thing(draft: Draft, each: Found) -> str:
    """Legs and arms without names of which nothing shows that they live: lamps and cranes have such."""
    mine, body = each.pair, draft.shape.body
    if mine is None or body is None or body.legs is None or body.arms is None:
        return ""
    return "" if mine.named > 0.0 or mine.kind else _no_life(draft)


@once
def _no_life(draft: Draft) -> str:
    """That nothing shows of a body with legs and arms that it lives."""
    body = draft.shape.body
    if body is None or body.legs is None or body.arms is None or _has_names_of_bodies(draft):
        return ""
    if body.form == "quadruped":
        pairs = [limbs for limbs in (body.legs, body.arms) if not _go_down(draft, limbs, _CARRIES)]
        return "its legs go aside, as those of a thing may" if pairs else ""
    if max(body.legs.fingers, body.arms.fingers) >= 2 or _has_legs_that_live(draft, body, body.legs):
        return ""
    if _has_shoulders_and_neck(draft.tree, body.arms):
        return ""
    return "nothing shows that it is of a body and not of a thing: no fingers, feet, shoulders or motion"


def _go_down(draft: Draft, legs: Limbs, far: float = _STANDS) -> bool:
    """Whether both legs of a pair go down so far (a cosine), or their lower bones do, as those of lizards."""
    at = draft.tree.at
    ways = [[(at[k] - at[joints[-1]]).unit for k in joints[:-1]] for joints in map(legs.joints, (0, 1))]
    return all(max(way.dot(draft.up) for way in each) > far for each in ways)


def _has_names_of_bodies(draft: Draft) -> bool:
    """Whether any name is of a part of a body."""
    if draft.reading is not None and draft.reading.bones:
        return True
    return any(word.levels or word.trunk for word in draft.words.values())


def _has_legs_that_live(draft: Draft, body: Body, legs: Limbs) -> bool:
    """Whether feet point ahead, clips bend both knees, or legs bend to and fro."""
    tree, moving = draft.tree, draft.poses.moving
    if len(moving) and len(legs.at) == 3:
        bends = (bend_angle(*(moving[:, k] for k in legs.joints(which))) for which in (0, 1))
        if min(float(angles.max() - angles.min()) for angles in bends) > _MOVED:
            return True
    if not _go_down(draft, legs):
        return False  # what goes aside ends in no foot
    to_and_fro = all(bends_to_and_fro(tree, path, draft.facing) for path in legs.pair.paths)
    return to_and_fro or abs(feet_ahead(tree, body, draft.facing, draft.poses)) > _POINTED


def _has_shoulders_and_neck(tree: Tree, arms: Limbs) -> bool:
    """Whether short clavicles lead to both arms, and two joints go on beside them: neck and head."""
    for path in arms.pair.paths:
        start, middle = arms.at[0], arms.at[1]
        upper = tree.at[path[middle]].distance(tree.at[path[start]])
        if start == 0 or tree.bone[path[start]] > _CLAVICLE * upper:
            return False
    others = (k for k in tree.below.get(arms.pair.above, ()) if k not in arms.pair.nodes)
    return any(len(tree.paths[k]) > 1 for k in others)


def bends_to_and_fro(tree: Tree, path: Sequence[int], ahead: Vector) -> bool:
    """Whether the joints of a leg stand ahead of the line of their neighbours and behind it by turns."""
    aside = [beside(tree, joints).dot(ahead) for joints in zip(path, path[1:], path[2:], strict=False)]
    return max(aside, default=0.0) > ZIGZAG and min(aside, default=0.0) < -ZIGZAG


def is_alive(draft: Draft, body: Body | None) -> bool:
    """Whether the hind legs bend to and fro, as no table's, and one end of the trunk has a head."""
    plane = draft.shape.plane
    if body is None or body.legs is None or plane is None or not any(draft.facing):
        return False
    paths = body.legs.pair.paths
    to_and_fro = all(bends_to_and_fro(draft.tree, path, draft.facing) for path in paths)
    return to_and_fro and head_end(draft.tree, body, plane, draft.poses, draft.shape.limbs) != 0
