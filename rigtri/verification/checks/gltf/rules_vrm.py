"""What may be wrong with the VRM 0.x, VRM 1.0 and VRMA data about the nodes of a glTF file.

Source: VRM 0.0 README; VRMC_vrm 1.0 (humanoid, tpose, expressions, firstPerson);
VRMC_springBone 1.0; VRMC_node_constraint 1.0; VRMC_vrm_animation 1.0.
"""

from __future__ import annotations

from rigtri.verification.checks.findings import Rule

_ASSIGN = "Assign the bones again in the program that wrote the file."

RULES = (
    Rule(
        "vrm.humanoid.bone-missing",
        "error",
        "A bone that VRM requires of every humanoid is not assigned.",
        _ASSIGN,
    ),
    Rule(
        "vrm.humanoid.bone-unknown",
        "warning",
        "A bone is none that this version of VRM knows; it is passed over.",
        "Use a name from the list of the specification.",
    ),
    Rule(
        "vrm.humanoid.node-missing",
        "error",
        "A bone is assigned to a node that the file does not have.",
        _ASSIGN,
    ),
    Rule(
        "vrm.humanoid.node-twice",
        "error",
        "One node, or one bone, is assigned twice.",
        _ASSIGN,
    ),
    Rule(
        "vrm.humanoid.order",
        "error",
        "A bone is not below the bone that VRM puts above it, so poses do not carry over.",
        "Parent the bone below it, or assign the bones again.",
    ),
    Rule(
        "vrm.humanoid.parent-missing",
        "error",
        "A bone is assigned, but not the one above it that VRM requires with it.",
        _ASSIGN,
    ),
    Rule(
        "vrm.humanoid.scale",
        "error",
        "A bone has a scale that is zero or negative, which VRM forbids.",
        "Apply the scale before you export.",
    ),
    Rule(
        "vrm.humanoid.scale-nonuniform",
        "warning",
        "A bone has a scale that is not uniform, which VRM programs do not carry over.",
        "Apply the scale before you export.",
    ),
    Rule(
        "vrm.rest-rotation",
        "warning",
        "A bone of a VRM 0.x file has a rest rotation, which VRM 0.x forbids.",
        "Normalise the bones in the exporter, or convert the file to VRM 1.0, which allows it.",
    ),
    Rule(
        "vrm.expression.node",
        "error",
        "An expression drives a node or mesh that is not there, or that shows no mesh.",
        "Bind the expression again.",
    ),
    Rule(
        "vrm.expression.morph",
        "error",
        "An expression drives a morph target that its mesh does not have.",
        "Bind the expression again.",
    ),
    Rule(
        "vrm.expression.material",
        "error",
        "An expression changes a material that the file does not have.",
        "Bind the expression again.",
    ),
    Rule(
        "vrm.first-person",
        "error",
        "A first-person annotation names a node or mesh that is not there, or a type that VRM does not know.",
        "Annotate nodes that show a mesh with auto, both, thirdPersonOnly or firstPersonOnly.",
    ),
    Rule(
        "vrm.constraint.kind",
        "error",
        "A node constraint is not exactly one of roll, aim and rotation.",
        "Give the node one constraint.",
    ),
    Rule(
        "vrm.constraint.source",
        "error",
        "A node constraint has a source that the file does not have.",
        "Choose the source again.",
    ),
    Rule(
        "vrm.constraint.axis",
        "error",
        "The axis of a roll or aim constraint is none of those allowed.",
        "rollAxis is X, Y or Z; aimAxis is PositiveX to NegativeZ.",
    ),
    Rule(
        "vrm.constraint.weight",
        "error",
        "The weight of a node constraint is not between 0 and 1.",
        "Choose a weight from 0 to 1.",
    ),
    Rule(
        "vrm.constraint.cycle",
        "error",
        "A node constraint depends on itself, by its source or by further constraints.",
        "Break the circle: take another source.",
    ),
    Rule(
        "vrm.spring.node",
        "error",
        "A spring joint, center or collider names a node that the file does not have.",
        "Choose the node again.",
    ),
    Rule(
        "vrm.spring.group",
        "error",
        "A spring names a collider group, or a group a collider, that is not there.",
        "Choose the colliders again.",
    ),
    Rule(
        "vrm.spring.shape",
        "error",
        "A collider has not exactly one shape.",
        "Give each collider a sphere or a capsule.",
    ),
    Rule(
        "vrm.spring.order",
        "error",
        "A joint of a spring is not below the joint before it.",
        "List the joints of a spring from root to tip, along one chain.",
    ),
    Rule(
        "vrm.spring.shared",
        "error",
        "One joint swings in two springs, which VRM forbids (joints skipped between two count too).",
        "Leave it in one of them.",
    ),
    Rule(
        "vrm.spring.center",
        "warning",
        "The center of a spring is not its first joint or above it, or swings itself.",
        "Choose a center above the spring.",
    ),
    Rule(
        "vrma.bone-unknown",
        "warning",
        "A VRM animation names a bone that VRM 1.0 does not know; players pass over it.",
        "Use a name from the list of VRM 1.0.",
    ),
    Rule(
        "vrma.node",
        "error",
        "An expression or look-at of a VRM animation has no node of its own that is there.",
        "Export the animation anew.",
    ),
)
