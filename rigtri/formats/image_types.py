"""Which images browsers show, known by how their bytes begin.

Source: WHATWG MIME Sniffing Standard, "Matching an image type pattern"; AVIF 1.1 §6.3.
"""

from __future__ import annotations

_BEGINNINGS = (b"\x89PNG\r\n\x1a\n", b"\xff\xd8\xff", b"GIF87a", b"GIF89a", b"BM")
KINDS = "PNG, JPEG, WebP, AVIF, GIF or BMP"


def shows(image: bytes | memoryview) -> bool:
    """Whether browsers show such an image, if it is whole; its first 12 bytes are enough."""
    head = bytes(image[:12])
    if head.startswith(_BEGINNINGS):
        return True
    return (head[:4], head[8:]) == (b"RIFF", b"WEBP") or head[4:] in (b"ftypavif", b"ftypavis")
