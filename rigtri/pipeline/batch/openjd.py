"""A batch as a job that render farms run: an Open Job Description template, with the files that it is about.

Source: https://github.com/OpenJobDescription/openjd-specifications, Template Schemas 2023-09 with the
extension TASK_CHUNKING.
"""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rigtri.errors import FileError, UsageError
from rigtri.files.staged_output import as_file_error, write_text
from rigtri.pipeline.batch import urls
from rigtri.pipeline.batch.inputs import Entry

TEMPLATE, JOB = "template.json", "job.jsonl"
# Files of a part; parts of a chunk are as many as make so many chunks, where the farm does not choose itself.
FILES, CHUNKS = 25, 200
# What a farm that chooses aims at, in seconds for a chunk.
_RUNTIME = 600


def emit(folder: Path, entries: Sequence[Entry], words: Sequence[str]) -> int:
    """Write a template and the job file that it reads into ``folder``; the number of parts.

    words: the arguments of `rigtri batch` besides the job file and the part. UsageError where ``folder`` has
    such files.
    """
    for name in (TEMPLATE, JOB):
        if (folder / name).exists():
            raise UsageError(f"{folder / name} exists; remove it, or give --emit-openjd another folder")
    if folder.exists() and not folder.is_dir():
        raise FileError(f"{folder} is not a folder to write {TEMPLATE} into")
    with as_file_error(folder):
        folder.mkdir(parents=True, exist_ok=True)
    parts = -(-len(entries) // FILES)
    write_text(folder / JOB, "".join(_line(entry) + "\n" for entry in entries))
    whole = template(["batch", "--job", os.path.abspath(folder / JOB), *words], parts)
    write_text(folder / TEMPLATE, json.dumps(whole, indent=2, ensure_ascii=False) + "\n")
    return parts


def template(words: Sequence[str], parts: int) -> dict[str, Any]:
    """The template of a job that calls the program with ``words`` for each chunk of its parts."""
    parameters = [
        {"name": "Rigtri", "type": "STRING", "default": "rigtri", "description": "The program on the workers"}
    ]
    arguments = []
    for number, word in enumerate(words, 1):
        if "{{" in word:  # the template would see an expression there, and has no way to write braces
            parameters.append({"name": f"Word{number}", "type": "STRING", "default": word})
            word = f"{{{{Param.Word{number}}}}}"
        arguments.append(word)
    part = {
        "name": "Part",
        "type": "CHUNK[INT]",
        "range": f"1-{parts}",
        "chunks": {
            "defaultTaskCount": -(-parts // CHUNKS),
            "targetRuntimeSeconds": _RUNTIME,
            "rangeConstraint": "CONTIGUOUS",
        },
    }
    action = {
        "command": "{{Param.Rigtri}}",
        "args": [*arguments, "--shard", f"{{{{Task.Param.Part}}}}/{parts}"],
    }
    step = {
        "name": "batch",
        "parameterSpace": {"taskParameterDefinitions": [part]},
        "script": {"actions": {"onRun": action}},
    }
    return {
        "specificationVersion": "jobtemplate-2023-09",
        "extensions": ["TASK_CHUNKING"],
        "name": "rigtri batch",
        "parameterDefinitions": parameters,
        "steps": [step],
    }


def _line(entry: Entry) -> str:
    line: dict[str, Any] = {"input": _whole(entry.source), "output": _whole(entry.target)}
    if entry.variables:
        line["variables"] = dict(entry.variables)
    return json.dumps(line)


def _whole(name: str) -> str:
    return name if urls.is_url(name) else os.path.abspath(name)
