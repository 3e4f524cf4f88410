"""A flight as a picture: what was flown against time, what was ordered and what happened."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

import matplotlib as mpl
import numpy as np

mpl.use("Agg")

import matplotlib.pyplot as plt

from . import replacement
from .pattern import SetPoints, TimedPattern
from .score import Samples
from .truth import Truth

Panel = tuple[tuple[str, ...], str]
"""Columns of the truth, and the label of their axis."""
CONTROLS: Panel = ("elevator", "aileron", "rudder", "throttle"), "controls, -1..1"
PANELS: tuple[Panel, ...] = (
    (("heading_deg",), "heading, °"),
    (("altitude_ft",), "altitude, ft"),
    (("airspeed_kt",), "airspeed, kt"),
    (("roll_deg",), "bank, °"),
    CONTROLS,
)
_ORDERED = ("heading_deg", "altitude_ft", "airspeed_kt")
_COLOURS = ("#1f4e79", "#c0504d", "#6b9e3f", "#7f7f7f")
GRID = "#dddddd"
_NO_LIMITS: Mapping[str, tuple[float, str]] = MappingProxyType({})


@dataclass(frozen=True)
class Mark:
    """Something that happened."""

    begins_s: float
    colour: str
    ends_s: float | None = None
    """None for a moment."""
    label: str = ""


def draw(
    path: Path,
    truth: Truth,
    title: str,
    *,
    panels: Sequence[Panel] = PANELS,
    points: Sequence[tuple[float, SetPoints]] = (),
    limits: Mapping[str, tuple[float, str]] = _NO_LIMITS,
    marks: Sequence[Mark] = (),
) -> None:
    """Write a picture, as PNG, SVG or another format by the file's extension.

    `points` are the set points with their times, `limits` are by column, each with its name.
    """
    figure, rows = plt.subplots(
        len(panels), 1, figsize=(10, 1.0 + 2.0 * len(panels)), sharex=True, layout="constrained"
    )
    time_s = truth["time_s"]
    for axes, (columns, label) in zip(rows, panels, strict=True):
        for column, colour in zip(columns, _COLOURS, strict=False):
            flown = _continuous(column, truth[column])
            if points and column in _ORDERED:
                ordered = np.array([getattr(point, column) for _, point in points])
                ordered = _continuous(column, ordered)
                if column == "heading_deg":
                    begun = np.interp(points[0][0], time_s, flown)
                    ordered += 360.0 * np.round((begun - ordered[0]) / 360.0)
                times_s = [point_s for point_s, _ in points]
                axes.plot(times_s, ordered, color=_COLOURS[1], linewidth=1.2, label="set point")
            axes.plot(time_s, flown, color=colour, linewidth=1.2, label=_name(column))
            if column in limits:
                limit, name = limits[column]
                axes.axhline(limit, color=_COLOURS[1], linewidth=0.8, linestyle="--", label=name)
        axes.set_ylabel(label)
        axes.grid(visible=True, color=GRID, linewidth=0.6)
        axes.set_axisbelow(True)
        if len(axes.get_lines()) > 1:
            # Above the plot, where it covers nothing.
            axes.legend(
                frameon=False,
                fontsize=8,
                ncols=len(axes.get_lines()),
                loc="lower right",
                bbox_to_anchor=(1.0, 0.97),
                borderpad=0.0,
            )
        for mark in marks:
            if mark.ends_s is None:
                axes.axvline(mark.begins_s, color=mark.colour, linewidth=1.0, linestyle="--")
            else:
                axes.axvspan(mark.begins_s, mark.ends_s, color=mark.colour, alpha=0.25)
    named = [mark for mark in marks if mark.label]
    rows[-1].set_xlabel("; ".join(["simulated time, s", *(mark.label for mark in named)]))
    figure.suptitle(title, fontsize=10, wrap=True)
    replacement.draw(path, figure, dpi=110)
    plt.close(figure)


def plot_pattern(
    path: Path,
    truth: Truth,
    pattern: TimedPattern,
    engaged_at_s: float,
    legs: int,
    title: str,
) -> None:
    """Write a picture of a flight through the timed pattern."""
    captured, flown = truth.captured_at(engaged_at_s), truth.since(engaged_at_s)
    points = [
        (time_s, pattern.set_points(max(0.0, time_s - engaged_at_s), captured))
        for time_s in map(float, flown["time_s"])
    ]
    begins_s = [leg.start_s for leg in pattern.legs(legs, engaged_at_s, captured)]
    draw(
        path,
        flown,
        title,
        points=points,
        limits={"roll_deg": (30.0, "limit")},
        marks=[Mark(time_s, GRID) for time_s in begins_s],
    )


def _continuous(column: str, values: Samples) -> Samples:
    """Return a heading without jumps at north; of another column its values."""
    return np.unwrap(values, period=360.0) if column == "heading_deg" else values


def _name(column: str) -> str:
    """Return the name without its unit, which the axis has: `pitch_deg` is pitch."""
    return column.removesuffix("_deg").removesuffix("_kt").removesuffix("_ft").replace("_", " ")
