"""Names as USD spells them."""

from __future__ import annotations

from pxr import Sdf


def identifier(name: str, otherwise: str = "_") -> str:
    """A name as USD spells it: letters of any script, digits and underscores for all else.

    Source: OpenUSD, "Unicode in USD" (XID_Start and XID_Continue).

    >>> identifier("Arm.L 2"), identifier("2nd"), identifier("", "node"), identifier("手")
    ('Arm_L_2', '_2nd', 'node', '手')
    """
    word = "".join(c if Sdf.Path.IsValidIdentifier(f"_{c}") else "_" for c in name)
    if not word:
        return otherwise
    return word if Sdf.Path.IsValidIdentifier(word) else f"_{word}"
