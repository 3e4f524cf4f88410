"""How an aircraft moved: load, rates, angle of attack, speed, control activity.

Pure functions of the true state. Steady times are the ends of the legs, over which `score` takes
the altitude's root mean square: the turn is done, so what still moves is turbulence, noise or an
oscillation.
"""

from __future__ import annotations

from collections.abc import Sequence
from types import MappingProxyType

import numpy as np
import numpy.typing as npt

from .pattern import Leg
from .score import ALTITUDE_RMS_WINDOW_S
from .truth import TRUTH_HZ, Truth

SURFACES = ("elevator", "aileron", "rudder")

UNITS = MappingProxyType(
    {
        "largest_load_g": "g",
        "least_load_g": "g",
        "largest_roll_rate_degps": "deg/s",
        "largest_pitch_rate_degps": "deg/s",
        "largest_yaw_rate_degps": "deg/s",
        "pitch_rate_sd_degps": "deg/s",
        "movement_per_s": "of half the range a second",
        "largest_angle_of_attack_deg": "deg",
        "least_airspeed_kt": "kt",
        "height_lost_ft": "ft",
        "largest_bank_deg": "deg",
        "largest_pitch_deg": "deg",
    }
)
"""Every figure of `motion`, with its unit."""

LEAST = ("least_load_g", "least_airspeed_kt")
"""The figures of which the least is the worst."""


def motion(truth: Truth, legs: Sequence[Leg]) -> dict[str, float]:
    """Return the figures in UNITS of a flight and its legs, at least one.

    pitch_rate_sd_degps is the largest standard deviation over the steady time of any leg, and 0 if
    the flight ended before the first; height_lost_ft how far the altitude falls below both
    altitudes that a leg joins.
    """
    return {
        "largest_load_g": float(np.max(truth["load_g"])),
        "least_load_g": float(np.min(truth["load_g"])),
        **{
            f"largest_{axis}_rate_degps": _largest(truth[f"{axis}_rate_degps"])
            for axis in ("roll", "pitch", "yaw")
        },
        "pitch_rate_sd_degps": max(steady_pitch_rate_sd(truth, leg) for leg in legs),
        "movement_per_s": movement_per_s(truth),
        "largest_angle_of_attack_deg": float(np.max(truth["angle_of_attack_deg"])),
        "least_airspeed_kt": float(np.min(truth["airspeed_kt"])),
        "height_lost_ft": max(_height_lost_ft(truth, leg) for leg in legs),
        "largest_bank_deg": _largest(truth["roll_deg"]),
        "largest_pitch_deg": _largest(truth["pitch_deg"]),
    }


def movement_per_s(truth: Truth) -> float:
    """Return the mean travel of the surfaces per second, 1 from centred to full."""
    return float(np.mean([np.mean(np.abs(np.diff(truth[name]))) * TRUTH_HZ for name in SURFACES]))


def longest_s(holds: npt.NDArray[np.bool_]) -> float:
    """Return the longest time for which something holds in every row of a truth."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], holds, [False])).astype(np.int8)))
    lengths = edges[1::2] - edges[::2]
    return float(np.max(lengths, initial=0)) / TRUTH_HZ


def _largest(values: npt.NDArray[np.float64]) -> float:
    return float(np.max(np.abs(values)))


def steady_pitch_rate_sd(truth: Truth, leg: Leg) -> float:
    """Return the standard deviation of the pitch rate over a leg's steady time, deg/s."""
    time_s = truth["time_s"]
    steady = (time_s >= leg.end_s - ALTITUDE_RMS_WINDOW_S) & (time_s < leg.end_s)
    return float(np.std(truth["pitch_rate_degps"][steady])) if steady.any() else 0.0


def _height_lost_ft(truth: Truth, leg: Leg) -> float:
    during = (truth["time_s"] >= leg.start_s) & (truth["time_s"] < leg.end_s)
    lowest_ft = float(np.min(truth["altitude_ft"][during], initial=np.inf))
    return max(0.0, min(leg.altitude_from_ft, leg.altitude_ft) - lowest_ft)
