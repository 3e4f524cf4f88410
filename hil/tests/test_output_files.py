"""What is written does not replace recordings, plans, or a file in a line's place."""

from __future__ import annotations

import argparse
import os
import random
from pathlib import Path

import pytest

from fcc_hil import documents, ranges, replacement
from fcc_hil.board_link import _Serial
from fcc_hil.rig import FlightError


@pytest.mark.parametrize("begin", [b"\x89MCAP0\r\n", b"QGC WPL 110\n"])
def test_no_figures_replace_a_recording_or_a_plan(tmp_path: Path, begin: bytes) -> None:
    kept, replaced = tmp_path / "kept", tmp_path / "replaced"
    kept.write_bytes(begin + b"more")
    replaced.write_text("{}")
    with pytest.raises(argparse.ArgumentTypeError, match="is not replaced: give another file"):
        ranges.file_to_write(str(kept))
    assert ranges.file_to_write(str(replaced)) == replaced


def test_a_boards_line_replaces_only_a_line(tmp_path: Path) -> None:
    taken, line = tmp_path / "notes.txt", tmp_path / "board"
    beside = tmp_path / "notes.new"
    taken.write_text("mine")
    beside.write_text("mine, too")
    with pytest.raises(FlightError, match="choose a name that is not taken"):
        _Serial(taken, random.Random(1))
    assert taken.read_text() == "mine"
    assert beside.read_text() == "mine, too"
    # A board that was killed leaves its link.
    first = _Serial(line, random.Random(1))
    second = _Serial(line, random.Random(1))
    assert line.is_symlink()
    second.close()
    first.close()
    assert not line.exists()


def test_what_is_written_goes_through_no_link_and_into_no_pipe(tmp_path: Path) -> None:
    """In a shared folder they are another user's, and lead to what only this one may write."""
    mine, link, pipe = tmp_path / "mine", tmp_path / "link", tmp_path / "pipe"
    mine.write_text("precious")
    link.symlink_to(mine)
    os.mkfifo(pipe)
    for path in (link, pipe, tmp_path):
        with pytest.raises(OSError, match="is a"):
            documents.write(path, {})
        with pytest.raises(argparse.ArgumentTypeError, match="is a"):
            ranges.file_to_write(str(path))
    assert mine.read_text() == "precious"
    assert sorted(tmp_path.iterdir()) == [link, mine, pipe]


def test_a_file_is_replaced_whole_or_kept(tmp_path: Path) -> None:
    path = tmp_path / "figures.json"
    path.write_text("old")

    def fail_half_way() -> None:
        with replacement.replacing(path) as file:
            file.write(b"half of it")
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        fail_half_way()
    assert path.read_text() == "old"
    replacement.write(path, "new")
    assert path.read_text() == "new"
    assert list(tmp_path.iterdir()) == [path]
