"""What VRM adds to glTF: humanoid bones, offsets in the axes of nodes, node constraints, facts of avatars.

Readers of the JSON of a glTF file; files themselves are read and written in `rigtri.formats.gltf`.
"""
