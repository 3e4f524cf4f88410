"""Figures as JSON."""

from __future__ import annotations

import argparse
import json
import re
from pathlib import Path

import pytest

from fcc_hil import documents, ranges


def test_a_figure_that_never_was_is_null(tmp_path: Path) -> None:
    path = tmp_path / "figures.json"
    documents.write(path, {"legs": [{"rms": float("nan")}, {"rms": 1.5}], "settled": float("inf")})
    # RFC 8259 has neither NaN nor Infinity.
    assert json.loads(path.read_text(), parse_constant=pytest.fail) == {
        "legs": [{"rms": None}, {"rms": 1.5}],
        "settled": None,
    }


def test_standard_output_is_no_file_to_write() -> None:
    with pytest.raises(argparse.ArgumentTypeError, match="is a file here"):
        ranges.file_to_write("-")


def test_links_between_documents_lead_to_files() -> None:
    root = Path(__file__).parents[2]
    documents = [root / "README.md", root / "hil/README.md", *(root / "docs").rglob("*.md")]
    links = [
        (document, link)
        for document in documents
        for link in re.findall(r"\]\(([^)#\s:]+)(?:#[^)]*)?\)", document.read_text())
    ]
    assert len(links) > 100
    assert [link for document, link in links if not (document.parent / link).exists()] == []
