"""rigtri verify

Skinned vertices and attachments, at rest, in the bind pose, at every key and
between keys; per mesh, clip and time. Exit code 6 when they differ by more than
the tolerance or something is lost.

\b
Example:
    rigtri verify hero.glb out.glb
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from rigtri.errors import DeviationError

from . import failures
from .given_options import check_streams, read_options
from .help_format import Command
from .option_types import FilePath
from .printing import print_json, print_warnings, warn_unused_root
from .progress import Progress
from .shared_options import output_options, reading_options, shared
from .terminal_text import echo, plain

if TYPE_CHECKING:
    from rigtri.model.rig import Rig
    from rigtri.verification.compare.compare import Comparison


# What comes first in a line.
_PAINTS = (
    (r"^(?:lost|different characters:)", "red"),
    (r"^(?:different|changed)(?= )", "yellow"),
    (r"^added", "green"),
)


@click.command("verify", cls=Command, help=__doc__)
@click.argument("before", metavar="BEFORE", type=FilePath(allow_dash=True))
@click.argument("after", metavar="AFTER", type=FilePath(allow_dash=True))
@shared("tolerance", help="Largest difference that passes, as a share of the bounding-box diagonal.")
@reading_options
@output_options
def command(before: str, after: str, tolerance: float, **values: Any) -> None:
    from rigtri.files.input_stream import opened
    from rigtri.formats import read
    from rigtri.pipeline.files import verify

    check_streams(before, after)
    options = read_options({**values, "empty": True})
    bar = Progress(after, quiet=values["quiet"] or values["as_json"])
    with opened(before) as one, opened(after) as other, bar:
        documents = read(Path(one), options), read(Path(other), options)
        result = verify(*documents)
    passes = result.passes(tolerance)
    another = _another_character(result, documents[0].rig)
    if not values["quiet"]:
        warn_unused_root(before, values["root"])
        missing = [each for one in documents for each in one.warnings if each.code == "unresolved"]
        print_warnings(dict.fromkeys(missing))
    if values["as_json"]:
        document = {"before": before, "after": after, "passes": passes, "tolerance": tolerance}
        print_json(document | result.as_json())
        failures.answered(click.get_current_context())
    elif not values["quiet"]:
        lines = [plain(f"different characters: {why}", one_line=True) for why in another]
        lines.append(result.describe(verbose=values["verbose"]))
        limit = "green" if passes else "red"
        echo("\n".join(lines), (*_PAINTS, (r"(?<=^deviation )  \S+", limit)))
    if not passes:
        names = ["standard input" if name == "-" else name for name in (after, before)]
        if another:
            raise DeviationError(f"{names[0]} and {names[1]} are different characters: {another[0]}")
        raise DeviationError(f"{' looks different from '.join(names)}: {result.summary(tolerance)}")


def _another_character(result: Comparison, before: Rig) -> list[str]:
    """That two files have hardly a joint in common, so that no measure says anything."""
    joints = before.is_joint.tolist().count(True)
    lost = sum(item.startswith("joint ") for item in result.lost)
    return [f"{lost} of {joints} joints of BEFORE are not in AFTER"] if 2 * lost > joints else []
