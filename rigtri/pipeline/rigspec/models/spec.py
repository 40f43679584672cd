"""A whole spec: what holds for the file, and the steps."""

from __future__ import annotations

from dataclasses import fields
from typing import TYPE_CHECKING, Annotated, Any, Literal, Union

from pydantic import BaseModel, ConfigDict, Field

from rigtri.formats import ReadOptions
from rigtri.operations.registry import OPERATIONS
from rigtri.pipeline.rigspec.models.steps import StepModel, step_model
from rigtri.pipeline.rigspec.models.values import File, Flag, OneOrMany, Scalar, Tolerance, VariableName

STEP_MODELS: dict[str, type[StepModel]] = {name: step_model(name) for name in OPERATIONS}
if TYPE_CHECKING:
    AnyStep = StepModel
else:
    AnyStep = Annotated[Union[tuple(STEP_MODELS.values())], Field(discriminator="do")]  # noqa: UP007


class SpecModel(BaseModel):
    """What a rig spec says; the steps are done in their order."""

    model_config = ConfigDict(extra="forbid", populate_by_name=False, title="rigtri rig spec")

    schema_: str | None = Field(None, alias="$schema", description="The schema's address, for editors.")
    version: Literal[1] = Field(1, description="The version of this format.")
    name: str | None = Field(None, description="What the spec is called in reports.")
    extends: Annotated[tuple[File, ...], OneOrMany(lambda value: isinstance(value, str))] = Field(
        (),
        description="Specs whose options, variables and defaults hold here too, and whose steps are done "
        "where this spec has none. What stands here wins; of several, the later.",
    )
    variables: dict[VariableName, Scalar] = Field(
        {}, description="Values that ${NAME} stands for in the steps; --set NAME=VALUE gives others."
    )
    defaults: dict[str, dict[str, Any]] = Field(
        {}, description="By operation: options that its steps have where they do not say otherwise."
    )
    root: str | None = Field(None, description="Take this node and all below it as the rig.")
    lenient: Flag = Field(False, description="Read nodes that glTF forbids where the meaning is clear.")
    allow_external_paths: Flag = Field(
        False,
        alias="allow-external-paths",
        description="Read buffers and USD layers outside the folder of the file.",
    )
    allow_missing: Flag = Field(
        False, alias="allow-missing", description="Leave out USD layers that are damaged."
    )
    unknown_node_ext: Literal["freeze", "ignore", "error"] = Field(
        "freeze",
        alias="unknown-node-ext",
        description="A glTF node with an extension that may hold directions in the node's axes.",
    )
    bake_xform: Flag = Field(False, alias="bake-xform", description="USD: rewrite plain hierarchies' ops.")
    allow_rename: Flag = Field(False, alias="allow-rename", description="USD: a split may rename joints.")
    edit_target: str = Field(
        "root",
        alias="edit-target",
        description="USD: the layer that gets the opinions and becomes the output: root, new (over the "
        "file), bare (the opinions alone), or a sublayer by its file name.",
    )
    resources: Literal["copy", "relink"] = Field(
        "copy", description="A .gltf in another folder takes its files along, or points back."
    )
    tolerance: Tolerance = Field(1e-5, description="Refuse a result farther off than this share of its size.")
    strict: Flag = Field(False, description="Make any warning an error.")
    sidecar: Flag = Field(False, description="Also write what rigtri has stored as OUT.rig.json.")
    steps: tuple[AnyStep, ...] = Field(
        (), description="What is done, in this order.", json_schema_extra={"minItems": 1}
    )

    def reading(self) -> ReadOptions:
        """How files are read and written."""
        named = {one.name: getattr(self, one.name) for one in fields(ReadOptions) if hasattr(self, one.name)}
        empty = any(step.do == "make-limb" for step in self.steps)
        return ReadOptions(**named | {"relink": self.resources == "relink", "empty": empty})

    def shared(self) -> dict[str, Any]:
        """Values of parameters that the whole file has, as steps ask for them."""
        return {"root": self.root, "tolerance": self.tolerance}
