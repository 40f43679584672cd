"""rigtri check

Skins, joints, clips, weights, VRM and rigtri's metadata in glTF; skeletons, animations
and bindings in USD. Exit code 0 when nothing worse than a warning is found, 1 with
errors (--strict: or warnings), 3 when a file cannot be read at all.

\b
Example:
    rigtri check hero.glb
    rigtri check hero.glb --profile unreal
    rigtri check --json --ignore 'gltf.joint.*' *.glb *.usda
"""

from __future__ import annotations

import sys
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, get_args

import click

from rigtri.errors import UsageError
from rigtri.progress import counted
from rigtri.report import SEVERITIES
from rigtri.verification import Profile

from .help_format import Command, option
from .option_types import FilePath
from .printing import print_json
from .progress import Progress
from .shared_options import json_option, quiet_option, shared
from .terminal_text import echo, plain, plain_lines

if TYPE_CHECKING:
    from rigtri.files.worker_process import WorkerProcess
    from rigtri.verification.checks.findings import Finding

# What may be binary USD, which can crash OpenUSD.
BINARY_USD = (".usd", ".usdc", ".usdz")
# Findings of one kind in a file that are shown without -v.
MOST_ALIKE = 4
_PAINTS = (
    (r"^  error:|(?<=: )\d+ errors?", "red"),
    (r"^  warning:|(?<=[:,] )\d+ warnings?", "yellow"),
    (r"^  info:|(?<=[:,] )\d+ infos?", "cyan"),
    (r"nothing wrong$", "green"),
)


@click.command("check", cls=Command, help=__doc__)
@click.argument("files", metavar="FILE…", nargs=-1, type=FilePath(allow_dash=True))
@option(
    "--severity",
    type=click.Choice(SEVERITIES),
    default="info",
    show_default=True,
    help="Hide less severe findings.",
    group="what",
)
@option(
    "--ignore",
    multiple=True,
    metavar="ID",
    help="Hide the findings of a check; * matches anything.",
    group="what",
)
@option(
    "--profile",
    type=click.Choice(get_args(Profile)),
    help="Also check what this engine's documentation asks of a character.",
    group="what",
)
@option("--strict", is_flag=True, help="Treat warnings as errors.", group="safety")
@option("--external", is_flag=True, help="USD: add the findings of OpenUSD's own validators.", group="what")
@option("--list", "list_rules", is_flag=True, help="Print every id with its meaning, and exit.", group="what")
@shared("allow_external_paths")
@option(
    "-v",
    "--verbose",
    is_flag=True,
    help="Show every finding, and what to do about each kind.",
    group="output",
)
@quiet_option
@json_option
def command(files: tuple[str, ...], **values: Any) -> None:
    from rigtri.files.worker_process import WorkerProcess
    from rigtri.verification.checks.rule_catalogue import matching

    if values["list_rules"]:
        _list(values["as_json"], values["profile"])
        return
    if not files:
        raise UsageError("name a file to check, or --list")
    if values["strict"] and values["severity"] == "error":
        raise UsageError("--strict fails on warnings, and --severity error leaves them out; give one of them")
    ignored = matching(values["ignore"])
    bar = Progress(files[0] if len(files) == 1 else "check", quiet=values["quiet"] or values["as_json"])
    with WorkerProcess() as child, bar:  # the process starts with the first file that needs it
        every = {name: _check(name, values, child) for name in counted(files, "files")}
    results = {name: _kept(findings, ignored, values["severity"]) for name, findings in every.items()}
    left_out = {name: _without(every[name], results[name]) for name in files}
    code = _exit_code(results, strict=values["strict"])
    if values["as_json"]:
        print_json(as_json(results, left_out, code))
    else:
        for name, findings in results.items():
            _print_file(name, findings, left_out[name], verbose=values["verbose"], quiet=values["quiet"])
    sys.exit(code)


def _check(name: str, values: dict[str, Any], child: WorkerProcess) -> list[Finding]:
    """The findings of one file; - is standard input."""
    from rigtri.files.input_stream import opened
    from rigtri.verification.checks import check

    options = {key: values[key] for key in ("allow_external_paths", "external", "profile")}
    if name != "-":
        return (
            _check_in_worker(child, Path(name), options) if _may_crash(Path(name)) else check(name, **options)
        )
    with opened(name) as path:
        return _check_in_worker(child, path, options) if _may_crash(path) else check(path, **options)


