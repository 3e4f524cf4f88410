"""Pages of results: each figure has its command, its date and its commit."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

from fcc_hil import measured
from fcc_hil.suite.matrix import TUNING_SEEDS

ROOT = Path(__file__).parents[2]
DEFINITIONS = {"attacks", "campaigns"}
PAGES = [page for page in (ROOT / "docs/results").glob("*.md") if page.stem not in DEFINITIONS]
HEAD = re.compile(
    r"## .+\n\n    (make|fcc) .+\n\nMeasured on \d+ \w+ \d{4}, at commit [0-9a-f]{8}\b.*\n\n"
)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_a_section_says_what_measured_it_and_when(page: Path) -> None:
    sections = re.split(r"^(?=## )", page.read_text(), flags=re.MULTILINE)[1:]
    measurements = [text for text in sections if "\nMeasured on " in text]
    assert measurements
    for text in measurements:
        found = HEAD.match(text)
        assert found, text[:300]


def _append(*lines: str, code: int = 0) -> list[str]:
    text = "".join(f"{line}\n" for line in lines)
    program = f"import os, sys; open(os.environ['FCC_MEASURED'], 'a').write({text!r})"
    return [sys.executable, "-c", f"{program}; print('flown'); sys.exit({code})"]


def _measure(page: Path, title: str, *command: str) -> int:
    script = str(ROOT / "scripts/results")
    words = [sys.executable, script, str(page), title, "make it", *command]
    return subprocess.run(words, capture_output=True, check=False).returncode


def test_a_run_replaces_its_section_alone(tmp_path: Path) -> None:
    page = tmp_path / "new/page.md"
    assert _measure(page, "One", *_append("seed\t7", "a: sink\t3.5", "a: good\tTrue")) == 0
    page.write_text("# Title\n\nDefinitions.\n\n" + page.read_text())
    assert _measure(page, "Two", "echo", "as printed") == 0
    seeds = [f"seed\t{seed}" for seed in (9, 7, 8)]
    rows = ("a: sink\t10.5", "a: sink\t9.5", "a: sink\t3.5", "a: good\tTrue", "a: good\tFalse")
    # What was measured is written, and that it failed is said by the exit code.
    assert _measure(page, "One", *_append(*seeds, *rows, code=3)) == 3
    text = page.read_text()
    assert text.startswith("# Title\n\nDefinitions.\n\n## One\n\n    make it\n\nMeasured on ")
    assert "; seeds 7 to 9.\n" in text
    assert "| a: good | 1 of 2                  |\n" in text
    assert "| a: sink | 3.5 to 10.5, median 9.5 |\n" in text
    assert text.count("## One\n") == 1
    assert text.endswith(".\n\n    as printed\n")


def test_a_command_that_measures_nothing_replaces_nothing(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    measured.write(page, "One", "make it", "| 1 |")
    before = page.read_text()
    assert _measure(page, "One", "false") == 1
    assert page.read_text() == before


def test_reported_seeds_are_not_those_of_tuning() -> None:
    first = re.search(r"^REPORTED := (\d+)$", (ROOT / "Makefile").read_text(), re.MULTILINE)
    assert first
    # docs/campaign.md: for reports, and nothing is chosen on them.
    assert 200_000 <= int(first[1]) < 300_000 - 150
    assert max(TUNING_SEEDS) < 200_000
