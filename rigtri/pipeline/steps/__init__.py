"""Operations as users ask for them: from the options of a command or a spec to a step of an edit.

One module an operation, under the command's name; each has ``step(request)``, which checks what can
be checked without the rig, and gives the function that `rigtri.pipeline.edit.edit` applies.
"""

from __future__ import annotations

from importlib import import_module

from rigtri.pipeline.steps.request import Request, Step

# In the order in which a rig is built.
STEPS = (
    "orient-joints",
    "make-limb",
    "add-twist",
    "add-controls",
    "add-polevector",
    "constrain",
    "add-rivet",
    "add-posereader",
    "mirror",
    "take-clips",
    "snap",
    "bake",
    "pose",
    "strip",
)


def step(name: str, request: Request) -> Step:
    """The step that ``request`` asks of the operation ``name``, one of `STEPS`.

    Raises UsageError for options that contradict each other or fit nothing, FileError for files they
    name.
    """
    made: Step = import_module(f"rigtri.pipeline.steps.{name.replace('-', '_')}").step(request)
    return made
