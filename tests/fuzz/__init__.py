"""Mutated real files: whatever they hold, the answer is a verified output or an error of ours.

`python -m fuzz` in the folder tests runs it; docs/fuzzing.md says what has been run.
"""

import sys
from pathlib import Path

# As pytest has it: what files are built with lies beside.
sys.path.append(str(Path(__file__).resolve().parents[1] / "builders"))
