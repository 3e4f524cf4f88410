"""An airspeed that fails: how soon it is excluded, what is flown meanwhile, and when it is back."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from ..truth import Truth
from ..units import KT_TO_MPS
from .alarms import EXCLUSION, Alarm
from .draw import TUBE, TUBE_S, WRONG, Fault, Flight
from .verdict import Flown

_WRONG_KT, _WRONG_TICKS = 10.0, 20
"""It is wrong once its mean error over half a second is as large."""
LEAST_OVER_STALL = 1.2
LONGEST_S = {4.0: 10.0, 28.0: 5.0, 58.0: 5.0}
"""Until a blocked tube is to be excluded, by the time at which it is blocked."""
BACK_WITHIN_S = 60.0


def figures(flight: Flight, fault: Fault, truth: Truth, flown: Flown) -> dict[str, float]:
    """Return the figures of a flight whose airspeed fails.

    Times are counted from an error of 10 kt, and from the end of the fault: NaN if it was not
    as wrong, or not excluded at that end; infinity if it was not excluded, or not used again.
    """
    time_s = (truth["time_s"] - truth["time_s"][0])[1:]
    off_kt = flown.shown["airspeed"] - truth["airspeed_kt"][1:]
    off_kt = off_kt - flight.biases["airspeed_mps"] / KT_TO_MPS
    mean_kt = np.abs(np.convolve(off_kt, np.full(_WRONG_TICKS, 1.0 / _WRONG_TICKS))[: len(off_kt)])
    wrong_s = time_s[(mean_kt > _WRONG_KT) & (time_s > fault.begins_s)]
    begins_s = float(wrong_s[0]) if len(wrong_s) else math.nan
    ends_s = fault.begins_s + (fault.lasts_s or math.inf)
    excluded = [it for it in flown.alarms if (it.kind, it.channel) == (EXCLUSION, "airspeed")]
    after = truth.since(float(truth["time_s"][0]) + fault.begins_s)["airspeed_kt"]
    return {
        "excluded_after_s": _first(excluded, fault.begins_s, ends_s) - begins_s,
        "taken_back_after_s": _back(excluded, ends_s),
        "least_over_stall": float(np.min(after)) / flight.stall_kt,
        "most_over_vne": float(np.max(after)) / flight.limits.never_exceed_kt,
    }


def _first(excluded: Sequence[Alarm], from_s: float, to_s: float) -> float:
    return next((it.begins_s for it in excluded if from_s <= it.begins_s < to_s), math.inf)


def _back(excluded: Sequence[Alarm], good_s: float) -> float:
    """Return how long it was excluded after it was good again: infinity if to the end."""
    during = [it for it in excluded if it.begins_s < good_s < it.begins_s + it.lasted_s]
    if not during:
        return math.nan
    return math.inf if during[0].ends_s is None else during[0].ends_s - good_s


def rows(flights: Sequence[tuple[Flight, Mapping[str, float]]]) -> list[list[str]]:
    """Return the rows of a table: what was measured, and in how many flights it is as wanted."""
    found = []
    for tube_s in TUBE_S:
        its = [
            figures
            for flight, figures in flights
            if flight.fault and flight.fault.what == TUBE and flight.fault.begins_s == tube_s
        ]
        wrong = [it for it in its if not math.isnan(it["excluded_after_s"])]
        within = sum(it["excluded_after_s"] <= LONGEST_S[tube_s] for it in its)
        flown = sum(
            it["least_over_stall"] >= LEAST_OVER_STALL and it["most_over_vne"] < 1.0 for it in its
        )
        name = f"tube blocked {tube_s:g} s after engaging"
        found += [
            [f"{name}: excluded after 10 kt of error", _range(wrong, "excluded_after_s")],
            [f"{name}: within {LONGEST_S[tube_s]:g} s", f"{within} of {len(wrong)}"],
            [f"{name}: within 1.2 Vs and Vne", f"{flown} of {len(its)}"],
        ]
    its = [figures for flight, figures in flights if flight.fault and flight.fault.what == WRONG]
    excluded = [it for it in its if not math.isnan(it["taken_back_after_s"])]
    back = sum(it["taken_back_after_s"] <= BACK_WITHIN_S for it in excluded)
    return [
        *found,
        [f"{WRONG}: excluded when it is good again", f"{len(excluded)} of {len(its)}"],
        [f"{WRONG}: taken back within {BACK_WITHIN_S:g} s", f"{back} of {len(excluded)}"],
        [f"{WRONG}: taken back", _range(excluded, "taken_back_after_s")],
    ]


def _range(its: Sequence[Mapping[str, float]], name: str) -> str:
    values = sorted(it[name] for it in its if math.isfinite(it[name]))
    never = len(its) - len(values)
    if not values:
        return f"never in {never}"
    middle = values[len(values) // 2]
    words = f"{values[0]:.1f} to {values[-1]:.1f} s, median {middle:.1f} s"
    return words + (f"; never in {never}" if never else "")
