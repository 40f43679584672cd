"""SVG as PNG, by resvg (the extra ``rigtri[png]``)."""

from __future__ import annotations

from importlib.util import find_spec

from rigtri.errors import UsageError
from rigtri.report import Report

# A letter alone: where no font is found it leaves nothing.
_LETTER = '<svg xmlns="http://www.w3.org/2000/svg" width="16" height="16">{}</svg>'
_FOUND = '<text y="12" font-family="sans-serif">M</text>'


def check_installed() -> None:
    """UsageError where there is nothing to make PNG with."""
    if find_spec("resvg_py") is None:
        raise UsageError(
            "PNG pictures need resvg; install it with: pip install 'rigtri[png]' (SVG needs nothing)"
        )


def png(svg: str, report: Report | None = None) -> bytes:
    """The picture as PNG in its own size and light colours.

    Raises UsageError where resvg is not installed; a warning of the report where no font is.
    """
    check_installed()
    import resvg_py

    if report is not None and "<text" in svg:
        drawn, empty = (resvg_py.svg_to_bytes(svg_string=_LETTER.format(text)) for text in (_FOUND, ""))
        if drawn == empty:
            report.warn(
                "no-font",
                "There is no font here, so the picture has no words; install one (Debian: apt-get install "
                "fonts-dejavu-core), or write SVG",
            )
    return bytes(resvg_py.svg_to_bytes(svg_string=svg))
