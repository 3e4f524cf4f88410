"""A campaign as a picture, each flight by speed, load, delay and turbulence; and one flight."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import matplotlib as mpl
import numpy as np

mpl.use("Agg")

import matplotlib.pyplot as plt

from .. import plot, replacement
from ..truth import Truth
from .flying import Outcome
from .report import conditions
from .verdict import LIMITS

_COLOURS = ("#c0504d", "#d98a29", "#8a5fb0", "#3b8686", "#7a5c3e", "#c06c9c")
_CLEAN = "#b8c7d9"

_PANELS = (
    (
        "airspeed_over_stall",
        "least airspeed, multiple of Vs",
        "largest_angle_of_attack_deg",
        "largest angle of attack, °",
    ),
    ("least_load_g", "least load, g", "largest_load_g", "largest load, g"),
    ("delay_ms", "delay, ms", "pitch_rate_sd_degps", "pitch rate when steady, °/s (1 sd)"),
    ("turbulence", "turbulence, severity of MIL-F-8785C", "largest_bank_deg", "largest bank, °"),
)
_FLIGHT_PANELS: tuple[plot.Panel, ...] = (
    (("airspeed_kt",), "airspeed, kt"),
    (("altitude_ft",), "altitude, ft"),
    (("angle_of_attack_deg", "pitch_deg"), "angle, °"),
    (("roll_deg",), "bank, °"),
    (("load_g",), "load, g"),
    (("pitch_rate_degps",), "pitch rate, °/s"),
    plot.CONTROLS,
)
_MOST_SHOWN = {"pitch_rate_sd_degps": 20.0, "largest_angle_of_attack_deg": 30.0}


def draw(path: Path, outcomes: Sequence[Outcome], title: str) -> None:
    """Write it, as PNG, SVG or another format by the file's extension."""
    flown = [outcome for outcome in outcomes if outcome.verdict.figures]
    if not flown:
        raise ValueError("no flight to draw: none was flown")
    figure, rows = plt.subplots(2, 2, figsize=(11, 9), layout="constrained")
    kinds = sorted({kind for it in flown if (kind := _worst(it)) is not None})
    for axes, (across, across_title, up, up_title) in zip(rows.flat, _PANELS, strict=True):
        for kind in (None, *reversed(kinds)):
            shown = [it for it in flown if _worst(it) == kind]
            if not shown:
                continue
            axes.plot(
                [_value(outcome, across) for outcome in shown],
                np.minimum([_value(outcome, up) for outcome in shown], _MOST_SHOWN.get(up, np.inf)),
                "o",
                markersize=4 if kind is None else 6,
                color=_CLEAN if kind is None else _COLOURS[kinds.index(kind) % len(_COLOURS)],
                label=kind or "clean",
            )
        axes.set_xlabel(across_title)
        axes.set_ylabel(up_title)
        axes.grid(visible=True, color=plot.GRID, linewidth=0.6)
        axes.set_axisbelow(True)
        for side in ("top", "right"):
            axes.spines[side].set_visible(False)
    severities = sorted({it.flight.weather.turbulence_severity for it in flown})
    rows[1][1].set_xticks(range(severities[0], severities[-1] + 1))
    limits = LIMITS[flown[0].flight.bounds.kind]
    bank_deg = [limits.bank_deg[severity] for severity in severities]
    rows[1][1].step(severities, bank_deg, where="mid", color="black", linewidth=0.6)
    # In calm air.
    least_g, most_g = limits.loads_g[0]
    rows[0][1].axvline(least_g, color="black", linewidth=0.6)
    rows[0][1].axhline(most_g, color="black", linewidth=0.6)
    rows[0][0].legend(frameon=False, fontsize=8)
    figure.suptitle(title, fontsize=12)
    replacement.draw(path, figure, dpi=90)
    plt.close(figure)


def _worst(outcome: Outcome) -> str | None:
    return next(iter(outcome.verdict.broken), None)


def _value(outcome: Outcome, name: str) -> float:
    flight = outcome.flight
    if name == "delay_ms":
        return flight.delay_ms
    if name == "turbulence":
        # Side by side, not on top of each other.
        return flight.weather.turbulence_severity + 0.6 * (flight.number % 11) / 11.0 - 0.3
    return outcome.verdict.figures[name]


def draw_flight(path: Path, truth: Truth, outcome: Outcome) -> None:
    """Write one flight as a picture: what was flown against time."""
    flight, broken = outcome.flight, "; ".join(outcome.verdict.broken) or "clean"
    plot.draw(
        path,
        truth,
        f"{conditions(flight)}: {broken}",
        panels=_FLIGHT_PANELS,
        limits={
            "airspeed_kt": (flight.stall_kt, "stalling speed"),
            "angle_of_attack_deg": (flight.limits.stall_deg, "stalling angle"),
        },
    )
