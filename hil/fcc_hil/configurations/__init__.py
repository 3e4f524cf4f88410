"""Configurations of the daemon for JSBSim's aircraft: one file for each, as `fccd` reads it.

The defaults are for a Cessna 172. `[autopilot.scale]` scales the gains; most files need only that,
the aircraft's speeds and the duration of its legs.
"""

from __future__ import annotations

from collections.abc import Mapping
from importlib import resources

import tomlkit
from tomlkit.exceptions import TOMLKitError
from tomlkit.items import Table

from ..pattern import TimedPattern


def configuration(aircraft: str) -> str:
    """Return the text of an aircraft's configuration; empty if there is no file for it."""
    file = resources.files(__name__) / f"{aircraft}.toml"
    return file.read_text(encoding="utf-8") if file.is_file() else ""


def value_of(text: str, key: str, default: float) -> float:
    """Return the number at a dotted key of a configuration, or `default` if it is missing."""
    node: object = _parsed(text)
    for part in key.split("."):
        if not isinstance(node, Mapping) or part not in node:
            return default
        node = node[part]
    if isinstance(node, bool) or not isinstance(node, (int, float)):
        raise ValueError(f"configuration: {key} is {node!r}: give a number")
    return float(node)


def with_values(text: str, values: Mapping[str, float | str | list[float]]) -> str:
    """Return a configuration with dotted keys set; comments and order are kept."""
    document = _parsed(text)
    for key, value in values.items():
        *sections, leaf = key.split(".")
        node: tomlkit.TOMLDocument | Table = document
        for section in sections:
            if section not in node:
                node[section] = tomlkit.table(is_super_table=section != sections[-1])
            inner = node[section]
            if not isinstance(inner, Table):
                raise ValueError(f"configuration: {key}: '{section}' is no section")
            node = inner
        node[leaf] = value
    return tomlkit.dumps(document)


def without_section(text: str, name: str) -> str:
    """Return a configuration without one of its sections, if it has it."""
    document = _parsed(text)
    document.pop(name, None)
    return tomlkit.dumps(document)


def pattern_of(text: str) -> TimedPattern:
    """Return the timed pattern of a configuration."""
    default = TimedPattern()
    return TimedPattern(
        hold_s=value_of(text, "guidance.hold_s", default.hold_s),
        leg_s=value_of(text, "guidance.leg_s", default.leg_s),
        turn_deg=value_of(text, "guidance.turn_deg", default.turn_deg),
        climb_ft=value_of(text, "guidance.climb_ft", default.climb_ft),
    )


def _parsed(text: str) -> tomlkit.TOMLDocument:
    try:
        return tomlkit.parse(text)
    except TOMLKitError as error:
        raise ValueError(f"configuration: {error}") from None
