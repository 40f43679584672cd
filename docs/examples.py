"""For the site's page of Python: examples in docstrings are code (an extension of griffe)."""

from __future__ import annotations

import re
from typing import Any

from griffe import Extension, Object

# The prompt, and all lines until an empty one.
_EXAMPLE = re.compile(r"(?:^>>> .*\n?)(?:^.+\n?)*", re.M)


class Examples(Extension):
    """Puts each example into a fence."""

    def on_instance(self, *, obj: Object, **_: Any) -> None:
        """Griffe has read one more object."""
        if obj.docstring:
            fenced = _EXAMPLE.sub(lambda found: f"```python\n{found[0].rstrip()}\n```\n", obj.docstring.value)
            obj.docstring.value = fenced
