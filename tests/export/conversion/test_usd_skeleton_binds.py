"""Skins share a skeleton where their bind poses are one but for where the skin is."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.testing import assert_allclose

from rigtri.export.conversion import usd_skeletons


def place(x: float, y: float = 0.0, size: float = 1.0) -> Any:
    matrix = np.eye(4) * size
    matrix[3] = (x, y, 0, 1)
    return matrix


def binds(*matrices: Any) -> Any:
    return np.linalg.inv(np.stack(matrices))


def skeleton() -> Any:
    kind = next(
        one for one in vars(usd_skeletons).values() if isinstance(one, type) and hasattr(one, "unscale")
    )
    made = kind.__new__(kind)
    object.__setattr__(made, "bind", {})
    object.__setattr__(made, "skins", {})
    return made


def test_the_same_bind_pose_elsewhere_is_the_same() -> None:
    made = skeleton()
    assert made.add(0, [4, 5], binds(place(1), place(2)))
    assert_allclose(made.bind[4], place(1))
    assert_allclose(made.skins[0], np.eye(4))
    # All three units further up: what takes points there does so before.
    assert made.add(1, [5, 6], binds(place(2, 3), place(7, 3)))
    assert_allclose(made.skins[1], place(0, -3), atol=1e-12)
    assert_allclose(made.bind[6], place(7), atol=1e-12)
    assert_allclose(made.bind[5], place(2))


def test_another_bind_pose_is_not_taken_up() -> None:
    made = skeleton()
    assert made.add(0, [4, 5], binds(place(1), place(2)))
    assert not made.add(1, [4, 5, 6], binds(place(1), place(2.1), place(3)))
    assert set(made.skins) == {0}
    assert 6 not in made.bind
    assert made.add(2, [4, 5], binds(place(1), place(2 + 1e-9)))
    assert made.add(3, [8], binds(place(9)))
    assert_allclose(made.bind[8], place(9))
