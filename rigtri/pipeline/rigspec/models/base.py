"""What all steps of a spec have in common."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel, ConfigDict, Field

from rigtri.operations.declaration import made
from rigtri.operations.registry import options_class
from rigtri.pipeline.rigspec.models.values import Flag


class StepModel(BaseModel):
    """The options of one operation; fields have the names that the operation declares."""

    model_config = ConfigDict(extra="forbid", strict=False, populate_by_name=False)

    optional: Flag = Field(
        False,
        description="Leave the step out, with a warning, where a file has not the joints that it names.",
    )

    do: str

    def values(self) -> dict[str, Any]:
        """Values of the options, by their names."""
        return {
            name: getattr(self, name) for name in type(self).model_fields if name not in ("do", "optional")
        }

    def options(self, shared: dict[str, Any]) -> Any:
        """The options of the operation, checked; UsageError where they contradict each other.

        shared: values that the whole spec has.
        """
        return made(options_class(self.do), shared | self.values(), self.model_fields_set)
