"""``python -m rigtri``: the command line."""

from rigtri.cli.main import program

program()
