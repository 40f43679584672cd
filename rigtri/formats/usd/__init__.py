"""USD files. Importing this makes the API schemas of rigtri's own prims known to USD."""

from importlib.resources import files
from pathlib import Path

from pxr import Plug

# Codeless, so that tools without it lose nothing; USD takes them up only before its first stage.
_SCHEMAS = Path(str(files("rigtri.schemas"))) / "usd"
if _SCHEMAS.is_dir():
    Plug.Registry().RegisterPlugins(str(_SCHEMAS))
