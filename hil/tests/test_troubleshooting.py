"""The messages that the page on troubleshooting quotes are messages that the programs print."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
DOCUMENT = ROOT / "docs" / "troubleshooting.md"
SOURCES = (("crates", "*/src/**/*.rs"), ("hil", "fcc_hil/**/*.py"))
# What differs from one message to the next (numbers, names, words in capitals), and where messages
# are joined.
VARIABLE = re.compile(
    r"\.\.\.|'[^']*'|\"[^\"]*\"|\S*\d\S*|\b[A-Z]{4,}\b(?! [A-Z])"
    r"|: | \(|X-Plane|\bdenied|(?<=does not send) |\bis (?=damaged)"
)


def source() -> str:
    """Return all sources, with each text in one piece and without its variable parts."""
    files = (file for folder, files in SOURCES for file in (ROOT / folder).glob(files))
    text = "\n".join(file.read_text() for file in files)
    text = re.sub(r"\\\n\s*|\"\n\s*f?\"", "", text)
    return text.replace('\\"', '"')


SOURCE = source()


def quoted() -> list[str]:
    """Return the quoted messages of all tables about fccd's and fcc-hil's own messages."""
    own = DOCUMENT.read_text().split("## Building")[0]
    cells = [line.split("|")[1] for line in own.splitlines() if line.startswith("|")]
    found = [message for cell in cells for message in re.findall(r"`([^`]+)`", cell)]
    return [message for message in found if not message.startswith("ModuleNotFoundError")]


@pytest.mark.parametrize("message", quoted())
def test_a_quoted_message_is_one_that_is_printed(message: str) -> None:
    for part in VARIABLE.split(message):
        words = part.strip(" .,:;()")
        if " " in words:
            assert words in SOURCE, words
