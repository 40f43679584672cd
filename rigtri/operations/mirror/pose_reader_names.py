"""Names of mirrored pose readers: a joint may have several, so its own name does not suffice."""

from __future__ import annotations

from rigtri.model.joint_names import Side, twin
from rigtri.model.rig import Rig
from rigtri.operations.mirror.mirrored_metadata import other, side

_SUFFIX = {"left": "_R", "right": "_L"}
_OTHER: dict[Side, Side] = {"left": "right", "right": "left", "": ""}


def reader_names(rig: Rig, from_side: Side) -> dict[int, str]:
    """The names of the twins of all pose readers of one side, each its own.

    With the sides swapped, else with the driver's twin's side behind it; numbered where another
    has that name. A twin whose name has come about from the other side is known by that.
    """
    back = _forth(rig, _OTHER[from_side])
    called = {_name(rig, node): node for node in _readers(rig)}
    names = _forth(rig, from_side)
    for source, name in back.items():
        here = called.get(name)
        if here in names and called.get(names[here]) is None and _paired(rig, source, here):
            names[here] = _name(rig, source)
    return names


def reader_twin(rig: Rig, node: int) -> int | None:
    """The pose reader of the other side; None where there is none."""
    target = reader_names(rig, _side(rig, node)).get(node)
    found = (k for k in _readers(rig) if _name(rig, k) == target)
    return next((k for k in found if _paired(rig, node, k)), None)


def _forth(rig: Rig, from_side: Side) -> dict[int, str]:
    """The names as the readers of one side, in the order of the names, give them."""
    mine = [node for node in _readers(rig) if _side(rig, node) == from_side]
    names: dict[int, str] = {}
    called = {*rig.names} | {_name(rig, k) for k in _readers(rig)}
    # Names that say a side first: theirs are swapped, and the others make room.
    for node in sorted(mine, key=lambda k: (twin(_name(rig, k)) == _name(rig, k), _name(rig, k))):
        own = _name(rig, node)
        target = twin(own) if twin(own) != own else f"{own}{_SUFFIX.get(from_side, '')}"
        twins = {_name(rig, k) for k in _readers(rig) if _paired(rig, node, k)}
        taken = {*names.values()} | (called - twins)
        name, count = target, 2
        while name in taken:
            name, count = f"{target}_{count}", count + 1
        names[node] = name
    return names


def _readers(rig: Rig) -> list[int]:
    return rig.nodes_of("poseReader")


def _side(rig: Rig, node: int) -> Side:
    driver = rig.known(str(rig.metadata[node].get("driver")))
    return "" if driver is None else side(rig, driver)


def _name(rig: Rig, node: int) -> str:
    return str(rig.metadata[node].get("name"))


def _paired(rig: Rig, one: int, two: int) -> bool:
    """Whether two readers read a joint and its twin."""
    here, there = (rig.known(str(rig.metadata[node].get("driver"))) for node in (one, two))
    return here is not None and there is not None and there == other(rig, here) and here != there
