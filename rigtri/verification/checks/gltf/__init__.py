"""The check of glTF, VRM and VRMA files, one module for each part of a file.

`tolerant_reader` reads what is broken and notes why; the other modules look at what it could read. Rules that
the reader of the format refuses files by are in `rigtri.formats.gltf.rules`, each once; here is what only a
check reports. Nothing here changes a file.
"""
