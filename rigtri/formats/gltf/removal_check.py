"""What must hold for a glTF file before entries of it are removed, and others counted anew.

Lists that no rig needs are not looked at when a file is read; here each number that may change is.
"""

from __future__ import annotations

from rigtri.formats.json_values import Value

# List, list in its entries ("" for the entries themselves), key, and the list that the key's number counts.
_INDICES = (
    ("nodes", "", "mesh", "meshes"),
    ("meshes", "primitives", "material", "materials"),
    ("accessors", "", "bufferView", "bufferViews"),
    ("bufferViews", "", "buffer", "buffers"),
)
# List, and the keys of its entries that are sizes or places in bytes.
_COUNTS = (("accessors", ("byteOffset", "count")), ("bufferViews", ("byteOffset", "byteLength")))


def check_before_removal(gltf: Value) -> None:
    """FileError, with the place, for what is no index, count or object where one should stand."""
    for section, inner, key, kind in _INDICES:
        among = sum(1 for _ in gltf.each(kind))
        for entry in gltf.each(section):
            for holder in entry.each(inner) if inner else (entry,):
                if holder.get(key) is not None:
                    _whole(holder.need(key)).index(among, kind.removesuffix("s"))
    for section, keys in _COUNTS:
        for entry in gltf.each(section):
            for key in keys:
                if key in entry.object():
                    _whole(entry.need(key)).count()
    for material in gltf.each("materials"):
        material.object()
    for animation in gltf.each("animations"):
        for channel in animation.each("channels"):
            if "target" in channel.object():
                target = channel.need("target")
                if target.get("node") is not None:
                    _whole(target.need("node")).count()


def _whole(value: Value) -> Value:
    """The value, if it is a whole number: 3.0 is none where it becomes the place in a list."""
    if type(value.raw) is not int:
        value.fail(f"a whole number should stand here, not {value.raw!r:.40}")
    return value
