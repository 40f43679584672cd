"""A stage as it is with edits that are not written yet: what further edits of a writer go on from."""

from __future__ import annotations

from collections.abc import Sequence

from pxr import Sdf

from rigtri.formats.document import ReadOptions
from rigtri.formats.usd.composition import layers
from rigtri.formats.usd.opinions.edits import Edit
from rigtri.formats.usd.reading.reader import Source, read_source


def edited(source: Source, edits: Sequence[Edit], options: ReadOptions) -> Source:
    """``source`` read anew, with ``edits`` as opinions over it; its file stays as it is.

    Raises FileError where the result breaks UsdSkel's rules.
    """
    opinions = layers.empty()
    layers.copy_clock(source.layer, opinions)
    with Sdf.ChangeBlock():
        for edit in edits:
            edit(opinions)
    return read_source(source.path, options, layers.over(opinions, source.layer))
