"""Every row of the table of faults is complete and names an existing test."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
DOCUMENT = ROOT / "docs" / "faults.md"
# Tests that need a whole machine run in `make test-vm`.
FOLDERS = (ROOT / "hil" / "tests", ROOT / "deploy" / "vm")
SHOWN_BY = re.compile(r"`(test_\w+\.py)::(test_\w+)`")
COLUMNS = 5


def rows() -> list[list[str]]:
    """Return the cells of each row of each table, without their headings."""
    lines = [line for line in DOCUMENT.read_text().splitlines() if line.startswith("|")]
    cells = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]
    return [row for row in cells if row[0] != "fault" and not row[0].startswith("---")]


ROWS = rows()


@pytest.mark.parametrize("row", ROWS, ids=[row[0] for row in ROWS])
def test_a_row_is_complete_and_names_an_existing_test(row: list[str]) -> None:
    assert len(row) == COLUMNS
    assert all(row)
    shown = SHOWN_BY.findall(row[-1])
    assert shown
    for file, name in shown:
        (path,) = (folder / file for folder in FOLDERS if (folder / file).exists())
        module = ast.parse(path.read_text())
        assert name in {node.name for node in module.body if isinstance(node, ast.FunctionDef)}


def test_those_in_lockstep_are_as_the_document_says() -> None:
    (rule,) = re.findall(r"those with `([\w.]+)` in \[lockstep\]", DOCUMENT.read_text())
    files = {file for row in ROWS for file, _ in SHOWN_BY.findall(row[-1])}
    paths = [folder / file for folder in FOLDERS for file in files if (folder / file).exists()]
    without_daemon = {path.name for path in paths if "fccd" not in path.read_text()}
    assert {path.name for path in paths if rule in path.read_text()} == without_daemon
