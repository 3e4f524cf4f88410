"""Commands in the documents are those of the programs: names, options, goals of make."""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
from collections.abc import Callable
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
DOCUMENTS = [
    ROOT / "README.md",
    ROOT / "CONTRIBUTING.md",
    ROOT / "hil/README.md",
    *(ROOT / "docs").rglob("*.md"),
]
GOALS = re.compile(r"^([\w-]+):(?!=)", re.MULTILINE)
FCC_HIL = ("python -m fcc_hil ", ".venv/bin/python -m fcc_hil ", "fcc ")


def quoted(document: Path) -> list[str]:
    """Return what stands in code, a line each."""
    text = document.read_text()
    blocks = [line.strip() for line in text.splitlines() if line.startswith("    ")]
    return blocks + re.findall(r"`([^`\n]+)`", text)


LINES = sorted({line for document in DOCUMENTS for line in quoted(document)})


def arguments(line: str) -> list[str]:
    """Return the words of a command, without comments, and what is piped into others."""
    return shlex.split(re.split(r" (?:[|>&]|&&) |  +[#a-z]| # | \\$", line)[0], comments=True)


def checked(words: list[str], helps: Callable[..., str]) -> None:
    """Ask for the help of each subcommand in turn, and look for the options."""
    path: list[str] = []
    text = helps()
    for word in words:
        if word.startswith("-"):
            break
        listed = rf"^ {{2,4}}{re.escape(word)}\b|[{{,]{re.escape(word)}[,}}]"
        if not re.search(listed, text, re.MULTILINE):
            break
        path.append(word)
        text = helps(*path)
    assert path or words[0].startswith("-"), words
    for option in (word.partition("=")[0] for word in words if re.match(r"--\w", word)):
        assert re.search(rf"{option}\b", text), option


FCCD = [line for line in LINES if re.match(r"(?:target/release/)?fccd [a-z]", line)]
HIL = [line for line in LINES if line.startswith(FCC_HIL) and not line.startswith("fcc -")]
MAKE = [line for line in LINES if re.match(r"make [a-z]", line)]


@cache
def printed(*command: str | Path) -> str:
    """Run a command for its help."""
    return subprocess.run(command, capture_output=True, text=True, check=False).stdout


@pytest.mark.parametrize("line", FCCD)
def test_a_command_of_fccd_is_one(fccd: Path, line: str) -> None:
    words = [part.strip("[]") for part in arguments(line)[1:]]
    if words[0] not in ("publisher", "man"):
        checked(words, lambda *path: printed(fccd, *path, "--help"))


@pytest.mark.parametrize("line", HIL)
def test_a_command_of_fcc_hil_is_one(line: str) -> None:
    words = arguments(next(line.removeprefix(to) for to in FCC_HIL if line.startswith(to)))
    checked(words, lambda *path: printed(sys.executable, "-m", "fcc_hil", *path[:1], "--help"))


@pytest.mark.parametrize("line", MAKE)
def test_a_goal_of_make_is_one(line: str) -> None:
    goals = GOALS.findall((ROOT / "Makefile").read_text())
    assert arguments(line)[1].removesuffix("-...") in goals, line
