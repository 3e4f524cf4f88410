"""Judges a flight: clean, or what was broken.

By the truth since engaging, and, for what is to be held, by what the sensors showed. Limits in
turbulence are those of an aircraft that is thrown about by the air and not by its autopilot: see
docs/campaign.md.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

import numpy as np
import numpy.typing as npt

from ..motion import longest_s
from ..truth import TRUTH_HZ, Truth
from ..units import FT_TO_M, KT_TO_MPS, STANDARD_GRAVITY_MPS2
from .alarms import FAILSAFE, RELEASE, Alarm
from .draw import LEGS_S, Flight

GROUND_FT = 50.0
LONGEST_STALL_S = 1.0
"""Beyond the stalling angle, or below the stalling speed, without interruption."""
HELD = ("heading", "altitude", "airspeed")
_FULL, _IDLE = 0.97, 0.03
_LACKING = 0.25
"""Power does not suffice if the throttle was at its end for this share of the time."""
_TWICE_G_FT = 2.0 * STANDARD_GRAVITY_MPS2 * FT_TO_M
"""The height of a speed in m/s is its square by this, in ft."""
_RETURN_S = 25.0
"""What was lost is flown by again within 5 s, and the longest turn that it delayed takes 20 s."""

BROKEN = (
    *("ground", "stall", "below Vs", "above Vne", "bank", "load", "oscillation"),
    *("released", "failsafe", "refused", *HELD, "not engaged", "not flown"),
)
"""What can be broken, the worst first."""

Samples = npt.NDArray[np.float64]
_SEVERITIES = 8
_UNLIMITED = (math.inf,) * _SEVERITIES


@dataclass(frozen=True)
class Limits:
    """The limits of a kind of campaign; tuples are by severity of turbulence, 0 to 7."""

    held_s: float
    """For how long what is ordered is to be held, before the end."""
    settles_s: float
    """Before that, after a climb at the configured rate."""
    rates_s: float
    """For how long before the end the rates are judged."""
    stall_deg: float | None = None
    """None for the angle of the aircraft's greatest lift."""
    bank_deg: tuple[float, ...] = _UNLIMITED
    loads_g: tuple[tuple[float, float], ...] = ((-math.inf, math.inf),) * _SEVERITIES
    rates: tuple[str, ...] = ("pitch", "roll")
    rate_sd_degps: float = math.inf
    """The limit of their standard deviation in calm air."""
    noise_rate_sd_degps: float = 0.0
    """For each multiple of the usual noise of the sensors."""
    air_rate_sd_degps: tuple[float, ...] = _UNLIMITED
    held: Mapping[str, tuple[float, ...]] = field(default_factory=dict)
    """RMS of what the sensors show from the set points, in °, ft and kt."""
    breaks: tuple[str, ...] = ("released", "failsafe")
    ends_s: tuple[float, ...] = ()
    """When it is judged as at the end, since engaging."""


_HEALTHY_BANK_DEG = (38.0, 40.0, 43.0, 45.0, 52.0, 60.0, 60.0, 60.0)
"""1 and 2 lie on a line between 0 and 3."""
_TIMES = (1.0, 2.0, 2.0, 2.0, 4.0, 8.0, 8.0, 8.0)
"""By which the limits of what is held are multiplied."""


def _healthy(held: Mapping[str, float]) -> Limits:
    return Limits(
        held_s=30.0,
        settles_s=15.0,
        rates_s=20.0,
        stall_deg=16.5,
        bank_deg=_HEALTHY_BANK_DEG,
        loads_g=((0.0, 2.3), *((-math.inf, math.inf),) * (_SEVERITIES - 1)),
        rate_sd_degps=4.0,
        air_rate_sd_degps=(0.0, *_UNLIMITED[1:]),
        held={name: tuple(times * limit for times in _TIMES) for name, limit in held.items()},
    )


