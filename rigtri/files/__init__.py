"""Files as the operating system knows them: how they appear, where temporary ones lie, who works on them.

`atomic_write` lets one file appear whole, `staged_output` an output with its companions, all or none, and
`buffer_files` removes those of a .gltf that nobody needs; `background_copy` copies large files meanwhile,
`temp_dirs` has temporary folders that are gone with their process, `worker_process` a child that may crash,
`working_folder` and `import_path` where a program and its children look for modules, `input_stream` and
`text_files` open what users name, `mapped_file` maps what is large, and `freed_memory` gives back what many
small things took.
Nothing here knows a rig or a format; of other packages it imports errors and printable text alone.
"""
