"""Configuration keys in the documents exist, and have the defaults that are told of them."""

from __future__ import annotations

import re
from pathlib import Path

import fcc
import pytest

ROOT = Path(__file__).parents[2]
DOCUMENTS = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
DOTTED = re.compile(r"`([a-z][a-z0-9_-]*(?:\.[a-z][a-z0-9_-]*)+)`")
# Parts of records and recordings, attributes of Python, and the kernel's.
NO_SECTIONS = {
    *("measurements", "estimate", "setpoints", "outputs", "stages", "state", "tick"),
    *("fcc", "fcc_hil", "fccd", "flight", "numpy", "time", "vm", "performance_hints"),
}
FILES = re.compile(r"\.(?:toml|rs|py|md|json|mcap|so|h|proto|service|log|txt|files|ma)$")
# `key` (5 s), and 250 ms (`key`).
NUMBER = r"(?<![\w-])(?P<number>[\d,]+(?:\.\d+)?)(?: (?P<unit>s|ms|m|ft|kt|%))?"
DEFAULTS = (
    re.compile(rf"`(?P<key>[a-z][\w.-]*\.[\w-]+)` \({NUMBER}[),;]"),
    re.compile(rf"{NUMBER} \(`(?P<key>[a-z][\w.-]*\.[\w-]+)`\)"),
)


def keys(document: Path) -> list[str]:
    """Return the dotted names that are neither files nor parts of something else."""
    names = DOTTED.findall(document.read_text())
    return sorted(
        {
            name
            for name in names
            if not FILES.search(name) and name.partition(".")[0] not in NO_SECTIONS
        }
    )


def exists(key: str) -> bool:
    """Ask the reader of configurations, which names a key that it does not have."""
    section, _, name = key.rpartition(".")
    begins = "[[" if section.partition(".")[0] in ("sensor", "actuator") else "["
    header = f"{begins}{section}{']' * len(begins)}"
    try:
        fcc.Config(f"{header}\n{name} = 0\n")
    except fcc.ConfigError as error:
        return "there is no such key" not in str(error)
    return True


@pytest.mark.parametrize("key", sorted({key for document in DOCUMENTS for key in keys(document)}))
def test_a_key_of_the_documents_exists(key: str) -> None:
    # Below a header that the page has just named, the first section is left out.
    assert exists(key) or exists(f"autopilot.{key}")


def test_a_key_that_is_none_is_found() -> None:
    assert exists("actuator.channel")
    assert not exists("servo.channel")
    assert not exists("failsafe.hold")


def told() -> list[tuple[str, str, float]]:
    """Return document, key and number of each default that is told."""
    found = []
    for document in DOCUMENTS:
        for pattern in DEFAULTS:
            for match in pattern.finditer(document.read_text()):
                number = float(match["number"].replace(",", ""))
                in_ms = match["unit"] == "s" and match["key"].endswith("_ms")
                found.append((document.name, match["key"], number * (1_000 if in_ms else 1)))
    return found


@pytest.mark.parametrize(("document", "key", "number"), told())
def test_a_default_of_the_documents_is_that_of_the_program(
    document: str, key: str, number: float
) -> None:
    default = fcc.Config("[x-plane]\n")
    assert key in default, document
    assert default[key] == number


def test_some_defaults_are_told() -> None:
    assert len(told()) > 8
