"""What may be wrong with the animations and the influences of meshes of a glTF file.

Source: glTF 2.0; docs of the Khronos validator for what engines refuse.
"""

from __future__ import annotations

from rigtri.formats.rules import Rule

_AGAIN = "Export the file anew with the program that wrote it."

RULES = (
    Rule(
        "gltf.animation.empty",
        "warning",
        "An animation has no channels.",
        "Remove it.",
    ),
    Rule(
        "gltf.animation.sampler-missing",
        "error",
        "A channel names a sampler that its animation does not have.",
        _AGAIN,
    ),
    Rule(
        "gltf.animation.node-missing",
        "error",
        "A channel drives a node that the file does not have.",
        _AGAIN,
    ),
    Rule(
        "gltf.animation.without-node",
        "info",
        "A channel names no node and nothing else that is known; it is kept and never read.",
        "Remove the channel where no extension uses it.",
    ),
    Rule(
        "gltf.animation.path-unknown",
        "warning",
        "A channel drives a property that glTF does not know; it is kept and never read.",
        "Use translation, rotation, scale, weights or pointer.",
    ),
    Rule(
        "gltf.animation.interpolation-unknown",
        "error",
        "A sampler has an interpolation that glTF does not know.",
        "Use LINEAR, STEP or CUBICSPLINE.",
    ),
    Rule(
        "gltf.animation.target-twice",
        "error",
        "Two channels of an animation drive one property (a pointer to it counts too): which wins is open.",
        "Remove one of them.",
    ),
    Rule(
        "gltf.animation.output-count",
        "error",
        "The number of values does not fit the number of times (three for each time in CUBICSPLINE).",
        _AGAIN,
    ),
    Rule(
        "gltf.animation.output-type",
        "error",
        "The times are no single floats, or the values have the wrong type for what a channel drives; values "
        "of pointers are not looked at.",
        _AGAIN,
    ),
    Rule(
        "gltf.animation.times-nan",
        "error",
        "A key time is not a number.",
        _AGAIN,
    ),
    Rule(
        "gltf.animation.times-order",
        "error",
        "A key does not come after the one before it.",
        "Sort the keys, or export the animation anew; --lenient accepts equal times.",
    ),
    Rule(
        "gltf.animation.times-negative",
        "error",
        "A key comes before time 0, which glTF forbids.",
        "Move the clip so that it starts at 0 or later.",
    ),
    Rule(
        "gltf.animation.times-without-bounds",
        "warning",
        "The times of a sampler have no min and max, which glTF asks for and players take the length from.",
        _AGAIN,
    ),
    Rule(
        "gltf.animation.value-nan",
        "error",
        "A key is not a number, or is infinite.",
        _AGAIN,
    ),
    Rule(
        "gltf.animation.rotation-zero",
        "error",
        "A rotation key is 0 0 0 0, which is no rotation.",
        _AGAIN,
    ),
    Rule(
        "gltf.animation.rotation-not-unit",
        "warning",
        "Rotation keys are not unit quaternions; engines differ in what they make of them.",
        "Normalise them.",
    ),
    Rule(
        "gltf.animation.rotation-flips",
        "warning",
        "Neighbouring rotation keys of a CUBICSPLINE have opposite signs: it goes the long way.",
        "Give neighbouring quaternions the same sign before the tangents are made, or export as LINEAR.",
    ),
    Rule(
        "gltf.animation.rotation-half-turn",
        "info",
        "Neighbouring rotation keys are half a turn apart, so that rounding decides which way round it goes.",
        "Set a key between them.",
    ),
    Rule(
        "gltf.mesh.joints-without-weights",
        "error",
        "A primitive has a set of joints without weights, weights without joints, or leaves a set out.",
        _AGAIN,
    ),
    Rule(
        "gltf.mesh.influence-type",
        "error",
        "Joints or weights have a type that glTF does not allow for them.",
        "Store joints as unsigned bytes or shorts, weights as floats or normalised unsigned integers.",
    ),
    Rule(
        "gltf.mesh.influence-count",
        "error",
        "A primitive has not as many joints or weights as positions.",
        _AGAIN,
    ),
    Rule(
        "gltf.mesh.joint-out-of-range",
        "error",
        "A point is moved by a joint that the skin does not have.",
        "Bind the mesh again, or give it the skin it was made for.",
    ),
    Rule(
        "gltf.mesh.joint-out-of-range-unweighted",
        "warning",
        "A point names a joint that the skin does not have, without weight; some loaders read it anyway.",
        "Set the joint to 0 where the weight is 0.",
    ),
    Rule(
        "gltf.mesh.joint-repeated",
        "warning",
        "A point names one joint twice, with weight.",
        "Add the two weights.",
    ),
    Rule(
        "gltf.mesh.weight-nan",
        "error",
        "A weight is not a number, or is infinite.",
        "Normalise the weights again.",
    ),
    Rule(
        "gltf.mesh.vertex-nan",
        "error",
        "A number of a vertex (position, normal, texture place, morph target) is none, or is infinite: "
        "engines show a hole, or nothing of the mesh.",
        "Mend that vertex where the mesh was made (normals of faces without area are often so); export it.",
    ),
    Rule(
        "gltf.mesh.weight-negative",
        "error",
        "A weight is negative.",
        "Normalise the weights again.",
    ),
    Rule(
        "gltf.mesh.weight-sum",
        "warning",
        "The weights of a point do not sum to 1: engines that normalise show it elsewhere than others.",
        "Normalise the weights again.",
    ),
    Rule(
        "gltf.mesh.weight-zero",
        "warning",
        "All weights of a point are zero: it collapses to the origin, or stays, depending on the engine.",
        "Weight the point to a joint.",
    ),
)
