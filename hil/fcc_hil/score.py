"""How closely a flight followed its legs: a pure function of the flight and the set points.

Every figure is of one leg, over the samples with start_s <= time < end_s:

heading_settle_s
    Time from the leg's start to the first sample from which on the heading stays
    within 2 degrees of its set point to the leg's end; None if the last sample is outside.
heading_overshoot_deg
    The farthest the heading goes past its set point in the direction of the turn,
    at least 0. On a leg with no turn: the largest error either way. A turn that
    goes the wrong way round, or is more than 180 degrees behind, scores near 180.
heading_rms_deg
    Root mean square of the heading error in the last 3 s.
altitude_settle_s, altitude_overshoot_ft, altitude_rms_ft
    The same for the altitude: within 10 ft, in the direction of the climb or descent,
    in the last 8 s.
turn_loss_ft
    Height lost: how far the altitude falls below the lower of the two altitudes that the
    leg joins, at least 0. On a level leg that is the height lost in the turn; on a
    climbing leg the sag before the climb; on a descending leg what is lost beyond the
    set point.
airspeed_error_kt
    Largest airspeed error either way.
lateral_acceleration_g
    Largest lateral specific force either way: how badly the turn is coordinated.

Angles are compared the shorter way. Times are compared with a tolerance of 1 microsecond, so that a
sample on a leg's border counts once, for the leg that begins there. Samples need not be evenly
spaced, but the root mean squares weigh each the same.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypedDict

import numpy as np
import numpy.typing as npt

from .pattern import Leg
from .units import wrap_degrees

Samples = npt.NDArray[np.float64]

HEADING_BAND_DEG = 2.0
ALTITUDE_BAND_FT = 10.0
HEADING_RMS_WINDOW_S = 3.0
ALTITUDE_RMS_WINDOW_S = 8.0
_TIME_TOLERANCE_S = 1e-6


class LegScore(TypedDict):
    """The score of one leg, or the worst of each value over all legs."""

    heading_settle_s: float | None
    heading_overshoot_deg: float
    heading_rms_deg: float
    altitude_settle_s: float | None
    altitude_overshoot_ft: float
    altitude_rms_ft: float
    turn_loss_ft: float
    airspeed_error_kt: float
    lateral_acceleration_g: float


class Score(TypedDict):
    """A flight's score."""

    legs: list[LegScore]
    worst: LegScore


@dataclass(frozen=True)
class Trace:
    """The flight: columns of equal length, time ascending."""

    time_s: Samples
    heading_deg: Samples
    altitude_ft: Samples
    airspeed_kt: Samples
    lateral_g: Samples

    def between(self, start_s: float, end_s: float) -> Trace:
        """Return the samples with start_s <= time < end_s."""
        first, last = np.searchsorted(
            self.time_s, [start_s - _TIME_TOLERANCE_S, end_s - _TIME_TOLERANCE_S]
        )
        return Trace(
            self.time_s[first:last],
            self.heading_deg[first:last],
            self.altitude_ft[first:last],
            self.airspeed_kt[first:last],
            self.lateral_g[first:last],
        )


def score(trace: Trace, legs: Sequence[Leg]) -> Score:
    """Score a flight. Raise ValueError if a leg has no samples, or there are no legs."""
    if not legs:
        raise ValueError("no legs to score; fly at least one")
    scores = [_score_leg(trace.between(leg.start_s, leg.end_s), leg) for leg in legs]
    return {"legs": scores, "worst": worst(scores)}


def _score_leg(flown: Trace, leg: Leg) -> LegScore:
    if len(flown.time_s) == 0:
        raise ValueError(
            f"the leg from {leg.start_s:.1f} s to {leg.end_s:.1f} s has no samples: "
            "the flight ended before it"
        )
    since_s = flown.time_s - leg.start_s
    to_go_s = leg.end_s - flown.time_s
    heading_error = (flown.heading_deg - leg.heading_deg + 180.0) % 360.0 - 180.0
    altitude_error = flown.altitude_ft - leg.altitude_ft
    floor_ft = min(leg.altitude_from_ft, leg.altitude_ft)
    return {
        "heading_settle_s": _settle(since_s, heading_error, HEADING_BAND_DEG),
        "heading_overshoot_deg": _overshoot(
            heading_error, wrap_degrees(leg.heading_deg - leg.heading_from_deg)
        ),
        "heading_rms_deg": _rms_at_end(heading_error, to_go_s, HEADING_RMS_WINDOW_S),
        "altitude_settle_s": _settle(since_s, altitude_error, ALTITUDE_BAND_FT),
        "altitude_overshoot_ft": _overshoot(altitude_error, leg.altitude_ft - leg.altitude_from_ft),
        "altitude_rms_ft": _rms_at_end(altitude_error, to_go_s, ALTITUDE_RMS_WINDOW_S),
        "turn_loss_ft": max(0.0, floor_ft - float(np.min(flown.altitude_ft))),
        "airspeed_error_kt": float(np.max(np.abs(flown.airspeed_kt - leg.airspeed_kt))),
        "lateral_acceleration_g": float(np.max(np.abs(flown.lateral_g))),
    }


def _settle(since_s: Samples, error: Samples, band: float) -> float | None:
    outside = np.flatnonzero(np.abs(error) > band)
    if len(outside) == 0:
        return max(0.0, float(since_s[0]))
    settled = int(outside[-1]) + 1
    return float(since_s[settled]) if settled < len(since_s) else None


def _overshoot(error: Samples, change: float) -> float:
    if change == 0.0:
        return float(np.max(np.abs(error)))
    return max(0.0, float(np.max(error if change > 0.0 else -error)))


def _rms_at_end(error: Samples, to_go_s: Samples, window_s: float) -> float:
    last = error[to_go_s <= window_s + _TIME_TOLERANCE_S]
    if len(last) == 0:
        raise ValueError(
            f"no samples in the last {window_s:.0f} s of a leg: the flight ended early"
        )
    return float(np.sqrt(np.mean(np.square(last))))


def _worst_settle(values: Sequence[float | None]) -> float | None:
    settled = [value for value in values if value is not None]
    return max(settled) if len(settled) == len(values) else None


def worst(legs: Sequence[LegScore]) -> LegScore:
    """Return the worst of each value over legs, at least one."""
    return {
        "heading_settle_s": _worst_settle([leg["heading_settle_s"] for leg in legs]),
        "heading_overshoot_deg": max(leg["heading_overshoot_deg"] for leg in legs),
        "heading_rms_deg": max(leg["heading_rms_deg"] for leg in legs),
        "altitude_settle_s": _worst_settle([leg["altitude_settle_s"] for leg in legs]),
        "altitude_overshoot_ft": max(leg["altitude_overshoot_ft"] for leg in legs),
        "altitude_rms_ft": max(leg["altitude_rms_ft"] for leg in legs),
        "turn_loss_ft": max(leg["turn_loss_ft"] for leg in legs),
        "airspeed_error_kt": max(leg["airspeed_error_kt"] for leg in legs),
        "lateral_acceleration_g": max(leg["lateral_acceleration_g"] for leg in legs),
    }
