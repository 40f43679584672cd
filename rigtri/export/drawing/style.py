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
    "limb": ("#0d9aa5", "#33c9d4"),
    "pole": ("#a3159a", "#ff9df5"),
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
.foot {{ fill: {limb}; stroke: none }}
.pole {{ fill: {pole}; stroke: none }}
.locator {{ fill: {paper}; stroke: {pole}; stroke-width: 2 }}
.control {{ stroke: {faint}; stroke-width: 1.3; fill: none }}
.vector {{ fill: {ink}; stroke: none }}
.x {{ fill: {x} }} .y {{ fill: {y} }} .z {{ fill: {z} }}
.x.ring {{ stroke: {x} }} .y.ring {{ stroke: {y} }} .z.ring {{ stroke: {z} }}
.pole.ring {{ stroke: {pole} }} .vector.ring {{ stroke: {ink} }}
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
.key {{ font-size: 11px; fill: {faint} }}
.swatch.crooked {{ fill: {crooked} }} .swatch.limb {{ fill: {limb}; fill-opacity: 0.6 }}
.letter {{ font-size: 10px; text-anchor: middle; stroke: none }}
"""


# What the marks of a picture or of the page mean: the colour that shows it, and the words of the legend.
# Controls have colours of their own, often those of axes: they alone are outlines, and axes alone are arrows.
LEGEND = {
    "x": "x axis",
    "y": "y axis",
    "z": "z axis",
    "limb": "limb, and P, the projection of its middle",
    "pole": "bend direction, pole vector",
    "crooked": "joint without an axis along its bone",
    "rule": "follows by a constraint",
    "control": "outline of a control, in its own colour",
}


def variables() -> str:
    """The colours that have a meaning as variables of a page's style sheet, ``--mark-x`` and so on."""
    known = [name for name in LEGEND if name in _COLOURS]
    light, dark = ("; ".join(f"--mark-{name}: {_COLOURS[name][side]}" for name in known) for side in (0, 1))
    return f":root {{ {light} }}\n@media (prefers-color-scheme: dark) {{ :root {{ {dark} }} }}\n"


def css() -> str:
    """The style sheet of a picture: light, and dark where the one who looks wants that."""
    light, dark = (
        _RULES.format(**{name: pair[side] for name, pair in _COLOURS.items()}).strip() for side in (0, 1)
    )
    dark = dark.replace("\n", "\n  ")
    return f"{light}\n@media (prefers-color-scheme: dark) {{\n  {dark}\n}}"
