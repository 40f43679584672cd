"""What may be wrong with what is bound to the skeletons of a USD stage, and with blend shapes.

Source: UsdSkelBindingAPI; UsdSkelBlendShape.
"""

from __future__ import annotations

from rigtri.verification.checks.findings import Rule

_AGAIN = "Export the file anew with the program that wrote it."

RULES = (
    Rule(
        "usd.binding.skeleton",
        "error",
        "skel:skeleton points at nothing, or at a prim that is no Skeleton.",
        "Bind it to a Skeleton, or remove the relationship.",
    ),
    Rule(
        "usd.binding.animation",
        "error",
        "skel:animationSource points at nothing, or at a prim that is no SkelAnimation.",
        "Bind it to a SkelAnimation, or remove the relationship.",
    ),
    Rule(
        "usd.binding.inactive",
        "info",
        "skel:animationSource points at an animation that is not active, so UsdSkel plays none.",
        "Nothing needs to be done; activate it to play it.",
    ),
    Rule(
        "usd.binding.many-targets",
        "warning",
        "skel:skeleton or skel:animationSource has several targets; UsdSkel takes the first.",
        "Keep one target.",
    ),
    Rule(
        "usd.binding.no-skelroot",
        "error",
        "A prim with joint influences is not below a SkelRoot, so UsdSkel does not skin it.",
        "Put it below a SkelRoot.",
    ),
    Rule(
        "usd.binding.no-skeleton",
        "error",
        "A prim with joint influences is bound to no skeleton, here or above.",
        "Give it, or a prim above it, skel:skeleton.",
    ),
    Rule(
        "usd.binding.api",
        "warning",
        "A prim has skel: properties without SkelBindingAPI in its apiSchemas; newer USD passes over them.",
        'Add prepend apiSchemas = ["SkelBindingAPI"].',
    ),
    Rule(
        "usd.binding.method",
        "error",
        "skel:skinningMethod is none that UsdSkel knows.",
        "Use classicLinear or dualQuaternion.",
    ),
    Rule(
        "usd.binding.bind-transform",
        "error",
        "primvars:skel:geomBindTransform has no inverse, or values that are no numbers.",
        "Bind the mesh again.",
    ),
    Rule(
        "usd.binding.joint-unknown",
        "error",
        "skel:joints of a prim names a joint that its skeleton does not have.",
        "Bind the mesh again, or rename the joint in both places.",
    ),
    Rule(
        "usd.binding.index",
        "error",
        "A joint index is negative or beyond the joints.",
        "Bind the mesh again.",
    ),
    Rule(
        "usd.binding.element-size",
        "error",
        "The elementSize of joint indices and weights differ, are below 1, or do not divide their number.",
        "Write the number of influences of a point as the elementSize of both.",
    ),
    Rule(
        "usd.binding.count",
        "error",
        "Joint indices and weights are not as many as each other, or as points (or one) times elementSize.",
        "Bind the mesh again.",
    ),
    Rule(
        "usd.binding.interpolation",
        "error",
        "Joint indices and weights must be interpolated both vertex or both constant.",
        "Use vertex, or constant for a mesh that moves as one.",
    ),
    Rule(
        "usd.binding.weight-nan", "error", "A weight is not a number, or is infinite.", "Bind the mesh again."
    ),
    Rule("usd.binding.weight-negative", "error", "A weight is negative.", "Normalise the weights again."),
    Rule(
        "usd.binding.weight-sum",
        "warning",
        "The weights of a point do not sum to 1, which UsdSkel does not mend.",
        "Normalise the weights again.",
    ),
    Rule(
        "usd.binding.weight-zero",
        "warning",
        "All weights of a point are zero: it does not move with any joint.",
        "Weight the point to a joint.",
    ),
    Rule(
        "usd.blend.targets",
        "error",
        "skel:blendShapes and skel:blendShapeTargets are not as many as each other.",
        "Write one target for each name.",
    ),
    Rule(
        "usd.blend.target",
        "error",
        "A blend shape target is not there, or no BlendShape.",
        "Point it at a BlendShape prim.",
    ),
    Rule(
        "usd.blend.offsets",
        "error",
        "A blend shape has not as many offsets as points, or as point indices.",
        _AGAIN,
    ),
    Rule(
        "usd.blend.point",
        "error",
        "A blend shape moves a point that its mesh does not have.",
        _AGAIN,
    ),
)
