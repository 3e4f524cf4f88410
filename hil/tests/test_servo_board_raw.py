"""The timed pattern by a phone's raw sensors, with a board's pitot tube, switch and surfaces."""

from __future__ import annotations

import pytest

from fcc_hil.raw_flight import BoardLine, fly


def test_a_board_on_a_line_with_wrong_bits_flies_as_without_one() -> None:
    """One bit of 10,000 is wrong, in both directions."""
    line = BoardLine(1e-4)
    through = fly("phone", navigation="kalman", legs=1, board=line)
    # A frame of surfaces has 85 bytes: 6.6 % of them are hit, and of the shorter ones fewer.
    frames = line.board.received + line.board.corrupt
    assert 0.04 < line.board.corrupt / frames < 0.08
    assert line.computer.corrupt > 0
    without = fly("phone", navigation="kalman", legs=1)
    assert through.errors() == pytest.approx(without.errors(), abs=0.1)
    for name, figure in without.score["worst"].items():
        assert through.score["worst"][name] == pytest.approx(figure, abs=0.3), name  # type: ignore[literal-required]
