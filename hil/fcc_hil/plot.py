"""A flight through the timed pattern as a picture."""

from __future__ import annotations

from pathlib import Path

import matplotlib as mpl
import numpy as np

mpl.use("Agg")

import matplotlib.pyplot as plt
from matplotlib.axes import Axes

from . import replacement
from .pattern import SetPoints, TimedPattern
from .score import Samples
from .truth import Truth

_ASKED = "#c0504d"
_FLOWN = "#1f4e79"
_SURFACES = {"elevator": "#1f4e79", "aileron": "#c0504d", "rudder": "#6a9a3b"}
_GRID = "#dddddd"
_NAMES = ("altitude_ft", "airspeed_kt", "roll_deg", *_SURFACES, "throttle")


def _asked(pattern: TimedPattern, since_s: Samples, captured: SetPoints) -> dict[str, Samples]:
    points = [pattern.set_points(max(0.0, float(t)), captured) for t in since_s]
    # Continuous past north, so that the line has no jumps.
    legs = np.array([pattern.legs_begun(max(0.0, float(t))) for t in since_s])
    return {
        "heading": captured.heading_deg + legs * pattern.turn_deg,
        "altitude": np.array([point.altitude_ft for point in points]),
        "airspeed": np.array([point.airspeed_kt for point in points]),
    }


def _style(axes: Axes, label: str) -> None:
    axes.set_ylabel(label)
    axes.grid(visible=True, color=_GRID, linewidth=0.6)
    axes.set_axisbelow(True)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)


def plot_flight(
    path: Path,
    truth: Truth,
    pattern: TimedPattern,
    engaged_at_s: float,
    legs: int,
    title: str,
) -> None:
    """Write a picture of a flight, as PNG or another format by the file's extension."""
    ends_s = engaged_at_s + pattern.duration_s(legs)
    shown = (truth["time_s"] >= engaged_at_s) & (truth["time_s"] < ends_s - 1e-6)
    column = {name: truth[name][shown] for name in ("time_s", "heading_deg", *_NAMES)}
    since_s = column["time_s"] - engaged_at_s
    captured = truth.captured_at(engaged_at_s)
    asked = _asked(pattern, since_s, captured)
    heading = np.rad2deg(np.unwrap(np.deg2rad(column["heading_deg"])))
    heading += 360.0 * np.round((asked["heading"][0] - heading[0]) / 360.0)

    figure, rows = plt.subplots(5, 1, figsize=(10, 11), sharex=True, layout="constrained")
    for axes, name, flown, label in (
        (rows[0], "heading", heading, "heading, deg"),
        (rows[1], "altitude", column["altitude_ft"], "altitude, ft"),
        (rows[2], "airspeed", column["airspeed_kt"], "airspeed, kt"),
    ):
        axes.plot(since_s, asked[name], color=_ASKED, linewidth=1.2, label="set point")
        axes.plot(since_s, flown, color=_FLOWN, linewidth=1.6, label="flown")
        _style(axes, label)
    rows[0].legend(loc="upper left", frameon=False)
    rows[0].set_yticks(np.arange(captured.heading_deg, np.max(asked["heading"]) + 1.0, 90.0))
    rows[0].yaxis.set_major_formatter(lambda value, _position: f"{value % 360.0:.0f}")
    middle_kt = captured.airspeed_kt
    half_kt = max(5.0, 1.2 * float(np.max(np.abs(column["airspeed_kt"] - middle_kt))))
    rows[2].set_ylim(middle_kt - half_kt, middle_kt + half_kt)

    rows[3].plot(since_s, column["roll_deg"], color=_FLOWN, linewidth=1.6)
    rows[3].axhline(30.0, color=_ASKED, linewidth=0.8, linestyle="--")
    rows[3].annotate(
        "limit 30°", (since_s[0], 30.0), xytext=(2, -10), textcoords="offset points", color=_ASKED
    )
    _style(rows[3], "bank, deg")

    for name, colour in _SURFACES.items():
        rows[4].plot(since_s, column[name], color=colour, linewidth=1.0, label=name)
    rows[4].plot(since_s, column["throttle"], color="#7f7f7f", linewidth=1.4, label="throttle")
    rows[4].legend(loc="upper right", ncols=4, frameon=False)
    lowest = min(float(np.min(column[name])) for name in _SURFACES)
    rows[4].set_ylim(min(-0.35, 1.15 * lowest), 1.3)
    _style(rows[4], "controls, -1..1")
    rows[4].set_xlabel("time since engagement, s")
    rows[4].set_xlim(float(since_s[0]), float(since_s[-1]))
    for axes in rows:
        for leg in range(legs):
            axes.axvline(pattern.hold_s + leg * pattern.leg_s, color=_GRID, linewidth=1.0, zorder=0)
    figure.suptitle(title, fontsize=13)
    replacement.draw(path, figure, dpi=130)
    plt.close(figure)
