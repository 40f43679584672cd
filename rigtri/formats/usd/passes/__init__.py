"""The passes of the writer: one module each, with one public function that takes a `UsdEdit`.

A pass adds edits to it or brings its rig into terms of the stage; the order is the list in `run_passes`.
Passes do not import each other, and none writes to a layer.
"""
