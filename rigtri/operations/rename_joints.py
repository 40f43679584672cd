"""rename-joints: recognised joints get the names of a scheme, and all that names them follows."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import replace
from itertools import count
from typing import Any

import numpy as np

from rigtri.errors import FileError, GeometryError, NameNotFoundError, UsageError
from rigtri.model.rig import Rig
from rigtri.operations.joint_records import joint_record
from rigtri.operations.operation import operation
from rigtri.operations.options.rename_joints import RenameJointsOptions as RenameJointsOptions
from rigtri.operations.rigtri_nodes import given_name, readdressed
from rigtri.recognition.layout import CONFIDENT, Part
from rigtri.recognition.one_character import listed
from rigtri.recognition.recognise import recognise
from rigtri.recognition.written_names import are_synonyms, written_chains, written_names
from rigtri.report import Report
from rigtri.text import and_more, list_names

FORMAT = "rigtri names 1"


@operation(RenameJointsOptions)
def rename_joints(rig: Rig, *, options: RenameJointsOptions, report: Report) -> Rig:
    """The rig with other names of joints; nodes keep their places, and nothing moves.

    Metadata of rigtri, maps of characters and joint tokens follow; what each was called is in
    ``report.joints``. Raises GeometryError for joints of which it is not sure what they are, UsageError for
    names that several would have, NameNotFoundError for joints that are not there.
    """
    mapped = list(_of_map(rig, options, report))
    names = {node: name for node, name, _ in mapped} | dict(_of_scheme(rig, options))
    if options.to is not None:
        _warn_unnamed_trunk(rig, names, report)
    names = {node: name and rig.rules.valid_name(name) for node, name in names.items()}
    names |= {
        rig.find(joint): given_name(rig, name, report, f"--name {joint}=")
        for joint, name in options.name.items()
    }
    if options.to is not None:
        kept = {rig.names[node] for node in np.flatnonzero(rig.is_joint).tolist() if node not in names}
        # Several names of MMD are hips: 腰 stays so below a センター.
        again = {k for k, name in names.items() if are_synonyms(options.to, name, rig.names[k])}
        names = {k: name for k, name in names.items() if name not in kept or k not in again}
    _refuse_clashes(rig, names, {node for node, _, shared in mapped if shared})
    names = {node: name for node, name in names.items() if rig.names[node] != name}
    _refuse_taken(rig, names, [rig.find(joint) for joint in options.name])
    if not names:
        return rig
    _warn_shared(rig, names, report)
    after = renamed(rig, names)
    for node, name in sorted(names.items()):
        known = {"name": name, "was": rig.names[node], "now": after.address(node)}
        report.joints.append(joint_record(rig, node, "renamed", **known))
    return after


def renamed(rig: Rig, names: Mapping[int, str]) -> Rig:
    """The rig with names of nodes, and metadata that finds them by these."""
    after = replace(rig, names=tuple(names.get(node, name) for node, name in enumerate(rig.names)))
    return readdressed(rig, after, {node for top in names for node in rig.below(top)})


def set_aside(rig: Rig, to: str) -> dict[str, str]:
    """New names, by address, of joints that are no bones and have names that bones will have."""
    bones = dict(_of_scheme(rig, RenameJointsOptions(to=to)))
    taken: dict[int, set[str]] = {}
    found = {}
    for node in np.flatnonzero(rig.is_joint).tolist():
        name = rig.names[node]
        if node not in bones and name in bones.values():
            skeleton = rig.skeleton_of[node]
            used = taken.setdefault(skeleton, {*bones.values(), *rig.names_beside(skeleton)})
            found[rig.address(node)] = _free(name, used)
            used.add(found[rig.address(node)])
    return found


def _free(name: str, taken: Collection[str]) -> str:
    return next(each for k in count(2) if (each := f"{name}_{k}") not in taken)


def names_json(report: Report) -> dict[str, Any]:
    """What --save-map writes: by the address that each joint had its new name.

    And by the address that it has its old name, where the names alone do not lead back: several share one,
    or one looks as an address does.
    """
    names = {each["address"]: each["name"] for each in report.joints}
    plain = {"was": "address", "now": "name"}
    back = {
        each["now"]: each["was"]
        for each in report.joints
        if any(each[side] != each[name] for side, name in plain.items())
        or _called(each["address"]) != each["was"]
    }
    return {"format": FORMAT, "names": names, **({"back": back} if back else {})}


def _called(address: str) -> str:
    """The name of a node by its address; one without a name was found by its number."""
    return re.sub("^#[0-9]+$", "", address.rpartition("/")[2])


def _of_map(rig: Rig, options: RenameJointsOptions, report: Report) -> Iterator[tuple[int, str, bool]]:
    """Nodes and names of a map, and whether several had that name; those that the file has not are left out.

    NameNotFoundError for a map of others alone: none has its old name here, nor its new one.
    """
    if options.map is None:
        return
    table, back = _tables(options.map)
    # What --save-map writes of a joint that had no name leads back by its number.
    if empty := [old for old, new in table.items() if not new and old not in back.values()]:
        raise FileError(f"--map: '{empty[0]}' has no new name there. Give it one, or leave it out")
    plain = {new: _called(old) for old, new in table.items()}
    found = (plain | back) if options.inverse else table
    # Their addresses are more than their names: these did not suffice.
    shared = {*back, *(new for old, new in table.items() if plain[new] != old)} if options.inverse else set()
    if found and not any(map(rig.has, found)):
        later = set(found.values())
        if not (there := sum(map(rig.has, later))):
            raise NameNotFoundError("joint that --map renames", next(iter(found)), rig.names)
        if there < len(later):
            text = f"Of the joints that --map renames, {there} of {len(later)} have their new names already"
            report.warn("map-unknown", f"{text}, and the others are not here: is it of another skeleton?")
    for name, new in found.items():
        node = rig.known(name)
        if node is not None:
            yield node, new, name in shared


def _tables(read: Mapping[str, Any]) -> Iterator[dict[str, str]]:
    """The tables of a map: of new names, and of those that lead back. FileError for what is no map."""
    for key, default in (("names", None), ("back", {})):
        table = read.get(key, default) if isinstance(read, Mapping) else None
        if not isinstance(table, Mapping) or not all(isinstance(name, str) for name in table.values()):
            raise FileError(
                '--map: this is not a map of names: use {"names": {"old": "new", …}}, as --save-map writes'
            )
        yield dict(table)


def _of_scheme(rig: Rig, options: RenameJointsOptions) -> Iterable[tuple[int, str]]:
    """Nodes of recognised bones and their names in the scheme."""
    if options.to is None:
        return
    written = written_names(options.to, sided=options.side_style)
    inside = set(range(len(rig))) if options.below is None else set(rig.below(rig.find(options.below)))
    inside -= {node for glob in options.exclude for node in rig.match(glob)}
    inside -= {rig.find(joint) for joint in options.name}
    bones = [part for part in _bones(rig) if part.joint in inside]
    # A joint that has its name already needs no more evidence.
    new = [part for part in bones if rig.names[part.joint] != written.get(part.bone)]
    unsure = [f"{rig.title(part.joint)} as {part.bone}" for part in new if part.confidence < CONFIDENT]
    if unsure:
        raise GeometryError(
            f"It is not sure what these joints are: {and_more(unsure, 6)}. Name each with --name JOINT=NAME, "
            "or leave it out with --exclude; see why with: rigtri recognise FILE --joints"
        )
    names = {part.joint: written[part.bone] for part in bones if part.bone in written}
    for node, name in (names | _long_chains(rig, options.to, names.keys(), inside)).items():
        yield node, name if options.prefix is None else options.prefix + name.rpartition(":")[2]


def _long_chains(rig: Rig, to: str, named: Collection[int], inside: Collection[int]) -> dict[int, str]:
    """The names of spines and necks that have more joints than bones, where the scheme has so many."""
    found, written = dict[int, str](), written_chains(to)
    for character in recognise(rig).characters:
        for chain in character.chains:
            names, joints = written.get(chain.kind, ()), chain.joints
            more = any(node not in named for node in joints) and any(node in named for node in joints)
            if more and chain.is_sure and len(joints) <= len(names) and {*joints} <= {*inside}:
                found |= dict(zip(joints, names, strict=False))
    return found


def _warn_unnamed_trunk(rig: Rig, names: Collection[int], report: Report) -> None:
    """Warn of joints of a spine that keep their names among others: a scheme has three."""
    for character in recognise(rig).characters:
        spine = [joint for chain in character.chains if chain.kind == "spine" for joint in chain.joints]
        left = [rig.title(joint) for joint in spine if joint not in names]
        if 0 < len(left) < len(spine):
            text = f"{and_more(left, 6)} of the spine: no new name, for the scheme has fewer joints there. "
            mend = f"merge them before: rigtri merge-joints --keep-children --joints {left[0]}"
            report.warn("spine-unnamed", f"{text}Name each with --name JOINT=NAME, or {mend}")


def _bones(rig: Rig) -> list[Part]:
    """The joints that are bones of bodies. GeometryError where there is none."""
    layout = recognise(rig)
    found = [part for character in layout.characters for part in character.parts if part.bone]
    if not found:
        why = f"No character is recognised here: {'; '.join(layout.remarks) or 'no joint is recognised'}"
        if layout.characters:
            why = f"No bone of the characters here, {listed(rig)}, is recognised"
        raise GeometryError(f"{why}. Give names with --name or --map")
    return found


def _refuse_clashes(rig: Rig, names: Mapping[int, str], back: Collection[int]) -> None:
    """UsageError for a name that two joints would have. back: those that get one back that several had."""
    joints = {*np.flatnonzero(rig.is_joint).tolist(), *names}
    taken: dict[tuple[int, str], int] = {}
    for node in sorted(joints):
        name = names.get(node, rig.names[node])
        first = taken.setdefault((rig.skeleton_of[node], name), node)
        if name and first != node and (node in names or first in names):
            pair = f"'{rig.title(first)}' and '{rig.title(node)}'"
            if rig.names[node] == rig.names[first] or node in back or first in back:
                continue  # they shared one before
            other = min((node, first), key=names.__contains__)
            raise UsageError(
                f"{pair} would both be called '{name}'. Name one of them with --name, e.g. --name "
                f"'{rig.address(other)}={_free(name, {*rig.names, *names.values()})}', or leave "
                "one out with --exclude; of two characters rename one at a time with --below NAME"
            )


def _warn_shared(rig: Rig, names: Mapping[int, str], report: Report) -> None:
    """Warn of new names that the node of a mesh, camera or light has, too: engines may find that one."""
    new = {*names.values()} - {""}
    shows = np.flatnonzero((rig.attachment >= 0) & ~rig.is_joint).tolist()
    others = [node for node in shows if rig.names[node] in new and node not in names]
    if others and not rig.rules.sized_binding:  # prims of USD are no joints
        free = f"rigtri rename-joints --name '#{others[0]}={_free(rig.names[others[0]], {*rig.names, *new})}'"
        report.warn(
            "shared-name",
            f"Nodes of meshes, cameras or lights are called {list_names(rig.names[k] for k in others)}, too. "
            f"Unity and three.js find joints by their names alone: rename those, e.g. with {free}",
        )


def _refuse_taken(rig: Rig, names: Mapping[int, str], given: Iterable[int]) -> None:
    """UsageError for a name given to one joint that another node of the file has and keeps.

    Prims of USD are no joints, and may be called as one.
    """
    for node in given:
        name = names.get(node, "")
        beside = rig.beside(int(rig.parents[node])) if name else ()
        others = [k for k in beside if rig.names[k] == name and k not in names]
        if any(rig.is_joint[k] or not rig.rules.sized_binding for k in others):
            raise UsageError(f"--name {rig.title(node)}={name}: another node is called so")
