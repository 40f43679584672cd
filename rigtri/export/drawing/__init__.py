"""Pictures: a posed rig as lines, arrows and triangles in space; those seen from somewhere; and SVG of it.

`primitives` are the marks to be seen, `scene` takes them from a rig, `silhouette` from its meshes; `svg`
writes them. Whoever draws otherwise, such as a page with a camera of its own, takes the same marks as JSON.
"""
