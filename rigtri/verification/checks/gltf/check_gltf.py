"""All checks of a glTF, VRM or VRMA file, one after the other."""

from __future__ import annotations

from pathlib import Path

from rigtri.errors import FileError, RigtriError
from rigtri.formats import ReadOptions
from rigtri.formats.gltf.container import Container, open_container
from rigtri.formats.gltf.document import GltfDocument
from rigtri.formats.gltf.structure import unknown_required
from rigtri.formats.gltf.uris import absent
from rigtri.formats.json_values import short_repr
from rigtri.model.rig import Rig
from rigtri.progress import as_share, counted
from rigtri.text import is_number
from rigtri.verification.checks.axis_check import LEAST_JOINTS, check_axes
from rigtri.verification.checks.clip_check import MAYBE_FAR, check_clips
from rigtri.verification.checks.cycle_check import WAITING, check_cycles
from rigtri.verification.checks.driven_check import check_adrift, check_driven, check_twist
from rigtri.verification.checks.findings import Findings
from rigtri.verification.checks.gltf import (
    animations,
    meshes,
    nodes,
    references,
    skins,
    spring_bones,
    vrm,
)
from rigtri.verification.checks.gltf.tolerant_reader import View
from rigtri.verification.checks.metadata_check import broken, unknown

# How much of the time goes into checks of the file; those of the rig that it holds have the rest.
_OF_FILE = 0.7
_NOTICES = {"glb-length": "gltf.glb.length", "byte-order-mark": "gltf.json.byte-order-mark"}


def check_gltf(path: Path, findings: Findings, *, allow_external: bool = False) -> Rig | None:
    """Note all that is wrong with a file: its rig, where that was looked at.

    FileError where it is no glTF at all.
    """
    container = _opened(path, findings)
    try:
        view = View(container, findings, allow_external=allow_external)
        checks = (
            _check_extensions,
            references.check,
            _check_files,
            nodes.check,
            skins.check,
            animations.check,
            nodes.check_joints,
            meshes.check,
            meshes.check_vertices,
            references.check_types,
            vrm.check,
            spring_bones.check,
            _check_metadata,
        )
        with as_share(0.0, _OF_FILE):
            for check in counted(checks, "checks"):
                check(view)
        with as_share(_OF_FILE, 1.0):
            return _check_rig(view, findings, allow_external=allow_external)
    except RecursionError:
        raise FileError(f"{path}: the JSON is nested too deep") from None


def _check_rig(view: View, findings: Findings, *, allow_external: bool) -> Rig | None:
    """What only a rig shows. A file that cannot be read as one has findings of other rules."""
    waits = _waits(view)
    joints = (skin.get("joints") for skin in view.lists["skins"])
    least = 1 if view.largest_key > MAYBE_FAR else LEAST_JOINTS
    if not waits and not any(isinstance(each, list) and len(each) >= least for each in joints):
        return None
    try:
        options = ReadOptions(allow_external_paths=allow_external, empty=True)
        rig = GltfDocument(view.container, options, accessors=view.accessors).rig
    except RigtriError:
        return None
    if waits:
        check_cycles(rig, "gltf.note.circle", findings)
        check_driven(rig, "gltf.note.driven-twice", findings)
        check_adrift(rig, "gltf.note.broken", findings)
        check_twist(rig, "gltf.note.broken", findings)
    check_axes(rig, findings)
    check_clips(rig, findings)
    return rig


def _opened(path: Path, findings: Findings) -> Container:
    """The parts of a file; of one that only a lenient reader opens, with what is wrong with it."""
    try:
        container = open_container(path)
    except FileError as error:
        container = open_container(path, lenient=True)
        if "glb-length" not in {notice.code for notice in container.notices}:
            text = str(error).removeprefix(f"{path}: this is not valid JSON: ")
            findings.add("gltf.json.key-twice", "file", "", text)
    for notice in container.notices:
        if notice.code in _NOTICES:
            findings.add(_NOTICES[notice.code], "file", "", notice.text)
    return container


def _check_extensions(view: View) -> None:
    used, required = (_texts(view, key) for key in ("extensionsUsed", "extensionsRequired"))
    for name in unknown_required(required):
        text = f"the file requires {name}, which rigtri does not know"
        view.add("gltf.extension.required-unknown", "file", "/extensionsRequired", text)
    for name in sorted(required - used):
        text = f"{name} is required, but not in extensionsUsed"
        view.add("gltf.extension.undeclared", "file", "/extensionsUsed", text)
    view.file.object("extensions")
    # Most files have none: their text says so at once, unless it spells letters by their numbers.
    text = view.container.text
    found = references.extensions(view.raw) if '"extensions"' in text or "\\u" in text else {}
    for name, where in sorted(found.items()):
        if name not in used | required:
            text = f"{name} is used at {where}, but not in extensionsUsed"
            view.add("gltf.extension.undeclared", "file", "/extensionsUsed", text)


def _check_files(view: View) -> None:
    """What the file refers to, besides its buffers."""
    for path, why in absent(view.raw, view.container.path):
        place = f"image #{path[1]}" if path[0] == "images" else "file"
        view.add("gltf.file.missing", place, "/" + "/".join(map(str, path)), why)


def _texts(view: View, key: str) -> set[str]:
    found = set()
    for number, item in enumerate(view.file.items(key)):
        if isinstance(item, str):
            found.add(item)
        else:
            place = f"{key}/{number}"
            view.file.add("gltf.json.value", f"/{place} should be a text, not {short_repr(item)}", place)
    return found


def _check_metadata(view: View) -> None:
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


def _waits(view: View) -> bool:
    """Whether some node follows or moves another one."""
    stored = [extras.get("rigtri") for node in view.nodes if isinstance(extras := node.get("extras"), dict)]
    return any(isinstance(note, dict) and note.get("type") in WAITING for note in stored)


def _address(view: View, name: str) -> bool:
    """Whether NAME#INDEX is a node of that name, or a path ends in a name, or #INDEX of a nameless node."""
    word, _, number = name.rpartition("#")
    if is_number(number) and int(number) < len(view.nodes):
        own = view.nodes[int(number)].get("name")
        if not word or own == word or (not own and name.startswith("/") and word.endswith("/")):
            return True
    last = name.rpartition("/")[2]
    return name.startswith("/") and any(node.get("name") == last for node in view.nodes)
