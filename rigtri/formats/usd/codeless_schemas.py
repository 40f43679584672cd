"""The API schemas of rigtri's own prims, made known to USD.

They are codeless: USD tools without them lose nothing. USD takes schemas up only before the first stage
of a process.

Source: OpenUSD, `UsdSchemaRegistry` and "Generating New Schema Classes" (codeless schemas).
"""

from __future__ import annotations

import warnings
from functools import cache
from importlib.resources import files
from pathlib import Path

from pxr import Plug, Usd

_ONE = "RigtriControlAPI"


@cache
def register_usd_schemas() -> None:
    """Let USD know the schemas of rigtri's prims: to be called before the first stage is opened.

    Reading and writing a USD file by rigtri does it, too; importing rigtri does not, for USD starts threads
    for it, and a process that has some cannot be forked safely. Later than that nothing helps: then a
    UserWarning comes with the first stage that rigtri opens.
    """
    folder = Path(str(files("rigtri.schemas"))) / "usd"
    if folder.is_dir():
        Plug.Registry().RegisterPlugins(str(folder))


@cache
def check_known() -> None:
    """Warn, once, where USD has opened a stage without the schemas; to be called when one is open."""
    if Usd.SchemaRegistry().FindAppliedAPIPrimDefinition(_ONE) is None:
        warnings.warn(
            "USD opened a stage before rigtri's schemas were registered, so GetAppliedSchemas leaves them "
            "out in this process; attributes are there all the same. "
            "Call rigtri.register_usd_schemas() before the first stage",
            stacklevel=2,
        )
