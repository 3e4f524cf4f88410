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


ROOT = Path(__file__).parents[2]
DOCUMENTS = [
    *ROOT.glob("*.md"),
    *(ROOT / "docs").rglob("*.md"),
    *(ROOT / "proto").glob("*.md"),
    *ROOT.glob("crates/*/*.md"),
    ROOT / "crates/README.md",
    ROOT / "android/README.md",
    ROOT / "hil/README.md",
    ROOT / "web/README.md",
]


def anchor(heading: str) -> str:
    """Return the anchor of a heading, as GitHub makes it."""
    text = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", heading).replace("`", "").strip().lower()
    return re.sub(r"[^\w\- ]", "", text).replace(" ", "-")


def test_links_between_documents_lead_to_files_and_headings() -> None:
    links = [
        (document, link, heading)
        for document in DOCUMENTS
        for link, heading in re.findall(
            r"\]\(([^)#\s:]*)(?:#([^)\s]*))?\)",
            re.sub(r"^( *)```.*?^\1```$", "", document.read_text(), flags=re.MULTILINE | re.DOTALL),
        )
    ]
    assert len(links) > 100
    missing = []
    for document, link, heading in links:
        to = (document.parent / link).resolve() if link else document
        if not to.exists():
            missing.append((document.name, link))
        elif heading and to.suffix == ".md":
            headings = re.findall(r"^#+ (.+)$", to.read_text(), re.MULTILINE)
            if heading not in map(anchor, headings):
                missing.append((document.name, f"{link}#{heading}"))
    assert missing == []
