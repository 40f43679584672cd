"""All commands, under their headings, with a line of help for each."""

from __future__ import annotations

from rigtri.operations.registry import OPERATIONS


def _operations(heading: str) -> dict[str, tuple[str, str]]:
    return {name: (one.summary, one.page) for name, one in OPERATIONS.items() if one.heading == heading}


# Heading → command → its line of help and its page in docs/; operations have theirs in the registry. The
# module of a command is imported when the command runs, so that `rigtri --help` does not wait for numpy.
_ENTRIES: dict[str, dict[str, tuple[str, str]]] = {
    "Look": {
        "inspect": (
            "Show the joints of a file: axes, lengths, bends, skins, clips, warnings.",
            "operations.md",
        ),
        "recognise": (
            "Find spine, head, arms, legs, hands and fingers by map, names and shape, and show why.",
            "recognise.md",
        ),
        "check": ("Find all that is wrong with the skinned rigs in files.", "checks.md"),
        "verify": ("Measure how much two files differ in every pose.", "exactness.md"),
        "diff": ("Show in rig terms and in file terms how two files differ.", "operations.md"),
        "draw": (
            "Draw the skeleton: bones, axes, limb triangles, pole vectors, controls, names.",
            "pictures.md",
        ),
        "view": (
            "Write a page that shows a character, posed and moving, with its rig, before and after.",
            "view.md",
        ),
        "explain": (
            "Show the vectors, triangles and matrices of three points, or of a limb, step by step.",
            "explain.md",
        ),
    },
    "Re-orient": _operations("Re-orient"),
    "Build": {
        "auto": ("Recognise a character and build its rig; its spec is written beside OUT.", "auto.md"),
        **_operations("Build"),
    },
    "Motion": {
        **_operations("Motion"),
        "export-blender": (
            "Write a script that sets controls, IK and constraints up in Blender.",
            "blender.md",
        ),
    },
    "Library": {
        **_operations("Library"),
        "convert": (
            "Write a glTF, GLB or VRM as USD, or a USD as glTF; what the other cannot say is listed.",
            "convert.md",
        ),
    },
    "Many files": {
        "spec-init": (
            "Write a rig spec to start from: steps for the joints that a character has.",
            "specs.md",
        ),
        "build": ("Build a rig by a spec: the steps that a file lists, in one go.", "specs.md"),
        "batch": ("Build many files by a spec, or convert them, in several processes.", "batch.md"),
        "batch-report": (
            "Summarise the manifest of a batch: counts, worst, slowest, errors by kind.",
            "batch.md",
        ),
    },
    "This program": {
        "help": ("Show the whole help of a command: all of its options.", "start.md"),
        "schema": ("Print a JSON Schema: of rig specs, or of what rigtri writes.", "specs.md"),
        "completion": (
            "Print the script with which bash, zsh or fish complete commands, joints and clips.",
            "start.md",
        ),
    },
}
GROUPS = {
    heading: {name: words for name, (words, _) in entries.items()} for heading, entries in _ENTRIES.items()
}
COMMANDS = {name: words for group in GROUPS.values() for name, words in group.items()}
PAGES = {name: page for entries in _ENTRIES.values() for name, (_, page) in entries.items()}
# How alike, from 0 to 1, a word is to the command that was meant; of words of five letters four agree.
SIMILAR = 0.75


def page_of(command: str) -> str:
    """The page to read on about a command.

    >>> page_of("bake"), page_of("add-controls")
    ('docs/evaluation.md', 'docs/operations.md')
    """
    return f"docs/{PAGES[command]}"


def similar_commands(name: str) -> list[str]:
    """The commands that a user may have meant, the likeliest first.

    >>> [similar_commands(word) for word in ("orint", "control", "dance", "hepl")]
    [['orient-joints'], ['add-controls'], [], ['help', 'explain']]
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
    return [known for known in likely[:3] if likeness(known) >= max(SIMILAR, likeness(likely[0]) - 0.05)]
