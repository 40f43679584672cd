"""USD files: `document` reads a file and writes it.

Everything below imports one way: `run_passes` (the list of passes) and `layer_writer` (where edits are
written) → `passes` → `opinions` → `reading` → `composition` → `crate`, `text` and `usdz`, which know
bytes alone. What both formats need belongs into `formats`, what no file is about into
`model`; operations are not known here.
"""
