"""What characters are made of, said by hand, and how far recognition agrees."""

from __future__ import annotations

import sys

from places import SAMPLES

# The samples' own script, figure.py, has what bodies are made with.
if str(SAMPLES) not in sys.path:
    sys.path.append(str(SAMPLES))