LIMITS = MappingProxyType(
    {
        "edges": Limits(
            held_s=8.0,
            settles_s=8.0,
            rates_s=8.0,
            # Beyond it a manoeuvre is aerobatic (14 CFR 91.307).
            bank_deg=(60.0,) * _SEVERITIES,
            # The limit loads of the normal category (14 CFR 23.337 until 2017).
            loads_g=((-1.52, 3.8),) * _SEVERITIES,
            rates=("pitch",),
            rate_sd_degps=2.0,
            noise_rate_sd_degps=2.0,
            # Of the c172p with its controls fixed in trim: the largest of 6 flights at 69 and
            # 104 kt.
            air_rate_sd_degps=(0.0, 0.7, 1.3, 3.0, 4.3, 6.1, 7.5, 8.5),
            held={
                "heading": (3.0, 3.0, 3.0, 5.0, 8.0, 12.0, 15.0, 15.0),
                "altitude": (20.0, 20.0, 25.0, 40.0, 80.0, 150.0, 200.0, 250.0),
            },
            breaks=("released", "refused"),
            ends_s=LEGS_S,
        ),
        "healthy": _healthy({"heading": 3.0, "altitude": 15.0, "airspeed": 4.0}),
        "airspeed": _healthy({}),
    }
)
"""By the kind of campaign."""


@dataclass(frozen=True)
class Verdict:
    """What was broken, in words by its kind; and the figures of the flight."""

    broken: Mapping[str, str]
    figures: Mapping[str, float]

    @property
    def is_clean(self) -> bool:
        """Whether nothing was broken."""
        return not self.broken


@dataclass(frozen=True)
class Flown:
    """What was shown and ordered, a row per tick since engaging; °, ft, kt."""

    shown: Mapping[str, Samples]
    ordered: Mapping[str, Samples]
    changes_s: tuple[float, ...]
    """When the set points changed, since engaging."""
    refused: tuple[str, ...]
    alarms: tuple[Alarm, ...]


def hits_ground(truth: Truth) -> bool:
    """Return whether it came to the ground."""
    return not float(np.min(truth["height_ft"])) > GROUND_FT


def largest_rate_sd_degps(flight: Flight) -> float:
    """Return the limit of the rates' standard deviation.

    What the air does to an aircraft without a pilot, the share of the sensors' noise, and the limit
    in calm air are independent of each other, so that their squares add.
    """
    limits = LIMITS[flight.bounds.kind]
    return math.hypot(
        limits.rate_sd_degps,
        limits.noise_rate_sd_degps * flight.noise,
        limits.air_rate_sd_degps[flight.weather.turbulence_severity],
    )


