"""mirror, and one module for each kind of thing that it mirrors.

Every kind is built by the operation that builds it on the first side (make-limb, add-twist, add-controls, …),
with mirrored options; only what `symmetry_check` measures is not built. Mirror modes and the mirror
plane live in `rigtri.frames`, for orient-joints mirrors axes, too.
"""
