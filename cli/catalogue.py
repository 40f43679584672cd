"""All commands, under their headings, with a line of help for each."""

from __future__ import annotations

# Heading → command → its one line of help. A command's module is imported when the command runs,
# so that `rigtri --help` does not wait for numpy.
GROUPS = {
    "Look": {
        "inspect": "Show the joints of a file: axes, lengths, bends, skins, clips, warnings.",
        "recognise": "Find spine, head, arms, legs, hands and fingers by map, names and shape, and show why.",
        "check": "Find all that is wrong with the skinned rigs in files.",
        "verify": "Measure how much two files differ in every pose.",
        "diff": "Show in rig terms and in file terms how two files differ.",
        "draw": "Draw the skeleton: bones, axes, limb triangles, pole vectors, controls, names.",
        "view": "Write a page that shows a character, posed and moving, with its rig, before and after.",
        "explain": "Show the vectors and triangles of three points, or of a limb, step by step.",
    },
    "Re-orient": {
        "orient-joints": "Give joints new axes; nothing that can be seen moves.",
        "mirror": "Give one side of a character the axes of the other, and all that rigtri has built there.",
    },
    "Build": {
        "auto": "Recognise a character and build its rig; its spec is written beside OUT.",
        "make-limb": "Make an oriented chain of joints and its pole vector from three points.",
        "add-twist": "Put twist joints along bones, which avoids the candy-wrapper effect.",
        "add-controls": "Put a tree of controls over joints: fingers, spines, limbs, characters.",
        "add-polevector": "Add a locator that says which way a limb bends.",
        "constrain": "Let a node follow others: parent, point, orient, scale, aim, pole vector.",
        "add-posereader": "Let morph targets or values follow a joint's pose.",
        "add-rivet": "Attach locators to the surface of a mesh, through skinning and morphs.",
        "strip": "Remove what rigtri has added to a file.",
    },
    "Motion": {
        "pose": "Print the pose of one moment, evaluated, or make it the rest pose.",
        "snap": "Match IK to FK, or FK to IK, at some frames: the joints do not move there.",
        "bake": "Bake controls and constraints to joint keys, or joints' motion to controls.",
        "take-clips": "Transfer the animation of an edited file back to the rig it was made from.",
        "export-blender": "Write a script that sets controls, IK and constraints up in Blender.",
    },
    "Library": {
        "freeze": "Put scale and rotation above joints into the joints; nothing that can be seen moves.",
        "rename-joints": "Give joints the names of another scheme: Mixamo, Unreal, Unity, VRM, Rigify ...",
        "set-rest": "Give joints another rest pose, T-pose or A-pose too; every clip plays as before.",
        "conform": "Give a character the standard skeleton of Unreal, Unity, Godot, VRM or Mixamo.",
        "add-root": "Put a root joint on the ground above a character's joints.",
        "add-socket": "Put a node on a joint that something can be attached to.",
        "root-motion": "Move motion over the ground from the hips to the root, or take it out.",
        "prune-joints": "Remove joints that move nothing.",
        "merge-joints": "Merge joints into those above: still ones, named ones, or down to a number.",
        "convert": "Write a glTF, GLB or VRM as USD, or a USD as glTF; what the other cannot say is listed.",
        "limit-weights": "Let no point follow more than four joints, and weights sum to 1.",
    },
    "Many files": {
        "spec-init": "Write a rig spec to start from: steps for the joints that a character has.",
        "build": "Build a rig by a spec: the steps that a file lists, in one go.",
        "batch": "Build many files by a spec, in several processes.",
        "batch-report": "Summarise the manifest of a batch: counts, worst, slowest, errors.",
    },
    "This program": {
        "help": "Show the whole help of a command: all of its options.",
        "schema": "Print a JSON Schema: of rig specs, or of what rigtri writes.",
        "completion": "Print the script with which bash, zsh or fish complete commands, joints and clips.",
    },
}
COMMANDS = {name: words for group in GROUPS.values() for name, words in group.items()}
# Page of the folder docs → the commands that it is about; operations.md has a paragraph on each other one.
PAGES = {
    "recognise.md": ("recognise",),
    "checks.md": ("check",),
    "exactness.md": ("verify",),
    "pictures.md": ("draw",),
    "view.md": ("view",),
    "explain.md": ("explain",),
    "tasks/straighten.md": ("orient-joints",),
    "auto.md": ("auto",),
    "constraints.md": ("constrain",),
    "evaluation.md": ("pose", "snap", "bake"),
    "take-clips.md": ("take-clips",),
    "blender.md": ("export-blender",),
    "one-skeleton.md": (
        "freeze",
        "rename-joints",
        "set-rest",
        "conform",
        "add-root",
        "add-socket",
        "root-motion",
        "prune-joints",
        "merge-joints",
        "limit-weights",
    ),
    "convert.md": ("convert",),
    "specs.md": ("spec-init", "build", "schema"),
    "batch.md": ("batch", "batch-report"),
    "start.md": ("help", "completion"),
}
# How alike, from 0 to 1, a word is to the command that was meant; of words of five letters four agree.
ALIKE = 0.75


def page_of(command: str) -> str:
    """The page to read on about a command.

    >>> page_of("bake"), page_of("add-controls")
    ('docs/evaluation.md', 'docs/operations.md')
    """
    return f"docs/{next((page for page, about in PAGES.items() if command in about), 'operations.md')}"


def alike(name: str) -> list[str]:
    """The commands that a user may have meant, the likeliest first.

    >>> alike("orint"), alike("control"), alike("dance"), alike("hepl")
    (['orient-joints'], ['add-controls'], [], ['help', 'explain'])
    """
    from difflib import SequenceMatcher

    first = name.partition("-")[0]

    def likeness(known: str) -> float:
        """That of the whole, of one of its words, or of what one of them begins with."""
        words = {known, *known.split("-")}
        pairs = {(name, part) for word in words for part in (word, word[: len(name)])} | {(first, known)}
        return max(SequenceMatcher(None, *pair).ratio() for pair in pairs)

    def whole(known: str) -> float:
        return SequenceMatcher(None, name, known).ratio()

    likely = sorted(COMMANDS, key=lambda known: (likeness(known), whole(known)), reverse=True)
    return [known for known in likely[:3] if likeness(known) >= max(ALIKE, likeness(likely[0]) - 0.05)]
