"""SVG as PNG, by resvg, with the font that Pillow brings (the extra ``rigtri[png]``)."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory

from rigtri.errors import UsageError


def check_installed() -> None:
    """UsageError where there is nothing to make PNG with."""
    if find_spec("resvg_py") is None or find_spec("PIL") is None:
        raise UsageError(
            "PNG pictures need resvg and Pillow; install them with: pip install 'rigtri[png]' "
            "(SVG needs nothing)"
        )


def png(svg: str) -> bytes:
    """The picture as PNG in its own size and light colours. Raises UsageError as `check_installed`.

    Words have Pillow's font, the same on every machine; letters that it lacks are of a font of the machine.
    """
    check_installed()
    import resvg_py
    from PIL import ImageFont

    font = ImageFont.load_default(size=12)
    if not isinstance(font, ImageFont.FreeTypeFont):
        raise UsageError("This Pillow has no FreeType, so a PNG picture would have no words; write SVG")
    family, _ = font.getname()
    with TemporaryDirectory() as folder:
        path = Path(folder, "font.ttf")
        path.write_bytes(font.font_bytes)
        made = resvg_py.svg_to_bytes(svg_string=svg, font_files=[str(path)], sans_serif_family=family)
    return bytes(made)
