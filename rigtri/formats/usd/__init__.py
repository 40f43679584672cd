"""USD files. Importing this makes the API schemas of rigtri's own prims known to USD."""

from rigtri.formats.usd.codeless_schemas import register_usd_schemas

register_usd_schemas()
