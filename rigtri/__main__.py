"""The program, as the script ``rigtri`` and ``python -m rigtri`` start it."""

from importlib import import_module


def program() -> None:
    """Run the command line of this process, which ends with it."""
    import_module("rigtri.files.working_folder").leave_out_working_folder()
    # The program imports everything, and nothing imports the program.
    import_module("rigtri.cli").begin()
    import_module("rigtri.cli.main").program()


if __name__ == "__main__":
    program()
