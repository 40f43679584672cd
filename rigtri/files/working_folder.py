"""No modules from the folder where somebody works, whose files come from anybody.

It goes before all else that a program imports, and so it imports only what Python has loaded by then.
"""

import os
import sys


def leave_out_working_folder() -> None:
    """Let this process import nothing from its working folder, except where rigtri itself lies there."""
    try:
        here = os.path.realpath(os.getcwd())
    except FileNotFoundError:  # one that somebody has removed holds no modules
        return
    if here != os.path.realpath(os.path.join(__file__, "..", "..", "..")):
        sys.path[:] = [entry for entry in sys.path if os.path.realpath(entry) != here]
