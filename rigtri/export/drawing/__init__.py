"""Pictures: a posed rig as lines, arrows and triangles in space; those seen from somewhere; and SVG of it.

`marks` is what there is to see, `scene` takes it from a rig, `outline` from its meshes; `svg` writes
it. Whoever draws otherwise, such as a page with a camera of its own, takes the same marks as JSON.
"""
