"""What all steps of a spec have in common."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel, ConfigDict, Field

from rigtri.formats import ReadOptions
from rigtri.pipeline.rigspec.models.values import Flag
from rigtri.pipeline.steps.request import Request


def option(name: str, default: Any = ...) -> Any:
    """A field that a spec calls by the name of the command's option."""
    return Field(default, alias=name)


class StepModel(BaseModel):
    """The options of one operation; fields have the names of the command's parameters."""

    model_config = ConfigDict(extra="forbid", strict=False, populate_by_name=False)

    optional: Flag = Field(
        False,
        description="Leave the step out, with a warning, where a file has not the joints that it names.",
    )

    do: str

    def values(self) -> dict[str, Any]:
        """Values of the command's parameters."""
        return {
            name: getattr(self, name) for name in type(self).model_fields if name not in ("do", "optional")
        }

    def request(self, shared: dict[str, Any], reading: ReadOptions) -> Request:
        """What this step asks of its operation; shared: values that the whole spec has."""
        return Request(shared | self.values(), frozenset(self.model_fields_set), reading)
