"""Margins as a table and as a picture."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import matplotlib as mpl

mpl.use("Agg")

import matplotlib.pyplot as plt

from .. import replacement
from ..table import markdown
from .measure import AXES, WANTED_DB, WANTED_DEG, Margins

_SHOWN_DB, _SHOWN_DEG = 30.0, 120.0
"""Larger margins are drawn here."""
_WANTED, _GRID = "#c0504d", "#dddddd"


def _name(margins: Margins) -> str:
    condition = margins.condition
    weight = f", {condition.weight}" if condition.weight else ""
    servo = f", {condition.servo_hz:g} Hz servo" if condition.servo_hz else ""
    return f"{condition.aircraft}{weight}, {1e3 * condition.delay_s:g} ms{servo}"


def _cell(margins: Margins) -> str:
    gain, phase = margins.gain_db, margins.phase_deg
    cell = f"{gain:.1f} dB " if math.isfinite(gain) else "- dB "
    cell += f"{phase:.0f}°" if math.isfinite(phase) else "-"
    return cell if margins.holds else f"**{cell}**"


def text(measured: Sequence[Margins]) -> str:
    """Return a Markdown table; margins below 6 dB or 45 degrees are bold, "-" is no crossing."""
    rows: dict[tuple[str, float], dict[str, str]] = {}
    for margins in measured:
        condition = margins.condition
        row = rows.setdefault((_name(margins), condition.airspeed_kt), {})
        row[condition.axis] = _cell(margins)
    axes = [axis for axis in AXES if any(axis in row for row in rows.values())]
    return markdown(
        ["", "kt", *axes],
        [
            [name, f"{airspeed_kt:g}", *(row.get(axis, "") for axis in axes)]
            for (name, airspeed_kt), row in rows.items()
        ],
    )


def draw(path: Path, measured: Sequence[Margins]) -> None:
    """Write a picture over airspeed, as PNG, SVG or another format by the file's extension."""
    axes = [axis for axis in AXES if any(margins.condition.axis == axis for margins in measured)]
    figure, plots = plt.subplots(
        2, len(axes), figsize=(3.2 * len(axes), 5.5), sharex=True, squeeze=False,
        layout="constrained",
    )  # fmt: skip
    for column, axis in enumerate(axes):
        lines: dict[str, list[Margins]] = {}
        for margins in measured:
            if margins.condition.axis == axis:
                lines.setdefault(_name(margins), []).append(margins)
        gain, phase = plots[0][column], plots[1][column]
        for name, line in lines.items():
            airspeeds = [margins.condition.airspeed_kt for margins in line]
            gains = [min(margins.gain_db, _SHOWN_DB) for margins in line]
            phases = [min(margins.phase_deg, _SHOWN_DEG) for margins in line]
            gain.plot(airspeeds, gains, "o-", markersize=3, label=name)
            phase.plot(airspeeds, phases, "o-", markersize=3)
        gain.set_title(axis, fontsize=9)
        for plot, wanted, most in ((gain, WANTED_DB, _SHOWN_DB), (phase, WANTED_DEG, _SHOWN_DEG)):
            plot.axhline(wanted, color=_WANTED, linewidth=1.0)
            plot.set_ylim(0.0, 1.05 * most)
            plot.grid(visible=True, color=_GRID, linewidth=0.6)
            plot.tick_params(labelsize=7)
        phase.set_xlabel("kt", fontsize=8)
    plots[0][0].set_ylabel("gain margin, dB", fontsize=8)
    plots[1][0].set_ylabel("phase margin, °", fontsize=8)
    plots[0][0].legend(fontsize=6)
    replacement.draw(path, figure, dpi=120)
    plt.close(figure)