def _may_crash(path: Path) -> bool:
    return path.suffix.lower() in BINARY_USD and path.is_file()


def _check_in_worker(child: WorkerProcess, path: Path, options: dict[str, Any]) -> list[Finding]:
    """The findings of a file that may end the process that reads it: OpenUSD crashes on some."""
    from rigtri.files.worker_process import CrashError
    from rigtri.verification.checks import check, unreadable

    try:
        return child(str(path), partial(check, **options), path)
    except CrashError as error:
        return unreadable(path, error)


def _kept(findings: list[Finding], ignored: set[str], severity: str) -> list[Finding]:
    shown = SEVERITIES[: [*SEVERITIES].index(severity) + 1]  # type: ignore[arg-type]
    return [item for item in findings if item.id not in ignored and item.severity in shown]


def _without(findings: list[Finding], shown: list[Finding]) -> list[Finding]:
    known = set(shown)
    return [item for item in findings if item not in known]


def _exit_code(results: dict[str, list[Finding]], *, strict: bool) -> int:
    from rigtri.verification.checks.rule_catalogue import UNREADABLE

    found = [item for findings in results.values() for item in findings]
    if any(item.id == UNREADABLE for item in found):
        return 3
    bad = ("error", "warning") if strict else ("error",)
    return int(any(item.severity in bad for item in found))


def as_json(
    results: dict[str, list[Finding]], left_out: dict[str, list[Finding]], code: int
) -> dict[str, Any]:
    """The findings of all files, and how many were left out, as schemas/check.schema.json describes them."""
    from rigtri._version import __version__
    from rigtri.verification.checks.findings import counts
    from rigtri.verification.checks.rule_catalogue import UNREADABLE

    every = [item for findings in results.values() for item in findings]
    return {
        "rigtri": __version__,
        "command": "check",
        "exit_code": code,
        **counts(every),
        "files": [
            {
                "file": name,
                "readable": all(item.id != UNREADABLE for item in findings),
                **counts(findings),
                "left_out": len(left_out[name]),
                "findings": [item.as_json() for item in findings],
            }
            for name, findings in results.items()
        ],
    }


def _print_file(
    name: str, findings: list[Finding], left_out: list[Finding], *, verbose: bool, quiet: bool
) -> None:
    """One file: its findings, of many alike only the first, and how many there are."""
    from rigtri.verification.checks.findings import counts

    if quiet and not any(item.severity == "error" for item in findings):
        return
    shown = _counted(counts(findings)) or ("nothing shown" if left_out else "nothing wrong")
    rest = f" ({_counted(counts(left_out))} left out)" if left_out else ""
    echo(plain(f"{name}: {shown}{rest}", one_line=True), _PAINTS)
    printed: dict[str, int] = {}
    for item in findings:
        if quiet and item.severity != "error":
            continue
        printed[item.id] = printed.get(item.id, 0) + 1
        if verbose or printed[item.id] <= MOST_ALIKE:
            lines = [f"  {item.severity}: {item.place}: {item.message}  [{item.id}]"]
            if verbose:
                lines.append(f"      at {item.pointer or 'the file'}. {item.remedy}")
            elif printed[item.id] == 1:
                lines.append(f"      {item.remedy}")
            echo(plain_lines(lines), _PAINTS)
        elif printed[item.id] == MOST_ALIKE + 1:
            more = sum(other.id == item.id for other in findings) - MOST_ALIKE
            echo(f"  {item.severity}: {more} more of these; -v shows all  [{item.id}]", _PAINTS)


def _counted(numbers: dict[str, int]) -> str:
    words = [
        f"{count} {key if count != 1 else key.removesuffix('s')}" for key, count in numbers.items() if count
    ]
    return ", ".join(words)


def _list(machine: bool, profile: Profile | None) -> None:
    from rigtri.verification.checks.profile_check import rules_of
    from rigtri.verification.checks.rule_catalogue import RULES

    every = [*RULES.values(), *(() if profile is None else rules_of(profile))]
    if machine:
        print_json([rule.as_json() for rule in every])
        return
    for rule in every:
        click.echo(f"{rule.id} ({rule.severity})\n    {rule.meaning}\n    {rule.remedy}")
