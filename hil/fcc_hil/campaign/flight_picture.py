"""One flight of a campaign as a picture: what was flown against time."""

from __future__ import annotations

from pathlib import Path

import matplotlib as mpl

mpl.use("Agg")

import matplotlib.pyplot as plt

from .. import replacement
from ..truth import Truth
from .flying import Outcome
from .report import conditions

_ROWS = (
    (("airspeed_kt",), "airspeed, kt"),
    (("altitude_ft",), "altitude, ft"),
    (("angle_of_attack_deg", "pitch_deg"), "angle, °"),
    (("roll_deg",), "bank, °"),
    (("load_g",), "load, g"),
    (("pitch_rate_degps",), "pitch rate, °/s"),
    (("elevator", "aileron", "rudder", "throttle"), "controls, -1..1"),
)
_COLOURS = ("#1f4e79", "#c0504d", "#6b9e3f", "#7f7f7f")
_LIMIT = {"color": _COLOURS[1], "linewidth": 0.8, "linestyle": "--"}


def draw(path: Path, truth: Truth, outcome: Outcome) -> None:
    """Write it, as PNG, SVG or another format by the file's extension."""
    figure, rows = plt.subplots(len(_ROWS), 1, figsize=(10, 13), sharex=True, layout="constrained")
    flight = outcome.flight
    for axes, (names, title) in zip(rows, _ROWS, strict=True):
        for name, colour in zip(names, _COLOURS, strict=False):
            axes.plot(truth["time_s"], truth[name], color=colour, linewidth=1.0, label=_label(name))
        axes.set_ylabel(title)
        axes.grid(visible=True, color="#dddddd", linewidth=0.6)
    rows[0].axhline(flight.stall_kt, label="stalling speed", **_LIMIT)
    rows[2].axhline(flight.limits.stall_deg, label="stalling angle", **_LIMIT)
    for axes in rows:
        lines = axes.get_lines()
        if len(lines) > 1:
            # Above the plot, where it covers nothing.
            axes.legend(
                frameon=False,
                fontsize=8,
                ncols=len(lines),
                loc="lower right",
                bbox_to_anchor=(1.0, 0.97),
                borderpad=0.0,
            )
    rows[-1].set_xlabel("time since the first tick, s")
    broken = "; ".join(outcome.verdict.broken) or "clean"
    figure.suptitle(f"{conditions(flight)}: {broken}", fontsize=9, wrap=True)
    replacement.draw(path, figure, dpi=90)
    plt.close(figure)


def _label(name: str) -> str:
    """Return the name without its unit, which the axis has: `pitch_deg` is pitch."""
    return name.removesuffix("_deg").removesuffix("_kt").replace("_", " ")
