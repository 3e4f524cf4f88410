"""Saves the artifacts of a failed test: a plot, the truth as CSV, the autopilot's recording."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from . import replacement
from .flight import Flight
from .plot import Mark, draw
from .rig import FlightError
from .truth import COLUMNS, Truth

_FAULT = "#f2c14e"
_STATE_COLOURS = {"engaged": "#6a9a3b", "failsafe": "#c0504d"}


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
    _plot(left[0], flight, truth)
    table = np.column_stack([truth[name] for name in COLUMNS])
    with replacement.replacing(left[1]) as file:
        np.savetxt(file, table, fmt="%.6g", delimiter=",", header=",".join(COLUMNS), comments="")
    return left + flight.rig.save_recording(folder / "recording.mcap")


def _plot(path: Path, flight: Flight, truth: Truth) -> None:
    """Write a picture of a flight: flown and commanded values, faults and states."""
    time_s = truth["time_s"]
    marks = [
        Mark(fault.begins_s, _FAULT, min(fault.ends_s, float(time_s[-1])), fault.words)
        for fault in flight.faults.all
        if fault.begins_s < time_s[-1]
    ]
    for event in flight.rig.events:
        _, arrow, state = event.text.partition(" -> ")
        if arrow:
            colour = _STATE_COLOURS.get(state.partition(":")[0], "#7f7f7f")
            marks.append(Mark(event.time_s, colour))
    try:
        engaged_at_s, captured = flight.engaged_at_s, flight.captured
    except FlightError:
        points = []
    else:
        pattern = flight.pattern
        points = [
            (t, captured if pattern is None else pattern.set_points(t - engaged_at_s, captured))
            for t in map(float, time_s[time_s >= engaged_at_s])
        ]
    draw(path, truth, flight.rig.name, points=points, marks=marks)
