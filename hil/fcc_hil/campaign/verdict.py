"""Judges a flight by its true state: clean, or what was broken.

Limits in turbulence are those of an aircraft that is thrown about by the air and not by its
autopilot: see docs/campaign.md.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..motion import longest_s, motion, steady_pitch_rate_sd
from ..pattern import Leg
from ..score import ALTITUDE_RMS_WINDOW_S, LegScore, score
from ..truth import TRUTH_HZ, Truth
from .draw import HOLD_S, LEG_S, Flight

LONGEST_STALL_S = 1.0
"""Beyond the stalling angle, or below the stalling speed, without interruption."""
LARGEST_BANK_DEG = 60.0
"""Beyond it a manoeuvre is aerobatic (14 CFR 91.307)."""
LOADS_G = (-1.52, 3.8)
"""The limit loads of the normal category (14 CFR 23.337 until 2017)."""
_LOST_BANK_DEG = 90.0
_GROUND_FT = 100.0

CALM_PITCH_RATE_SD_DEGPS = 2.0
NOISE_PITCH_RATE_SD_DEGPS = 2.0
"""For each multiple of the usual noise of the sensors."""

# By severity of turbulence, 0 to 7.
AIR_PITCH_RATE_SD_DEGPS = (0.0, 0.7, 1.3, 3.0, 4.3, 6.1, 7.5, 8.5)
"""Of the c172p with its controls fixed in trim: the largest of 6 flights at 69 and 104 kt."""
HEADING_RMS_DEG = (3.0, 3.0, 3.0, 5.0, 8.0, 12.0, 15.0, 15.0)
ALTITUDE_RMS_FT = (20.0, 20.0, 25.0, 40.0, 80.0, 150.0, 200.0, 250.0)

_FULL, _IDLE = 0.97, 0.03
_RETURN_S = 5.0
"""What was lost is believed again, and flown by, within this time."""
_LONGEST_TURN_S = 20.0
"""120° at the bank limit, the largest order, with its beginning and end."""

KINDS = (
    *("lost", "stall", "below Vs", "bank", "load", "oscillation"),
    *("released", "refused", "unsettled", "not engaged", "not flown"),
)
"""What can be broken, the worst first."""


@dataclass(frozen=True)
class Verdict:
    """What was broken, in words by its kind; and the figures of the flight."""

    broken: Mapping[str, str]
    figures: Mapping[str, float]

    @property
    def is_clean(self) -> bool:
        """Whether nothing was broken."""
        return not self.broken


def judge(
    flight: Flight,
    truth: Truth,
    legs: Sequence[Leg],
    refused: Sequence[str],
    *,
    is_released: bool,
) -> Verdict:
    """Judge a flight: its truth, its legs, the first of them the hold, and its refused orders."""
    engaged = truth.since(legs[0].start_s)
    ends_s = float(engaged["time_s"][-1])
    flown = [leg for leg in legs if leg.start_s < ends_s]
    stalled_s = longest_s(engaged["angle_of_attack_deg"] > flight.limits.stall_deg)
    slow_s = longest_s(engaged["airspeed_kt"] < flight.stall_kt)
    calm = [
        leg
        for leg in flown
        if not _is_gusty(flight, leg.end_s - legs[0].start_s)
        and not (flight.is_pattern and _is_degraded(flight, leg, legs[0].start_s))
        and not _turns_back(flight, leg, legs[0].start_s)
    ]
    figures = motion(engaged, flown) | {
        "pitch_rate_sd_degps": max(
            (steady_pitch_rate_sd(engaged, leg) for leg in calm), default=0.0
        ),
        "stalled_s": stalled_s,
        "below_stall_speed_s": slow_s,
        "airspeed_over_stall": float(np.min(engaged["airspeed_kt"])) / flight.stall_kt,
    }
    broken = {}
    lowest_ft = float(np.min(engaged["altitude_ft"]))
    if not lowest_ft > _GROUND_FT or not figures["largest_bank_deg"] <= _LOST_BANK_DEG:
        broken["lost"] = f"down to {lowest_ft:.0f} ft, bank {figures['largest_bank_deg']:.0f}°"
    if stalled_s >= LONGEST_STALL_S:
        broken["stall"] = f"{stalled_s:.1f} s beyond {flight.limits.stall_deg:g}° of attack"
    if slow_s >= LONGEST_STALL_S:
        broken["below Vs"] = f"{slow_s:.1f} s below {flight.stall_kt:.1f} kt"
    if not figures["largest_bank_deg"] <= LARGEST_BANK_DEG:
        broken["bank"] = f"{figures['largest_bank_deg']:.0f}°"
    if not LOADS_G[0] <= figures["least_load_g"] <= figures["largest_load_g"] <= LOADS_G[1]:
        loads = f"{figures['least_load_g']:.2f} to {figures['largest_load_g']:.2f} g"
        broken["load"] = loads
    sd_degps, most_degps = figures["pitch_rate_sd_degps"], largest_pitch_rate_sd_degps(flight)
    if not sd_degps <= most_degps:
        broken["oscillation"] = f"pitch rate {sd_degps:.1f} °/s (1 sd), limit {most_degps:.1f} °/s"
    if is_released:
        broken["released"] = f"at {ends_s - legs[0].start_s:.1f} s"
    if refused:
        broken["refused"] = refused[0]
    ended = [leg for leg in flown if leg.end_s <= ends_s + 1.0 / TRUTH_HZ]
    judged = [leg for leg in ended if not _is_degraded(flight, leg, legs[0].start_s)]
    unsettled = _unsettled(flight, engaged, judged)
    if unsettled:
        broken["unsettled"] = "; ".join(unsettled)
    return Verdict(broken, figures)


def largest_pitch_rate_sd_degps(flight: Flight) -> float:
    """Return the limit of the pitch rate's standard deviation.

    What the air does to an aircraft without a pilot, the share of the sensors' noise, and the limit
    in calm air are independent of each other, so that their squares add.
    """
    return math.hypot(
        CALM_PITCH_RATE_SD_DEGPS,
        NOISE_PITCH_RATE_SD_DEGPS * flight.noise,
        AIR_PITCH_RATE_SD_DEGPS[flight.weather.turbulence_severity],
    )


def _is_gusty(flight: Flight, ends_s: float) -> bool:
    """Return whether a gust moves the air in the steady time before `ends_s` since engaging."""
    return any(
        gust.begins_s < ends_s
        and gust.begins_s + 2.0 * gust.ramp_s + gust.steady_s > ends_s - ALTITUDE_RMS_WINDOW_S
        for gust in flight.gusts
    )


def _is_degraded(flight: Flight, leg: Leg, engaged_at_s: float) -> bool:
    """Return whether a quantity was lost in a leg, so that it was not flown to its end.

    The autopilot then flies level, and continues when the quantity is back for some seconds: a
    timed pattern later than its times here, so that no leg after the fault is judged.
    """
    fault = flight.fault
    if fault is None or fault.lasts_s is None:
        return False
    begins_s = engaged_at_s + fault.begins_s
    over_s = math.inf if flight.is_pattern else begins_s + fault.lasts_s + _RETURN_S
    return leg.start_s < over_s and leg.end_s > begins_s


def _turns_back(flight: Flight, leg: Leg, engaged_at_s: float) -> bool:
    """Return whether it ends with the turn that a lost quantity had delayed."""
    fault = flight.fault
    if fault is None or fault.lasts_s is None:
        return False
    returns_s = engaged_at_s + fault.begins_s + fault.lasts_s
    return leg.end_s - _LONGEST_TURN_S - _RETURN_S < returns_s < leg.end_s


def _unsettled(flight: Flight, truth: Truth, legs: Sequence[Leg]) -> list[str]:
    start_s = float(truth["time_s"][0])
    severity = flight.weather.turbulence_severity
    words = []
    scores: list[LegScore] = score(truth.trace(), legs)["legs"] if legs else []
    fell_behind = False
    for leg, flown in zip(legs, scores, strict=True):
        number = round((leg.end_s - HOLD_S - start_s) / LEG_S)
        if not flown["heading_rms_deg"] <= HEADING_RMS_DEG[severity]:
            words.append(f"leg {number}: heading {flown['heading_rms_deg']:.1f}° RMS")
        is_high = not flown["altitude_rms_ft"] <= ALTITUDE_RMS_FT[severity]
        lacks_power = _lacks_power(flight, truth, leg)
        has_time = _has_time(flight, truth, leg)
        if is_high and has_time and not lacks_power and not fell_behind:
            words.append(f"leg {number}: altitude {flown['altitude_rms_ft']:.0f} ft RMS")
        # What the air took in this leg is regained in the next.
        fell_behind = lacks_power
    return words


def _has_time(flight: Flight, truth: Truth, leg: Leg) -> bool:
    """Return whether the altitude can be reached before it is judged, as fast as configured."""
    begins = int(np.searchsorted(truth["time_s"], leg.start_s))
    change_ft = leg.altitude_ft - float(truth["altitude_ft"][begins])
    most_fpm = flight.limits.most_climb_fpm if change_ft > 0.0 else flight.limits.most_sink_fpm
    return abs(change_ft) <= most_fpm * (leg.end_s - leg.start_s - ALTITUDE_RMS_WINDOW_S) / 60.0


def _lacks_power(flight: Flight, truth: Truth, leg: Leg) -> bool:
    """Return whether the engine is out, or the throttle at its end: the air is stronger."""
    if flight.fault is not None and flight.fault.what == "engine out":
        return True
    time_s = truth["time_s"]
    ending = (time_s >= leg.end_s - 2.0 * ALTITUDE_RMS_WINDOW_S) & (time_s < leg.end_s)
    throttle = truth["throttle"][ending]
    return bool(np.mean((throttle >= _FULL) | (throttle <= _IDLE)) > 0.5)
