"""The suite as a picture: every case's worst leg, its limit and the peer's."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import matplotlib as mpl

mpl.use("Agg")

import matplotlib.pyplot as plt
from matplotlib.ticker import NullFormatter

from .. import replacement
from .flying import Outcome

_COLUMNS = (
    ("heading_settle_s", "within 2°, s", 1.0),
    ("heading_overshoot_deg", "overshoot, °", 0.01),
    ("altitude_settle_s", "within 10 ft, s", 1.0),
    ("altitude_rms_ft", "altitude RMS, ft", 0.05),
    ("turn_loss_ft", "height lost, ft", 0.05),
    ("airspeed_error_kt", "airspeed, kt", 0.1),
)
"""Figure, title, and the smallest difference shown."""
_FLOWN, _BAD, _LIMIT, _PEER, _GRID = "#1f4e79", "#c0504d", "#c0504d", "#7f7f7f", "#dddddd"
_ROW_INCH = 0.17


def draw(path: Path, outcomes: Sequence[Outcome]) -> None:
    """Write a picture of outcomes, as PNG, SVG or another format by the file's extension."""
    peer = next((outcome for outcome in outcomes if outcome.case.is_peer), None)
    shown = [outcome for outcome in outcomes if outcome.figures and not outcome.case.is_peer]
    if not shown:
        raise ValueError("no flight to draw: none was completed")
    height = 1.2 + _ROW_INCH * len(shown)
    figure, columns = plt.subplots(
        1, len(_COLUMNS), figsize=(13, height), sharey=True, layout="constrained"
    )
    for axes, (name, title, least) in zip(columns, _COLUMNS, strict=True):
        for place, outcome in enumerate(shown):
            value, most = outcome.figures[name], outcome.case.limits.get(name)
            if most is not None:
                axes.plot([most, most], [place - 0.4, place + 0.4], color=_LIMIT, linewidth=1.4)
            if value is not None:
                colour = _BAD if most is not None and value > most else _FLOWN
                axes.plot(max(value, least), place, "o", color=colour, markersize=4)
        theirs = peer.figures.get(name) if peer else None
        if theirs is not None:
            axes.axvline(max(theirs, least), color=_PEER, linestyle="--", linewidth=1.0)
        axes.set_xscale("log")
        axes.xaxis.set_major_formatter(lambda value, _position: f"{value:g}")
        axes.xaxis.set_minor_formatter(NullFormatter())
        axes.set_title(title, fontsize=9)
        axes.grid(visible=True, axis="x", color=_GRID, linewidth=0.6)
        axes.tick_params(labelsize=7)
        for side in ("top", "right", "left"):
            axes.spines[side].set_visible(False)
    columns[0].set_yticks(range(len(shown)), [outcome.case.name for outcome in shown], fontsize=7)
    columns[0].set_ylim(len(shown) - 0.5, -0.5)
    figure.suptitle(
        "Worst leg of each flight (dot), its limit (red line), JSBSim's own autopilot (dashed)",
        fontsize=10,
    )
    replacement.draw(path, figure, dpi=60)
    plt.close(figure)
