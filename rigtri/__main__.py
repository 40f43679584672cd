"""``python -m rigtri``: the command line."""

from importlib import import_module

# The program imports everything, and nothing imports the program.
import_module("rigtri.cli.main").program()
