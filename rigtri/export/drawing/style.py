"""How a picture looks: colours for light and dark, which the viewer's own setting chooses between."""

from __future__ import annotations

# Each on light and on dark paper.
_COLOURS = {
    "paper": ("#fcfcfb", "#14171b"),
    "ink": ("#23272e", "#e8eaee"),
    "faint": ("#6b7380", "#98a1ae"),
    "body": ("#dfe4ea", "#262c34"),
    "edge": ("#b9c2cd", "#3c4653"),
    "bone": ("#ffffff", "#39424e"),
    "wire": ("#4b5563", "#aab4c1"),
    "limb": ("#f2a900", "#ffc233"),
    "crooked": ("#ff7a00", "#ff9a3d"),
    "rule": ("#8a5cd1", "#b794f4"),
    "x": ("#e0262d", "#ff5a5f"),
    "y": ("#1f9d3a", "#3ecf5f"),
    "z": ("#2563eb", "#5b9bff"),
}
_RULES = """
.paper {{ fill: {paper} }}
.body {{ fill: {body}; stroke: {edge}; stroke-width: 1; fill-rule: evenodd }}
.bone {{ fill: {bone}; fill-opacity: 0.8; stroke: {wire}; stroke-width: 1; stroke-linejoin: round }}
.link {{ stroke: {faint}; stroke-width: 1; fill: none }}
.follows {{ stroke: {rule}; stroke-width: 1; stroke-dasharray: 1 3; fill: none }}
.limb {{ fill: {limb}; fill-opacity: 0.22; stroke: none }}
.chord, .upright {{ stroke: {limb}; stroke-width: 1.3; stroke-dasharray: 5 3; fill: none }}
.square {{ stroke: {limb}; stroke-width: 1; fill: none }}
.foot, .pole {{ fill: {limb}; stroke: none }}
.locator {{ fill: {paper}; stroke: {limb}; stroke-width: 2 }}
.control {{ stroke: {faint}; stroke-width: 1.3; fill: none }}
.vector {{ fill: {ink}; stroke: none }}
.x {{ fill: {x} }} .y {{ fill: {y} }} .z {{ fill: {z} }}
.x.ring {{ stroke: {x} }} .y.ring {{ stroke: {y} }} .z.ring {{ stroke: {z} }}
.pole.ring {{ stroke: {limb} }} .vector.ring {{ stroke: {ink} }}
.ring {{ fill: none; stroke-width: 1.4 }}
.joint {{ fill: {ink}; stroke: {paper}; stroke-width: 0.6 }}
.node {{ fill: {paper}; stroke: {faint}; stroke-width: 1 }}
.joint.crooked {{ fill: {crooked}; stroke: {ink}; stroke-width: 0.8 }}
.leader {{ stroke: {faint}; stroke-width: 0.6 }}
text {{ font-family: sans-serif; fill: {ink} }}
.name {{ stroke: {paper}; stroke-width: 3; stroke-linejoin: round; paint-order: stroke }}
.title {{ font-size: 16px; font-weight: bold }}
.words {{ font-size: 12px; fill: {faint} }}
.words.crooked {{ fill: {crooked}; font-weight: bold }}
.letter {{ font-size: 10px; text-anchor: middle; stroke: none }}
"""


def css() -> str:
    """The style sheet of a picture: light, and dark where the one who looks wants that."""
    light, dark = (
        _RULES.format(**{name: pair[side] for name, pair in _COLOURS.items()}).strip() for side in (0, 1)
    )
    dark = dark.replace("\n", "\n  ")
    return f"{light}\n@media (prefers-color-scheme: dark) {{\n  {dark}\n}}"
