"""A violation of a rule as the error of a reader."""

from __future__ import annotations

from typing import NoReturn

from rigtri.errors import FileError
from rigtri.formats.rules import Violation


def refuse(where: str, violation: Violation) -> NoReturn:
    """Raise a FileError with the place, what is wrong there, and the remedy of the rule."""
    # Catalogues are of use only here: a file that can be read needs none.
    from rigtri.formats.gltf.rules import animation_catalogue, structure_catalogue

    rules = (*structure_catalogue.RULES, *animation_catalogue.RULES)
    remedy = next(rule.remedy for rule in rules if rule.id == violation.rule)
    raise FileError(f"{where} {violation.text}. {remedy}")
