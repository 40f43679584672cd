"""What a rig that was read from a file knows of it: nothing but how to go on."""

from __future__ import annotations

from typing import Any, Protocol


class RigSource(Protocol):
    """Where a rig came from; only `rigtri.pipeline` looks inside."""

    def after(self, report: Any) -> RigSource: ...
