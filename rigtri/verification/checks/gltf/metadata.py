"""What rigtri stored on nodes: whether it can still be read, and its joints are there."""

from __future__ import annotations

from rigtri.verification.checks.cycle_check import WAITING
from rigtri.verification.checks.gltf.tolerant_reader import View
from rigtri.verification.checks.metadata_check import broken, unknown


def check(view: View) -> None:
    """The ``extras.rigtri`` of all nodes."""
    known = {node["name"] for node in view.nodes if isinstance(node.get("name"), str)}
    for index, node in enumerate(view.nodes):
        extras = node.get("extras")
        if isinstance(extras, dict) and "rigtri" in extras:
            why = broken(extras["rigtri"], lambda name: name in known or _address(view, name))
            newer = unknown(extras["rigtri"])
            if why or newer:
                rule = "gltf.note.broken" if why else "gltf.note.unknown"
                view.add(rule, view.title(index), f"/nodes/{index}/extras/rigtri", why or newer)


def waiting(view: View) -> bool:
    """Whether some node follows or moves another one."""
    stored = [extras.get("rigtri") for node in view.nodes if isinstance(extras := node.get("extras"), dict)]
    return any(isinstance(note, dict) and note.get("type") in WAITING for note in stored)


def _address(view: View, name: str) -> bool:
    """Whether a path ends in a node's name, or NAME#INDEX is a node of that name."""
    word, _, number = name.rpartition("#")
    if not number.isdecimal():
        last = name.rpartition("/")[2]
        return name.startswith("/") and any(node.get("name") == last for node in view.nodes)
    index = int(number)
    return index < len(view.nodes) and (not word or view.nodes[index].get("name") == word)
