"""What the site's page of Python needs to know of the source (an extension of griffe).

Examples in docstrings are code, and operations take the keywords of their options, which they get when
they are imported.
"""

from __future__ import annotations

import inspect
import re
from importlib import import_module
from typing import Any

from griffe import Extension, Function, Object, Parameter, ParameterKind, Parameters

# The prompt, and all lines until an empty one.
_EXAMPLE = re.compile(r"(?:^>>> .*\n?)(?:^.+\n?)*", re.M)
_KINDS = {
    inspect.Parameter.POSITIONAL_OR_KEYWORD: ParameterKind.positional_or_keyword,
    inspect.Parameter.VAR_POSITIONAL: ParameterKind.var_positional,
    inspect.Parameter.KEYWORD_ONLY: ParameterKind.keyword_only,
}


class Source(Extension):
    """Puts each example into a fence, and keywords into the signatures of operations."""

    def on_instance(self, *, obj: Object, **_: Any) -> None:
        """Griffe has read one more object."""
        if obj.docstring:
            fenced = _EXAMPLE.sub(lambda found: f"```python\n{found[0].rstrip()}\n```\n", obj.docstring.value)
            obj.docstring.value = fenced

    def on_function(self, *, func: Function, **_: Any) -> None:
        """Griffe has read one more function."""
        if any(str(decorator.value).startswith("operation(") for decorator in func.decorators):
            own = inspect.signature(getattr(import_module(func.module.path), func.name))
            func.parameters = Parameters(*(_told(parameter) for parameter in own.parameters.values()))


def _told(parameter: inspect.Parameter) -> Parameter:
    given = parameter.default is not inspect.Parameter.empty
    return Parameter(
        parameter.name, kind=_KINDS[parameter.kind], default=repr(parameter.default) if given else None
    )
