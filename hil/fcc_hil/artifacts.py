"""Saves the artifacts of a failed test: a plot, the truth as CSV, the autopilot's recording."""

from __future__ import annotations

import re
from pathlib import Path

import matplotlib as mpl
import numpy as np

mpl.use("Agg")

import matplotlib.pyplot as plt
from matplotlib.axes import Axes

from . import replacement
from .flight import Flight
from .rig import FlightError
from .truth import COLUMNS, Truth

_FLOWN = "#1f4e79"
_ASKED = "#c0504d"
_BROKEN = "#f2c14e"
_GRID = "#dddddd"
_STATE_COLOURS = {"engaged": "#6a9a3b", "failsafe": "#c0504d"}
_PANELS = (
    ("heading_deg", "heading, deg"),
    ("altitude_ft", "altitude, ft"),
    ("airspeed_kt", "airspeed, kt"),
    ("roll_deg", "bank, deg"),
)
_CONTROLS = ("elevator", "aileron", "rudder", "throttle")


def folder_of(root: Path, test: str) -> Path:
    """Return the folder of a test's artifacts, by its node id."""
    name = re.sub(r"[^\w.\-\[\]=]+", "_", test).strip("_")
    # File names are limited to 255 bytes; the end distinguishes tests.
    return root / name[-200:]


def leave(flight: Flight, folder: Path) -> list[Path]:
    """Save a flight in a folder; return the files."""
    folder.mkdir(parents=True, exist_ok=True)
    truth = flight.truth()
    left = [folder / "flight.png", folder / "truth.csv"]
    plot(left[0], flight, truth)
    table = np.column_stack([truth[name] for name in COLUMNS])
    with replacement.replacing(left[1]) as file:
        np.savetxt(file, table, fmt="%.6g", delimiter=",", header=",".join(COLUMNS), comments="")
    return left + flight.rig.save_recording(folder / "recording.mcap")


def plot(path: Path, flight: Flight, truth: Truth) -> None:
    """Write a picture of a flight: flown and commanded values, faults and states."""
    time_s = truth["time_s"]
    figure, rows = plt.subplots(
        len(_PANELS) + 1, 1, figsize=(10, 11), sharex=True, layout="constrained"
    )
    for axes, (column, label) in zip(rows, _PANELS, strict=False):
        values = truth[column]
        if column == "heading_deg":
            values = np.rad2deg(np.unwrap(np.deg2rad(values)))
        _draw_asked(axes, flight, time_s, column, values)
        axes.plot(time_s, values, color=_FLOWN, linewidth=1.5, label="flown")
        axes.set_ylabel(label)
    for name in _CONTROLS:
        rows[-1].plot(time_s, truth[name], linewidth=1.0, label=name)
    rows[-1].set_ylabel("controls, -1..1")
    rows[-1].legend(loc="upper right", ncols=4, frameon=False)
    rows[-1].set_xlabel("simulated time, s")
    for axes in rows:
        _mark(axes, flight, float(time_s[-1]))
        axes.grid(visible=True, color=_GRID, linewidth=0.6)
        axes.set_axisbelow(True)
    rows[0].legend(loc="upper left", frameon=False)
    figure.suptitle(flight.rig.name, fontsize=13)
    replacement.draw(path, figure, dpi=110)
    plt.close(figure)


def _draw_asked(
    axes: Axes,
    flight: Flight,
    time_s: np.ndarray[tuple[int], np.dtype[np.float64]],
    column: str,
    flown: np.ndarray[tuple[int], np.dtype[np.float64]],
) -> None:
    if column == "roll_deg":
        return
    try:
        engaged_at_s, captured = flight.engaged_at_s, flight.captured
    except FlightError:
        return
    since_s = time_s[time_s >= engaged_at_s] - engaged_at_s
    pattern = flight.pattern
    points = [captured if pattern is None else pattern.set_points(t, captured) for t in since_s]
    asked = np.array([getattr(point, column) for point in points])
    if column == "heading_deg" and len(asked):
        asked = np.rad2deg(np.unwrap(np.deg2rad(asked)))
        begun = flown[time_s >= engaged_at_s][0]
        asked += 360.0 * np.round((begun - asked[0]) / 360.0)
    axes.plot(since_s + engaged_at_s, asked, color=_ASKED, linewidth=1.1, label="set point")


def _mark(axes: Axes, flight: Flight, ends_s: float) -> None:
    """Shade the faults, and draw a line at every change of state."""
    for fault in flight.faults.all:
        if fault.begins_s < ends_s:
            axes.axvspan(
                fault.begins_s,
                min(fault.ends_s, ends_s),
                color=_BROKEN,
                alpha=0.25,
                linewidth=0.0,
                label=fault.words,
            )
    for happening in flight.rig.events:
        _, arrow, state = happening.text.partition(" -> ")
        if arrow:
            colour = _STATE_COLOURS.get(state.partition(":")[0], "#7f7f7f")
            axes.axvline(happening.time_s, color=colour, linewidth=1.0, linestyle="--")
