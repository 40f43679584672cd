"""Edits of the metadata of rigtri: on prims as attributes, of joints as attributes of their skeleton."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from rigtri.formats.usd.opinions.edits import Edit, set_value
from rigtri.formats.usd.reading.metadata_attributes import PREFIX, Metadata, joint_attributes


def set_attributes(prim: Any, attributes: Mapping[str, tuple[Any, Any]]) -> list[Edit]:
    """Set custom attributes, each a type and a value; rigtri's own are uniform."""
    return [
        set_value(prim, name, type_name, value, custom=True, uniform=name.startswith(PREFIX))
        for name, (type_name, value) in attributes.items()
    ]


def set_joint_metadata(skeleton: Any, by_token: Mapping[str, Metadata]) -> list[Edit]:
    """Set the metadata of a skeleton's joints, complete."""
    return set_attributes(skeleton, joint_attributes(by_token))