def judge(flight: Flight, truth: Truth, flown: Flown) -> Verdict:
    """Judge a flight by its truth since engaging, and by what its sensors showed."""
    severity, limits = flight.weather.turbulence_severity, LIMITS[flight.bounds.kind]
    ended_s = float(truth["time_s"][-1] - truth["time_s"][0])
    stall_deg = limits.stall_deg or flight.limits.stall_deg
    figures = {
        "lowest_ft": float(np.min(truth["altitude_ft"])),
        "stalled_s": longest_s(truth["angle_of_attack_deg"] > stall_deg),
        "below_stall_speed_s": longest_s(truth["airspeed_kt"] < flight.stall_kt),
        "airspeed_over_stall": float(np.min(truth["airspeed_kt"])) / flight.stall_kt,
        "largest_airspeed_kt": float(np.max(truth["airspeed_kt"])),
        "largest_angle_of_attack_deg": float(np.max(truth["angle_of_attack_deg"])),
        "largest_bank_deg": float(np.max(np.abs(truth["roll_deg"]))),
        "least_load_g": float(np.min(truth["load_g"])),
        "largest_load_g": float(np.max(truth["load_g"])),
    }
    most_deg, (low_g, high_g) = limits.bank_deg[severity], limits.loads_g[severity]
    least_g, most_g = figures["least_load_g"], figures["largest_load_g"]
    sds, most_degps = _rate_sds(flight, truth, limits), largest_rate_sd_degps(flight)
    sds_words = ", ".join(f"{axis} {sds[axis]:.1f} °/s (1 sd)" for axis in limits.rates)
    checks = [
        ("ground", not hits_ground(truth), f"at {ended_s:.1f} s"),
        (
            "stall",
            figures["stalled_s"] < LONGEST_STALL_S,
            f"{figures['stalled_s']:.1f} s beyond {stall_deg}° of attack",
        ),
        (
            "below Vs",
            figures["below_stall_speed_s"] < LONGEST_STALL_S,
            f"{figures['below_stall_speed_s']:.1f} s below {flight.stall_kt:.1f} kt",
        ),
        (
            "above Vne",
            figures["largest_airspeed_kt"] < flight.limits.never_exceed_kt,
            f"{figures['largest_airspeed_kt']:.0f} kt",
        ),
        (
            "bank",
            figures["largest_bank_deg"] <= most_deg,
            f"{figures['largest_bank_deg']:.0f}°, limit {most_deg:.0f}°",
        ),
        ("load", low_g <= least_g <= most_g <= high_g, f"{least_g:.2f} to {most_g:.2f} g"),
        (
            "oscillation",
            all(sds[axis] <= most_degps for axis in limits.rates),
            f"{sds_words}, limit {most_degps:.1f} °/s",
        ),
    ]
    for kind, words in ((RELEASE, "released"), (FAILSAFE, "failsafe")):
        first = next((alarm for alarm in flown.alarms if alarm.kind == kind), None)
        if first is not None:
            when = f"at {first.begins_s:.1f} s for {first.lasted_s:.1f} s: {first.reason}"
            checks.append((words, words not in limits.breaks, when))
    checks += [("refused", "refused" not in limits.breaks, words) for words in flown.refused[:1]]
    broken = {kind: words for kind, is_met, words in checks if not is_met}
    figures |= {f"{axis}_rate_sd_degps": sd for axis, sd in sds.items()}
    for end_s in _ends_s(flight, ended_s):
        held = _held(flight, truth, flown, end_s)
        for name, (rms, limit) in held.items():
            figures[f"{name}_rms"] = max(rms, figures.get(f"{name}_rms", 0.0))
            if not rms <= limit:
                broken[name] = f"{rms:.1f} RMS from its set point, limit {limit:.1f}"
    return Verdict(broken, figures)


def _ends_s(flight: Flight, ended_s: float) -> Iterator[float]:
    """Yield when what is held is judged, since engaging, at the end unless it ended before."""
    limits = LIMITS[flight.bounds.kind]
    ends_s = [end_s for end_s in limits.ends_s if end_s <= ended_s]
    # At the end of a leg a timed pattern has the set points of the next.
    early_s = 0.0 if flight.pattern is None else 1.0 / TRUTH_HZ
    for end_s in (*ends_s, *([ended_s] if ended_s > flight.seconds - 1.0 else [])):
        if not _is_degraded(flight, end_s):
            yield end_s - early_s


def _is_degraded(flight: Flight, end_s: float) -> bool:
    """Return whether a quantity was lost, so that what was ordered is not yet flown at an end.

    The autopilot then flies level, and continues when the quantity is back for some seconds: a
    timed pattern later than its times here, so that nothing after the fault is judged.
    """
    fault, limits = flight.fault, LIMITS[flight.bounds.kind]
    if fault is None or fault.lasts_s is None or fault.begins_s > end_s:
        return False
    good_s = fault.begins_s + fault.lasts_s + _RETURN_S
    return flight.pattern is not None or good_s > end_s - limits.held_s - limits.settles_s


def _is_gusty(flight: Flight, end_s: float) -> bool:
    """Return whether a gust moves the air in the time in which the rates are judged."""
    from_s = end_s - LIMITS[flight.bounds.kind].rates_s
    return any(
        gust.begins_s < end_s and gust.begins_s + 2.0 * gust.ramp_s + gust.steady_s > from_s
        for gust in flight.gusts
    )


