"""What may be wrong with the skeletons and animations of a USD stage.

Source: UsdSkel schemas and API; docs/decisions.md.
"""

from __future__ import annotations

from rigtri.verification.checks.findings import Rule

_AGAIN = "Export the file anew with the program that wrote it."

RULES = (
    Rule(
        "usd.layer.missing",
        "warning",
        "A layer that the file refers to was not found, so what it says is missing.",
        "Put it where the file looks for it, where a skeleton, its animation or its skin needs it.",
    ),
    Rule(
        "usd.no-skeleton",
        "info",
        "The stage has no Skeleton, so there is no rig to check in it but animations.",
        "Nothing needs to be done; where a layer is missing, put it beside the file.",
    ),
    Rule(
        "usd.skel.no-joints",
        "warning",
        "A Skeleton has no joints.",
        "Remove the prim, or export it anew.",
    ),
    Rule(
        "usd.skel.joint-empty",
        "warning",
        "A joint token is empty or no path: UsdSkel takes it for a root, Blender imports no skeleton then.",
        "Give every joint a path of names, parent/child.",
    ),
    Rule(
        "usd.skel.joint-twice",
        "error",
        "A Skeleton lists one joint twice. UsdSkel does not notice and takes either.",
        "Give every joint a path of its own.",
    ),
    Rule(
        "usd.skel.joint-order",
        "error",
        "A Skeleton lists a joint before its parent: UsdSkel then refuses the whole skeleton.",
        "Sort the joints parents first, and their matrices and influences with them.",
    ),
    Rule(
        "usd.skel.joint-names",
        "warning",
        "A Skeleton has not as many jointNames as joints.",
        "Write one name for each joint, or none.",
    ),
    Rule(
        "usd.skel.bind-missing",
        "error",
        "A Skeleton has no bindTransforms: UsdSkel then skins with the joints' places alone, which is wrong.",
        "Export it again with a bind pose.",
    ),
    Rule(
        "usd.skel.rest-missing",
        "info",
        "A Skeleton has no restTransforms; its animation drives every joint, so it moves all the same.",
        "Export it again with a rest pose.",
    ),
    Rule(
        "usd.skel.rest-needed",
        "error",
        "A Skeleton has no restTransforms, and not every joint is animated: UsdSkel then moves nothing.",
        "Export it again with a rest pose.",
    ),
    Rule(
        "usd.skel.matrix-count",
        "error",
        "bindTransforms or restTransforms are not as many as the joints; UsdSkel then ignores them.",
        _AGAIN,
    ),
    Rule(
        "usd.skel.time-samples",
        "error",
        "joints, bindTransforms or restTransforms have time samples, which UsdSkel reads as empty.",
        "Write one value without time.",
    ),
    Rule(
        "usd.skel.matrix-nan",
        "error",
        "A bind or rest matrix has a value that is not a number, infinite, or too large for float32.",
        _AGAIN,
    ),
    Rule(
        "usd.skel.matrix-last-column",
        "error",
        "The last column of a bind or rest matrix is not 0, 0, 0, 1.",
        _AGAIN,
    ),
    Rule(
        "usd.skel.bind-singular",
        "error",
        "A bind matrix has no inverse, so what its skin looks like is undefined; UsdSkel passes it silently.",
        "Set the bind pose of that joint again.",
    ),
    Rule(
        "usd.skel.rest-singular",
        "warning",
        "A rest matrix has no inverse: what is below that joint has no frame of its own.",
        "Use a small scale instead of zero.",
    ),
    Rule(
        "usd.skel.rest-sheared",
        "warning",
        "A rest matrix is sheared, which an animation of the joint cannot hold.",
        "Freeze the transform in the program that made it.",
    ),
    Rule(
        "usd.skel.scale-nonuniform",
        "info",
        "A joint's own scale is not uniform, at rest or in an animation: only some new axes keep it exact.",
        "Nothing needs to be done; orient-joints --on-nonuniform-scale says snap, skip, split or error.",
    ),
    Rule(
        "usd.skel.mirrored",
        "info",
        "A joint's own frame is mirrored (left-handed).",
        "Nothing needs to be done; orient-joints keeps the mirroring.",
    ),
    Rule(
        "usd.skel.variants",
        "info",
        "Variants decide what the joints of a skeleton are or do.",
        "Nothing needs to be done; orient-joints turns them in every variant. Splitting joints needs a "
        "file for each.",
    ),
    Rule(
        "usd.skel.variants-unselected",
        "warning",
        "Variants decide what a skeleton is or does, and none is selected: orient-joints cannot edit what "
        "shows then, for what it writes would win over every variant.",
        "Select a variant in a layer above, or remove the variant set.",
    ),
    Rule(
        "usd.type",
        "error",
        "A property of a skeleton, animation, binding or blend shape has a type that UsdSkel does not read.",
        _AGAIN,
    ),
    Rule(
        "usd.anim.no-joints",
        "warning",
        "A SkelAnimation has values for joints but names none; UsdSkel ignores it.",
        "Name its joints.",
    ),
    Rule(
        "usd.anim.joint-twice",
        "error",
        "A SkelAnimation lists one joint twice: which values move it is undefined.",
        "List each joint once.",
    ),
    Rule(
        "usd.anim.joint-unknown",
        "info",
        "A SkelAnimation drives joints that no skeleton bound to it has; they move nothing.",
        "Nothing needs to be done; a name that was changed in one place only looks like this.",
    ),
    Rule(
        "usd.anim.incomplete",
        "warning",
        "A SkelAnimation lacks translations, rotations or scales: UsdSkel then ignores all of it.",
        "Write all three; scales of 1 where nothing scales.",
    ),
    Rule(
        "usd.anim.length",
        "error",
        "translations, rotations or scales are not as many as the animation's joints: UsdSkel ignores it.",
        _AGAIN,
    ),
    Rule(
        "usd.anim.value-nan",
        "error",
        "A key is not a number, or is infinite.",
        _AGAIN,
    ),
    Rule(
        "usd.anim.time",
        "warning",
        "A time sample is at a time that is infinite, which no player reaches.",
        "Remove the sample, or give it a time.",
    ),
    Rule(
        "usd.anim.array-edits",
        "error",
        "A layer edits single items of an array that moves over time. USD holds such arrays from sample to "
        "sample, and orient-joints does not turn them.",
        "Write whole arrays there, or flatten the stage.",
    ),
    Rule(
        "usd.anim.rotation-zero",
        "error",
        "A rotation is (0, 0, 0, 0), which is no rotation.",
        _AGAIN,
    ),
    Rule(
        "usd.anim.rotation-not-unit",
        "warning",
        "Rotations are not unit quaternions; UsdSkel makes scaled frames of them.",
        "Normalise them.",
    ),
    Rule(
        "usd.anim.blend-length",
        "error",
        "blendShapeWeights are not as many as blendShapes.",
        _AGAIN,
    ),
    Rule(
        "usd.anim.unbound",
        "info",
        "No skeleton is bound to a SkelAnimation in the selected variants.",
        "Bind it with skel:animationSource, or leave it as a library.",
    ),
    Rule(
        "usd.note.broken",
        "warning",
        "What rigtri stored on a prim or joint cannot be read, or names a node or joint that is not there.",
        "Run the command again that made it, or remove the rigtri: attributes.",
    ),
    Rule(
        "usd.note.circle",
        "error",
        "Controls and constraints wait for each other: a control of IK below the limb that it moves, say. "
        "bake, pose and snap refuse the rig.",
        "Hang one of the nodes named below another one, or take a constraint out.",
    ),
    Rule(
        "usd.note.unknown",
        "info",
        "What rigtri stored on a prim or joint has a version or a type that this rigtri does not know.",
        "Nothing needs to be done, or use the rigtri that wrote it.",
    ),
)
