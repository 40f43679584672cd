"""What operations build into any file: nothing moves, a second run changes no byte, metadata are valid."""

from __future__ import annotations

from itertools import product
from pathlib import Path

import pytest
from builds import STEPS
from places import asset_files, leave_out_refused, sample_files
from second_opinions import validator

from rigtri.errors import FileError, RigtriError
from rigtri.formats import ReadOptions, read
from rigtri.pipeline.edit import edit
from rigtri.verification.compare.compare import verify

# A result in another folder refers to the layers of its source, which lie outside that folder.
TRUSTING = ReadOptions(lenient=True, allow_external_paths=True)
# Of a second run, new joints are joints like all others.
ONCE = [name for name in STEPS if name not in ("control joints", "split weights")]


# Each sample with each step, and each real file with two, so that each step meets some eight of them.
CASES = [
    *product(sample_files(), ONCE),
    *(
        (path, ONCE[(number + more) % len(ONCE)])
        for number, path in enumerate(asset_files())
        for more in (0, 5)
    ),
]


@pytest.mark.parametrize(("path", "name"), CASES, ids=lambda value: getattr(value, "name", value))
def test_what_is_built_moves_nothing_and_comes_only_once(path: Path, name: str, tmp_path: Path) -> None:
    once, twice = tmp_path / path.name, tmp_path / f"twice{path.suffix}"
    try:
        edit(path, once, STEPS[name], options=TRUSTING)
    except FileError as error:
        leave_out_refused(path, error)
    except RigtriError:  # nothing in this file is there to build it for
        return
    found = verify(read(path, TRUSTING), read(once, TRUSTING))
    assert found.deviation == 0.0
    assert found.lost == ()
    schema = validator("node")
    for metadata in read(once, TRUSTING).rig.metadata.values():
        schema.validate(metadata)
    report = edit(once, twice, STEPS[name], options=TRUSTING).report
    assert once.read_bytes() == twice.read_bytes()
    assert not any(entry["new"] for entry in report.added)