def _rate_sds(flight: Flight, truth: Truth, limits: Limits) -> dict[str, float]:
    """Return the largest standard deviations of pitch and roll rate before an end."""
    ended_s = float(truth["time_s"][-1] - truth["time_s"][0])
    ends_s = [end_s for end_s in limits.ends_s if end_s < ended_s]
    masks = [
        _before(truth, end_s, limits.rates_s)
        for end_s in (*ends_s, ended_s)
        if not _is_gusty(flight, end_s) and not _is_degraded(flight, end_s)
    ]
    return {
        axis: max((float(np.std(truth[f"{axis}_rate_degps"][it])) for it in masks), default=0.0)
        for axis in ("pitch", "roll")
    }


def _before(truth: Truth, end_s: float, seconds: float) -> npt.NDArray[np.bool_]:
    """Return which rows are in the time before an end."""
    time_s = truth["time_s"]
    # Sums of ticks are not exact.
    end = int(np.searchsorted(time_s, time_s[0] + end_s - 1e-6))
    return np.asarray((time_s >= time_s[end] - seconds) & (time_s <= time_s[end]))


def _held(
    flight: Flight, truth: Truth, flown: Flown, end_s: float
) -> dict[str, tuple[float, float]]:
    """Return the RMS and its limit of what was to be held before an end.

    Nothing where power does not suffice or the flight still climbs or descends. A sensor with steps
    may show half of one beside the set point.
    """
    limits = LIMITS[flight.bounds.kind]
    if _lacks_power(flight, truth, flown, end_s) or _still_climbs(flight, truth, flown, end_s):
        return {}
    # What was shown and ordered begins a tick after the truth.
    ticks = _before(truth, end_s, limits.held_s)[1:]
    held = {}
    for name, by_severity in limits.held.items():
        off = (flown.shown[name] - flown.ordered[name])[ticks]
        if name == "heading":
            off = (off + 180.0) % 360.0 - 180.0
        rms = float(np.sqrt(np.mean(off**2)))
        limit = by_severity[flight.weather.turbulence_severity]
        held[name] = rms, limit + 0.5 * flight.steps.get(name, 0.0)
    return held


def _lacks_power(flight: Flight, truth: Truth, flown: Flown, end_s: float) -> bool:
    """Return whether the throttle is full while energy is to be gained, or idle while it is lost.

    Full throttle above both set points is no lack of power.
    """
    limits = LIMITS[flight.bounds.kind]
    late = _before(truth, end_s, limits.held_s + limits.settles_s)[1:]
    shown_ft, ordered_ft = (
        (it["altitude"] + (it["airspeed"] * KT_TO_MPS) ** 2 / _TWICE_G_FT)[late]
        for it in (flown.shown, flown.ordered)
    )
    throttle, short = truth["throttle"][1:][late], shown_ft < ordered_ft
    return bool(np.mean(np.where(short, throttle >= _FULL, throttle <= _IDLE)) > _LACKING)


def _still_climbs(flight: Flight, truth: Truth, flown: Flown, end_s: float) -> bool:
    """Return whether the last altitude cannot be reached before it is to be held.

    At the configured rates of climb and descent, from where it was when it was ordered.
    """
    changed_s = max((it for it in flown.changes_s if it < end_s), default=None)
    if changed_s is None:
        return False
    time_s = truth["time_s"] - truth["time_s"][0]
    shown_ft, ordered_ft = flown.shown["altitude"], flown.ordered["altitude"]
    at, end = (min(int(np.searchsorted(time_s, it)), len(shown_ft)) for it in (changed_s, end_s))
    change_ft = float(ordered_ft[end - 1] - shown_ft[min(at, len(shown_ft) - 1)])
    aircraft, limits = flight.limits, LIMITS[flight.bounds.kind]
    most_fpm = aircraft.most_climb_fpm if change_ft > 0.0 else aircraft.most_sink_fpm
    has_s = end_s - limits.held_s - limits.settles_s - changed_s
    return abs(change_ft) > most_fpm * has_s / 60.0
