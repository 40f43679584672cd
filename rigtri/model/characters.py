"""The characters of a rig: what skins with common joints move, and what is below these joints."""

from __future__ import annotations

import numpy as np

from rigtri.model.rig import Rig


def characters(rig: Rig) -> list[list[int]]:
    """The nodes of each character: joints of skins that share any, and all below them, in order."""
    number = np.full(len(rig), -1)
    for k, skin in enumerate(rig.skins):
        known = set(number[skin.joints].tolist()) - {-1}
        number[np.isin(number, list(known))] = k
        number[skin.joints] = k
    for node, parent in enumerate(rig.parents.tolist()):
        if parent >= 0 and number[parent] >= 0 and number[node] != number[parent]:
            # What a joint carries is of its character, other skeletons too.
            own = number == number[node] if number[node] >= 0 else node
            number[own] = number[parent]
    found: dict[int, list[int]] = {}
    for node, k in enumerate(number.tolist()):
        if k >= 0:
            found.setdefault(k, []).append(node)
    return list(found.values())
