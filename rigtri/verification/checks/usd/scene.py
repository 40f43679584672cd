"""A USD stage read tolerantly: its skeletons, animations and bound prims, and where findings go."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from pxr import Sdf, Usd, Vt

from rigtri.errors import FileError
from rigtri.formats.usd.composition.stage import DEFAULT, quiet
from rigtri.formats.usd.composition.value_types import TYPES, wrong_type
from rigtri.formats.usd.reading.mesh_reader import ALL_PRIMS
from rigtri.verification.checks.findings import Findings

_WORDS = (Vt.TokenArray, Vt.StringArray)
BINDING = ("skel", "primvars:skel")


@dataclass
class Scene:
    """skeletons, animations, bound: prims by kind; bound have ``skel:`` properties.

    tokens: the joints of each skeleton by its path. users: the skeletons that each
    animation drives, by paths.
    """

    stage: Any
    findings: Findings
    skeletons: list[Any] = field(default_factory=list)
    animations: list[Any] = field(default_factory=list)
    bound: list[Any] = field(default_factory=list)
    noted: list[Any] = field(default_factory=list)
    tokens: dict[str, tuple[str, ...]] = field(default_factory=dict)
    users: dict[str, list[str]] = field(default_factory=dict)

    def find(self) -> None:
        """Sort the prims of the stage, those inside instances included."""
        for prim in Usd.PrimRange(self.stage.GetPseudoRoot(), ALL_PRIMS):
            kind = prim.GetTypeName()
            if kind == "Skeleton":
                self.skeletons.append(prim)
            elif kind == "SkelAnimation":
                self.animations.append(prim)
            if any(prim.GetAuthoredPropertiesInNamespace(space) for space in BINDING):
                self.bound.append(prim)
            if prim.GetAuthoredPropertiesInNamespace("rigtri"):
                self.noted.append(prim)

    def guard(self, prim: Any, check: Callable[[Scene, Any], None]) -> None:
        """Run a check; what USD itself cannot read of the prim becomes a finding."""
        try:
            with quiet("USD cannot read it"):
                check(self, prim)
        except FileError as error:
            self.add("usd.type", prim, "", str(error))

    def add(self, rule: str, prim: Any, name: str, message: str) -> None:
        """Note a finding about a prim, or about its property ``name``."""
        place = f"{prim.GetTypeName() or 'prim'} '{prim.GetName()}'"
        self.findings.add(rule, place, self._pointer(prim, name), message)

    def _pointer(self, prim: Any, name: str) -> str:
        """``</Root/Skel>.joints``, behind the layer that has it where it is not the root layer."""
        path = f"<{prim.GetPath()}>" + (f".{name}" if name else "")
        prop = prim.GetProperty(name) if name else None
        stack = prop.GetPropertyStack(DEFAULT) if prop else prim.GetPrimStack()
        layers = [spec.layer for spec in stack if not spec.layer.anonymous]
        root = self.stage.GetRootLayer()
        if not layers or root in layers or root.anonymous:
            return path
        return f"{layers[0].GetDisplayName()} {path}"

    # --- values

    def words(self, prim: Any, name: str) -> tuple[str, ...]:
        """The tokens of an attribute; nothing, with a finding, where it holds something else."""
        attribute = prim.GetAttribute(name)
        value = attribute.Get(DEFAULT) if attribute else None
        if value is None:
            return ()
        if name in TYPES and self._mistyped(prim, name, value):
            return ()
        if not isinstance(value, _WORDS):
            kind = "an unknown type" if isinstance(value, Sdf.UnregisteredValue) else type(value).__name__
            self.add("usd.type", prim, name, f"{name} holds {kind} and should hold tokens")
            return ()
        return tuple(str(token) for token in value)

    def array(self, prim: Any, name: str, value: Any) -> np.ndarray | None:
        """The items of an attribute; None, with a finding, where UsdSkel does not read their type."""
        return None if self._mistyped(prim, name, value) else np.array(value)

    def keys(self, prim: Any, name: str) -> list[tuple[Any, Any]]:
        """The values of an attribute by their times, ``"default"`` first; blocked and empty ones left out."""
        attribute = prim.GetAttribute(name)
        if not attribute or not attribute.HasAuthoredValue():
            return []
        default = attribute.Get(DEFAULT)
        empty = default is None or (hasattr(default, "__len__") and not len(default))
        found: list[tuple[Any, Any]] = [] if empty else [("default", default)]
        found += [(time, attribute.Get(time)) for time in attribute.GetTimeSamples()]
        return [(time, value) for time, value in found if value is not None]

    def has_other(self, prim: Any, name: str) -> bool:
        """Whether an attribute holds what UsdSkel does not read; reading it reports that."""
        value = prim.GetAttribute(name).Get(DEFAULT)
        return value is not None and bool(wrong_type(name, value))

    def _mistyped(self, prim: Any, name: str, value: Any) -> bool:
        why = wrong_type(name, value)
        if why:
            self.add("usd.type", prim, name, f"{why}, so for UsdSkel {TYPES[name].lost}")
        return bool(why)


def at_time(time: Any) -> str:
    return "by default" if time == "default" else f"at time {time:g}"
