"""Asset paths that are variable expressions, such as @`"./${NAME}.usda"`@.

The variables are those of the root layer of a layer stack; what a stack that refers to it sets is
stronger. Nothing is opened here: what an expression names is known from the layers read so far.

Source: OpenUSD, variable expressions; Sdf.VariableExpression.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from pxr import Sdf

Variables = Mapping[str, Any]

# An expression that is one string, taken apart in front of the string's content.
_STRING = re.compile(r"(`\s*[\"'])(.*[\"']\s*`)", re.DOTALL)


def is_one(path: str) -> bool:
    """Whether an asset path is an expression, be it one that can be read or not."""
    return path.startswith("`")


def variables_of(layer: Any) -> dict[str, Any]:
    """The variables that a layer sets for the layer stack whose root it is."""
    found = layer.expressionVariables if layer.HasExpressionVariables() else {}
    return dict(found)


def evaluated(path: str, variables: Variables) -> str:
    """The asset path that is meant; "" where an expression names none, as USD evaluates it.

    A variable that is not set stays in it: ``${NAME}``.
    """
    if not is_one(path):
        return path
    result = Sdf.VariableExpression(path).Evaluate(dict(variables))
    return result.value if isinstance(result.value, str) and not result.errors else ""


def prefixed(path: str, front: str) -> str:
    """An expression that names the same behind ``front``; "" where it is not sure to.

    Sure is one string that starts with a name of a folder or file, not with a variable, which may
    hold an absolute path one day.
    """
    parts = _STRING.fullmatch(path)
    if parts is None or parts[2].startswith(("$", "/", "\\")) or parts[1][-1] != parts[2].rstrip("` \t")[-1]:
        return ""
    return f"{parts[1]}{front.translate(_QUOTED)}{parts[2]}"


# Inside a string of an expression these letters mean something else without a backslash.
_QUOTED = {ord(letter): "\\" + letter for letter in "\\\"'`$"}
