"""Which addresses of nodes a glTF answers to."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from rigtri.verification.checks.gltf.check_gltf import _address

VIEW: Any = SimpleNamespace(nodes=[{"name": "hips"}, {"name": "leg"}, {}, {"name": "leg"}, {"name": ""}])


@pytest.mark.parametrize(
    ("name", "known"),
    [
        ("hips#0", True),
        ("leg#3", True),
        ("leg#0", False),
        ("#1", True),
        ("#4", True),
        ("#5", False),
        ("leg#9", False),
        ("#x", False),
        ("/hips/leg", True),
        ("/hips/arm", False),
        ("/hips/#2", True),  # a node without a name
        ("/hips/#4", True),
        ("/hips/#1", False),
        ("hips/#2", False),
        ("/hips/leg#3", False),
        ("hips", False),
    ],
)
def test_an_address_is_known_by_name_and_number_or_by_its_last_name(name: str, known: bool) -> None:
    assert _address(VIEW, name) is known
