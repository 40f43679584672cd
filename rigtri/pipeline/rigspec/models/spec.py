"""A whole spec: what holds for the file, and the steps."""

from __future__ import annotations

from dataclasses import fields
from typing import TYPE_CHECKING, Annotated, Any, Literal, Union

from pydantic import BaseModel, ConfigDict, Field, create_model

from rigtri.formats import ReadOptions
from rigtri.model.edit_options import OF_BUILDS, EditOptions, FileOptions
from rigtri.operations.registry import OPERATIONS
from rigtri.pipeline.rigspec.models.steps import StepModel, fields_of, step_model
from rigtri.pipeline.rigspec.models.values import File, OneOrMany, Scalar, VariableName

STEP_MODELS: dict[str, type[StepModel]] = {name: step_model(name) for name in OPERATIONS}
if TYPE_CHECKING:
    AnyStep = StepModel
else:
    AnyStep = Annotated[Union[tuple(STEP_MODELS.values())], Field(discriminator="do")]  # noqa: UP007


class _Head(BaseModel):
    model_config = ConfigDict(extra="forbid", populate_by_name=False, title="rigtri rig spec")

    schema_: str | None = Field(None, alias="$schema", description="The schema's address, for editors.")
    version: Literal[1] = Field(1, description="The version of this format.")
    name: str | None = Field(None, description="What the spec is called in reports.")
    extends: Annotated[tuple[File, ...], OneOrMany(lambda value: isinstance(value, str))] = Field(
        (),
        description="Specs whose options, variables and defaults apply here too, and whose steps are used "
        "where this spec has none. Values of this file have precedence; of several specs, the later.",
    )
    variables: dict[VariableName, Scalar] = Field(
        {}, description="Values that ${NAME} stands for in the steps; --set NAME=VALUE gives others."
    )
    defaults: dict[str, dict[str, Any]] = Field(
        {}, description="By operation: options that its steps have where they do not say otherwise."
    )


# Those options of all edits that a spec can give.
_OF_EDITS = fields_of(EditOptions)
for _name in OF_BUILDS:
    del _OF_EDITS[_name]
if TYPE_CHECKING:

    class _EditHead(_Head): ...
else:
    _EditHead = create_model("_EditHead", __base__=_Head, **_OF_EDITS)


class SpecModel(_EditHead):
    """What a rig spec says; the steps are done in their order."""

    steps: tuple[AnyStep, ...] = Field(
        (), description="What is done, in this order.", json_schema_extra={"minItems": 1}
    )

    @property
    def edits(self) -> EditOptions:
        """What it says that all edits have."""
        return EditOptions(**{name: getattr(self, name) for name in _OF_EDITS})

    def reading(self) -> ReadOptions:
        """How files are read and written."""
        named = {one.name: getattr(self, one.name) for one in fields(FileOptions)}
        return ReadOptions(**named, empty=any(step.do == "make-limb" for step in self.steps))

    def shared(self) -> dict[str, Any]:
        """Values of parameters that the whole file has, as steps ask for them."""
        edits = self.edits
        return {"root": edits.root, "tolerance": edits.tolerance}
