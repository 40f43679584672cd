"""The version, alone, so that nobody has to import the root."""

__version__ = "0.2.0"
