"""What may be wrong with a .usdz package around its layers.

Source: USDZ specification (openusd.org/release/spec_usdz.html); PKWARE APPNOTE 6.3.
"""

from __future__ import annotations

from pathlib import Path

from rigtri.verification.checks.findings import Findings, Rule

_PACK = "Pack it again, with usdzip or the program that wrote it."

RULES = (
    Rule(
        "usd.package.checksum",
        "error",
        "An entry of a package does not have the checksum that the directory gives it: it is damaged.",
        "Copy or export the package again.",
    ),
    Rule(
        "usd.package.compressed",
        "error",
        "An entry of a package is compressed, which USDZ forbids: USD cannot read it.",
        _PACK,
    ),
    Rule(
        "usd.package.alignment",
        "warning",
        "The data of an entry of a package do not start at a multiple of 64 bytes, as USDZ demands.",
        _PACK,
    ),
    Rule(
        "usd.package.junk",
        "warning",
        "Bytes follow the end of a package, which some programs then do not find.",
        _PACK,
    ),
    Rule(
        "usd.package.backslash",
        "warning",
        "The name of an entry of a package has a backslash, which is no separator: USD does not find it.",
        _PACK,
    ),
)


def check(path: Path, findings: Findings) -> None:
    """Note what is wrong with a package. FileError where it is none."""
    from rigtri.formats.usd import usdz  # the rules are known also where USD is not installed

    whole = usdz.read(path)
    for entry in whole.entries:
        place = f"entry '{entry.name}'"
        if not whole.is_whole(entry):
            findings.add("usd.package.checksum", "package", entry.name, f"{place} does not have its checksum")
        if entry.method:
            findings.add("usd.package.compressed", "package", entry.name, f"{place} is compressed")
        if entry.start % usdz.ALIGNMENT:
            text = f"the data of {place} start at byte {entry.start}"
            findings.add("usd.package.alignment", "package", entry.name, text)
        if "\\" in entry.name:
            findings.add("usd.package.backslash", "package", entry.name, f"{place} has a backslash")
    if whole.junk > 0:
        findings.add("usd.package.junk", "package", "", f"{whole.junk} bytes follow the end of the package")
