"""glTF 2.0, in .glb, .gltf, .vrm and .vrma files.

`document` is a file that was read, and writes it. Below it, `container`, `buffers` and `accessors` have the
bytes, the modules named *_reader fill a rig, those named *_writer change a copy of the JSON
(`json_copy_on_write`) where a rig differs. `rules` has what a file must keep to. Nothing here compares two
rigs or knows an operation; what VRM adds is read in `rigtri.formats.vrm`.
"""
