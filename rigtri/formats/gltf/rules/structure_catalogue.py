"""What may be wrong with a glTF file, its nodes, joints and skins.

Source: glTF 2.0; docs of the Khronos validator for what engines refuse.
"""

from __future__ import annotations

from rigtri.formats.rules import Rule

_AGAIN = "Export the file anew with the program that wrote it."

RULES = (
    Rule(
        "gltf.glb.length",
        "error",
        "Bytes follow behind the length that the GLB header claims.",
        "Cut the file at that length, or export it anew; --lenient reads it all the same.",
    ),
    Rule(
        "gltf.json.byte-order-mark",
        "warning",
        "The JSON starts with a byte order mark, which glTF forbids.",
        "Save the JSON as UTF-8 without a byte order mark.",
    ),
    Rule(
        "gltf.json.key-twice",
        "error",
        "An object of the JSON has one key twice; readers differ in which they take.",
        "Remove one of the two.",
    ),
    Rule(
        "gltf.json.value",
        "error",
        "A value is missing, or is not what glTF wants there: a text for a number, a number of no size.",
        _AGAIN,
    ),
    Rule(
        "gltf.reference",
        "error",
        "An index points at something that the file does not have; those in extensions are not looked at.",
        _AGAIN,
    ),
    Rule(
        "gltf.extension.required-unknown",
        "warning",
        "The file requires an extension that rigtri does not know, so it may mean more than is read.",
        "Nothing needs to be done where the extension is about looks; else export without it.",
    ),
    Rule(
        "gltf.extension.undeclared",
        "error",
        "An extension is required, or any object has it, and extensionsUsed does not list it; loaders then "
        "pass over it.",
        "List it in extensionsUsed.",
    ),
    Rule(
        "gltf.buffer.outside",
        "error",
        "A buffer names a file outside the folder of the asset, or is to be fetched from a network.",
        "Put the file beside the asset; --allow-external-paths where you trust it (never for a network).",
    ),
    Rule(
        "gltf.buffer.missing",
        "error",
        "The file that a buffer names is not there.",
        "Put it beside the asset.",
    ),
    Rule(
        "gltf.file.missing",
        "warning",
        "The file that an image or an extension names is not there, or is to be fetched from a network.",
        "Put the file where the asset names it, or embed it.",
    ),
    Rule(
        "gltf.buffer.broken",
        "error",
        "The data of a buffer are shorter than it claims, or no data at all.",
        "Copy or export the file again.",
    ),
    Rule(
        "gltf.accessor.broken",
        "error",
        "An accessor leaves its buffer view, or cannot be read for another reason.",
        _AGAIN,
    ),
    Rule(
        "gltf.accessor.bounds",
        "warning",
        "The min or max of positions, times, influences or matrices are not those of the values, or "
        "positions have none; loaders trust them.",
        _AGAIN,
    ),
    Rule(
        "gltf.compressed",
        "info",
        "Data are compressed in a way that is not decoded here, so they were not looked at.",
        "Check the file before it is compressed.",
    ),
    Rule(
        "gltf.node.cycle",
        "error",
        "A node is below itself.",
        "Take it from the children of a node below it.",
    ),
    Rule(
        "gltf.node.two-parents",
        "error",
        "A node is a child of two nodes, or twice of one.",
        "Take it from the children of one of them.",
    ),
    Rule(
        "gltf.node.matrix-and-trs",
        "error",
        "A node has a matrix beside translation, rotation or scale; readers differ in which they take.",
        "Keep one; --lenient takes translation, rotation and scale.",
    ),
    Rule(
        "gltf.node.matrix-animated",
        "error",
        "A node that is animated has a matrix, so where its other properties stand is unsaid.",
        "Give it translation, rotation and scale; --lenient splits the matrix.",
    ),
    Rule(
        "gltf.node.matrix-last-row",
        "error",
        "The last row of a node's matrix is not 0 0 0 1.",
        _AGAIN,
    ),
    Rule(
        "gltf.node.matrix-sheared",
        "error",
        "The axes of a node's matrix are not at right angles; three.js and Blender drop the shear silently.",
        "Freeze the transform in the program that made it, or bake it to translation, rotation and scale.",
    ),
    Rule(
        "gltf.node.matrix-singular",
        "error",
        "A node's matrix is flat: it has no inverse, and what is below it has no place of its own.",
        "Give the node a scale that is not zero.",
    ),
    Rule(
        "gltf.node.rotation-not-unit",
        "warning",
        "A rest rotation is not a unit quaternion; engines differ in what they make of it.",
        "Normalise it.",
    ),
    Rule(
        "gltf.node.rotation-zero",
        "error",
        "A rest rotation is 0 0 0 0, which is no rotation.",
        "Set it to 0 0 0 1.",
    ),
    Rule(
        "gltf.node.skin-without-mesh",
        "error",
        "A node has a skin and no mesh that it could move.",
        "Take the skin from the node.",
    ),
    Rule(
        "gltf.node.skin-on-rigid-mesh",
        "error",
        "A node has a skin, but no primitive of its mesh names joints.",
        "Take the skin from the node, or export the mesh with its weights.",
    ),
    Rule(
        "gltf.node.skinned-mesh-without-skin",
        "warning",
        "A mesh names joints, but the node that shows it has no skin, so it stays rigid.",
        "Give the node the skin.",
    ),
    Rule(
        "gltf.node.skinned-mesh-below-joint",
        "warning",
        "A skinned mesh hangs below a joint of its own skin; programs that do not ignore it move it twice.",
        "Move the mesh to the root of the scene.",
    ),
    Rule(
        "gltf.node.skinned-mesh-placed",
        "info",
        "A skinned mesh, or a node above it, has a transform, which glTF ignores for skinned meshes.",
        "Nothing needs to be done; other programs may show the mesh elsewhere.",
    ),
    Rule(
        "gltf.scene.not-root",
        "error",
        "A scene lists a node that is a child of another.",
        "List its topmost node.",
    ),
    Rule(
        "gltf.joint.name-twice",
        "info",
        "Several joints have one name, so that only path or index tells them apart.",
        "Give each joint a name of its own, or address it as the message says.",
    ),
    Rule(
        "gltf.joint.unnamed",
        "info",
        "A joint has no name.",
        "Name it, or address it by its index.",
    ),
    Rule(
        "gltf.joint.scale-zero",
        "warning",
        "A joint, or a node above one, has a scale of zero: what is below has no frame of its own.",
        "Use a small scale instead of zero; orient-joints leaves such joints as they are.",
    ),
    Rule(
        "gltf.joint.scale-nonuniform",
        "info",
        "A joint's own scale is not uniform, at rest or in a clip: only some new axes keep it exact.",
        "Nothing needs to be done; orient-joints --on-nonuniform-scale says snap, skip, split or error.",
    ),
    Rule(
        "gltf.joint.mirrored",
        "info",
        "A joint's own frame is mirrored (left-handed).",
        "Nothing needs to be done; orient-joints keeps the mirroring.",
    ),
    Rule(
        "gltf.no-skin",
        "info",
        "The file has no skin, so there is no rig to check in it but nodes and clips.",
        "Nothing needs to be done; edits take a plain hierarchy with --root.",
    ),
    Rule(
        "gltf.skin.no-joints", "error", "A skin has no joints.", "Remove the skin, or export the file anew."
    ),
    Rule(
        "gltf.skin.joint-missing",
        "error",
        "A skin lists a joint that the file does not have.",
        _AGAIN,
    ),
    Rule(
        "gltf.skin.joint-twice",
        "error",
        "A skin lists one node twice.",
        "List each joint once and renumber the joints of the mesh, or export the file anew.",
    ),
    Rule(
        "gltf.skin.no-common-root",
        "warning",
        "The joints of a skin hang in different trees, which glTF forbids and most engines take.",
        "Put all joints of a skin below one node.",
    ),
    Rule(
        "gltf.skin.skeleton-not-above",
        "warning",
        "The skeleton of a skin is not above all its joints.",
        "Name a node above all joints, or leave it out; it is only a hint.",
    ),
    Rule(
        "gltf.skin.unused",
        "info",
        "No node uses a skin.",
        "Remove it, or give it to the node of its mesh.",
    ),
    Rule(
        "gltf.skin.inverse-bind-missing",
        "info",
        "A skin has no inverse bind matrices: they count as identity.",
        "Nothing needs to be done where the mesh is modelled in the joints' own space.",
    ),
    Rule(
        "gltf.skin.inverse-bind-type",
        "error",
        "Inverse bind matrices should be MAT4 of floats.",
        _AGAIN,
    ),
    Rule(
        "gltf.skin.inverse-bind-count",
        "error",
        "A skin has fewer inverse bind matrices than joints.",
        _AGAIN,
    ),
    Rule(
        "gltf.skin.inverse-bind-nan",
        "error",
        "An inverse bind matrix has a value that is not a number, or is infinite.",
        _AGAIN,
    ),
    Rule(
        "gltf.skin.inverse-bind-last-row",
        "error",
        "The last row of an inverse bind matrix is not 0 0 0 1.",
        "Set it to 0 0 0 1: loaders ignore or misread it.",
    ),
    Rule(
        "gltf.skin.inverse-bind-singular",
        "error",
        "An inverse bind matrix is flat, so its joint has no bind pose.",
        "Set the bind pose again; --lenient edits the file all the same.",
    ),
    Rule(
        "gltf.note.broken",
        "warning",
        "What rigtri stored on a node is not what it can read, or names a node or joint that is not there.",
        "Run the command again that made the node, or remove extras.rigtri.",
    ),
    Rule(
        "gltf.note.circle",
        "error",
        "Controls and constraints wait for each other: a control of IK below the limb that it moves, say. "
        "bake, pose and snap refuse the rig.",
        "Hang one of the nodes named below another one, or take a constraint out.",
    ),
    Rule(
        "gltf.note.unknown",
        "info",
        "What rigtri stored on a node has a version or a type that this rigtri does not know.",
        "Nothing needs to be done, or use the rigtri that wrote it.",
    ),
)
