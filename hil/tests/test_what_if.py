"""What happens if: each phase has each hazard, and its numbers stand in the pages that it links."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
PAGE = (DOCS / "what-if.md").read_text()
LINK = re.compile(r"\]\(([\w.-]+\.md)(?:#([\w-]+))?\)")
NUMBER = re.compile(r"(?<![\w.])(\d[\d,]*(?:\.\d+)?)(?: (?:of|to) (\d[\d.]*))?")
PHASES = ("Take-off", "Cruise", "Approach", "Flare", "On the wheels")
HAZARDS = {
    "GNSS": PHASES,
    "engine out": ("Take-off", "Cruise", "Approach", "Flare"),
    "battery low": ("Take-off", "Cruise", "Approach"),
    "command link lost": ("Take-off", "Cruise", "Approach"),
    "airspeed": ("Take-off", "Cruise", "Approach"),
    "lost": PHASES,
}


def slug(heading: str) -> str:
    """Return the anchor of a heading, as GitHub makes it."""
    text = re.sub(r"[`*]|\]\([^)]*\)|\[", "", heading).strip().lower()
    return re.sub(r"[^\w\- ]", "", text).replace(" ", "-")


def section(page: str, anchor: str | None) -> str:
    """Return what stands below a heading, with its subsections, or the whole page."""
    text = (DOCS / page).read_text()
    if anchor is None:
        return text
    parts = re.split(r"^(#+) (.+)$", text, flags=re.MULTILINE)
    headings = list(zip(parts[1::3], parts[2::3], parts[3::3], strict=True))
    (first,) = (n for n, (_, title, _) in enumerate(headings) if slug(title) == anchor)
    level = len(headings[first][0])
    found = headings[first][2]
    for marks, title, body in headings[first + 1 :]:
        if len(marks) <= level:
            break
        found += title + body
    return found


def tables() -> dict[str, list[list[str]]]:
    """Return the rows of each phase."""
    found = {}
    for part in PAGE.split("\n## ")[1:]:
        title, _, body = part.partition("\n")
        rows = [line.strip("|").split("|") for line in body.splitlines() if line.startswith("|")]
        found[title] = [[cell.strip() for cell in row] for row in rows[2:]]
    return found


TABLES = tables()
ROWS = [(phase, row) for phase, rows in TABLES.items() for row in rows]


@pytest.mark.parametrize(
    "row", [row for _, row in ROWS], ids=[f"{phase}: {row[0]}" for phase, row in ROWS]
)
def test_the_numbers_of_a_row_stand_where_it_links(row: list[str]) -> None:
    assert len(row) == 5
    assert all(row)
    whole = " | ".join(row)
    sources = "\n".join(section(page, anchor or None) for page, anchor in LINK.findall(whole))
    told = re.sub(r"`[^`]*`|\]\([^)]*\)", "", " ".join(row[2:]))
    for match in NUMBER.finditer(told):
        for number in filter(None, match.groups()):
            assert re.search(rf"(?<![\d.]){re.escape(number)}(?![\d])", sources), number


@pytest.mark.parametrize("hazard", HAZARDS)
def test_each_phase_has_the_hazard(hazard: str) -> None:
    for phase in HAZARDS[hazard]:
        assert any(hazard in row[0] for row in TABLES[phase]), phase


def test_the_phases_are_those_of_a_flight() -> None:
    assert tuple(TABLES) == ("In every phase", *PHASES)


def test_this_page_and_other_tables_are_those_of_the_code() -> None:
    subprocess.run([sys.executable, ROOT / "scripts/tables", "--check"], check=True)
