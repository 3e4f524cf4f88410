"""Flies the random set points of a healthy flight, and judges it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import fcc
import numpy as np
import numpy.typing as npt

from ..lockstep_rig import LockstepRig
from ..motion import longest_s
from ..state import State
from ..truth import Truth
from ..units import FT_TO_M, KT_TO_MPS, STANDARD_GRAVITY_MPS2
from .alarms import FAILSAFE, RELEASE, Alarm, alarms_of
from .healthy import HealthyFlight, SetPointOrder
from .verdict import Verdict

STALL_DEG = 16.5
LONGEST_STALL_S = 1.0
# By severity of turbulence, 0 to 7; of the bank's 1 and 2 lie on a line between 0 and 3.
BANK_DEG = (38.0, 40.0, 43.0, 45.0, 52.0, 60.0, 60.0, 60.0)
TIMES = (1.0, 2.0, 2.0, 2.0, 4.0, 8.0, 8.0, 8.0)
"""By which the limits of what is held are multiplied."""
CALM_LOADS_G = (0.0, 2.3)
CALM_RATE_SD_DEGPS = 4.0
CALM_RATE_S = 20.0
HELD_S = 30.0
HELD = {"heading": 3.0, "altitude": 15.0, "airspeed": 4.0}
"""RMS of what the sensors show from the set points in the last 30 s, in °, ft and kt."""
_SETTLES_S = 15.0
"""After a climb at the configured rate."""
_FULL, _IDLE = 0.97, 0.03
_LACKING = 0.25
"""Power does not suffice if the throttle was at its end for this share of the last 45 s."""
_TWICE_G_FT = 2.0 * STANDARD_GRAVITY_MPS2 * FT_TO_M
"""The height of a speed in m/s is its square by this, in ft."""
_GROUND_FT = 50.0

BROKEN = (
    *("ground", "stall", "below Vs", "above Vne", "bank", "load", "oscillation"),
    *("released", "failsafe", "heading", "altitude", "airspeed", "not engaged", "not flown"),
)
"""What can be broken, the worst first."""

Samples = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Flown:
    """What was shown and ordered, a row per tick since engaging; °, ft, kt."""

    shown: Mapping[str, Samples]
    ordered: Mapping[str, Samples]
    last_order: SetPointOrder | None
    refused: tuple[str, ...]
    alarms: tuple[Alarm, ...]


def fly_set_points(rig: LockstepRig, flight: HealthyFlight) -> Flown:
    """Fly to the end, or until the controls are released or the ground is reached."""
    machine, plant, engaged_s = rig.machine, rig.plant, rig.time_s
    first_m = machine.setpoints.altitude_m
    rows: list[tuple[float, ...]] = []
    faults: list[tuple[float, frozenset[str]]] = [(0.0, frozenset())]

    def is_over() -> bool:
        shown = _shown(rig, flight)
        ordered = machine.setpoints
        rows.append(
            (
                *(shown.heading_rad, shown.altitude_m, shown.airspeed_mps),
                *(ordered.heading_rad, ordered.altitude_m, ordered.airspeed_mps),
            )
        )
        now = frozenset(machine.faults)
        if now != faults[-1][1]:
            faults.append((rig.time_s - engaged_s, now))
        return not rig.holds_control or not plant.fdm["position/h-agl-ft"] > _GROUND_FT

    last, refused = None, []
    for order in (*flight.set_points, None):
        until_s = flight.seconds if order is None else order.time_s
        rig.fly_to(engaged_s + until_s, until=is_over)
        is_done = rig.time_s < engaged_s + until_s - 1e-6
        if order is None or is_done:
            break
        # In failsafe no order is taken.
        if machine.state == "engaged":
            from_m = _shown(rig, flight).altitude_m if order.from_present else first_m
            try:
                _command(machine, order, from_m)
                last = order
            except (fcc.Error, ValueError) as error:
                refused.append(f"{order.time_s:.0f} s: {error}")
    degrees = np.array([math.degrees(1.0), 1.0 / FT_TO_M, 1.0 / KT_TO_MPS] * 2)
    columns = (np.array(rows) * degrees).T
    since = [replace(event, time_s=event.time_s - engaged_s) for event in rig.events]
    alarms = alarms_of(since, faults, rig.time_s - engaged_s)
    return Flown(
        shown=dict(zip(HELD, columns[:3], strict=True)),
        ordered=dict(zip(HELD, columns[3:], strict=True)),
        last_order=last,
        refused=tuple(refused),
        alarms=tuple(_followed(alarm, rig.truth().since(engaged_s)) for alarm in alarms),
    )


def _shown(rig: LockstepRig, flight: HealthyFlight) -> State | fcc.Estimate:
    """Return what the sensors show; of raw sensors, what navigation makes of it."""
    if flight.bounds.raw_sensors is not None or rig.measured is None:
        return rig.machine.estimate
    return rig.measured


def _command(machine: fcc.Machine, order: SetPointOrder, from_m: float) -> None:
    machine.command(
        heading_rad=None if order.heading_deg is None else math.radians(order.heading_deg),
        pressure_altitude_m=(None if order.climb_ft is None else from_m + order.climb_ft * FT_TO_M),
        airspeed_mps=None if order.airspeed_kt is None else order.airspeed_kt * KT_TO_MPS,
    )


def _followed(alarm: Alarm, truth: Truth) -> Alarm:
    """Return it with what followed."""
    after = truth.since(float(truth["time_s"][0]) + alarm.begins_s)
    lowest_ft = float(np.min(after["altitude_ft"]))
    return replace(alarm, lowest_ft=lowest_ft, into_ground=_hits(after))


def _hits(truth: Truth) -> bool:
    return not float(np.min(truth["height_ft"])) > _GROUND_FT


def judge(flight: HealthyFlight, truth: Truth, flown: Flown) -> Verdict:
    """Judge a flight by its truth since engaging, and by what its sensors showed."""
    severity = flight.weather.turbulence_severity
    time_s = truth["time_s"] - truth["time_s"][0]
    ended_s = float(time_s[-1])
    late = truth.since(float(truth["time_s"][-1]) - CALM_RATE_S)
    figures = {
        "lowest_ft": float(np.min(truth["altitude_ft"])),
        "stalled_s": longest_s(truth["angle_of_attack_deg"] > STALL_DEG),
        "below_stall_speed_s": longest_s(truth["airspeed_kt"] < flight.stall_kt),
        "airspeed_over_stall": float(np.min(truth["airspeed_kt"])) / flight.stall_kt,
        "largest_airspeed_kt": float(np.max(truth["airspeed_kt"])),
        "largest_angle_of_attack_deg": float(np.max(truth["angle_of_attack_deg"])),
        "largest_bank_deg": float(np.max(np.abs(truth["roll_deg"]))),
        "least_load_g": float(np.min(truth["load_g"])),
        "largest_load_g": float(np.max(truth["load_g"])),
        "pitch_rate_sd_degps": float(np.std(late["pitch_rate_degps"])),
        "roll_rate_sd_degps": float(np.std(late["roll_rate_degps"])),
    }
    broken = {}
    if _hits(truth):
        broken["ground"] = f"at {ended_s:.1f} s"
    if figures["stalled_s"] >= LONGEST_STALL_S:
        broken["stall"] = f"{figures['stalled_s']:.1f} s beyond {STALL_DEG}° of attack"
    if figures["below_stall_speed_s"] >= LONGEST_STALL_S:
        slow_s = figures["below_stall_speed_s"]
        broken["below Vs"] = f"{slow_s:.1f} s below {flight.stall_kt:.1f} kt"
    if not figures["largest_airspeed_kt"] < flight.limits.never_exceed_kt:
        broken["above Vne"] = f"{figures['largest_airspeed_kt']:.0f} kt"
    if not figures["largest_bank_deg"] <= BANK_DEG[severity]:
        broken["bank"] = f"{figures['largest_bank_deg']:.0f}°, limit {BANK_DEG[severity]:.0f}°"
    if severity == 0:
        least_g, most_g = figures["least_load_g"], figures["largest_load_g"]
        if not CALM_LOADS_G[0] <= least_g <= most_g <= CALM_LOADS_G[1]:
            broken["load"] = f"{least_g:.2f} to {most_g:.2f} g"
        rates = {axis: figures[f"{axis}_rate_sd_degps"] for axis in ("pitch", "roll")}
        if not max(rates.values()) < CALM_RATE_SD_DEGPS:
            broken["oscillation"] = ", ".join(f"{k} {v:.1f} °/s (1 sd)" for k, v in rates.items())
    for kind, words in ((RELEASE, "released"), (FAILSAFE, "failsafe")):
        first = next((alarm for alarm in flown.alarms if alarm.kind == kind), None)
        if first is not None:
            broken[words] = f"at {first.begins_s:.1f} s for {first.lasted_s:.1f} s: {first.reason}"
    if flight.fault is None and ended_s > flight.seconds - 1.0:
        held = _held(flight, truth, flown)
        figures |= {f"{name}_rms": rms for name, (rms, _) in held.items()}
        broken |= {
            name: f"{rms:.1f} RMS from its set point, limit {limit:.1f}"
            for name, (rms, limit) in held.items()
            if not rms <= limit
        }
    return Verdict(broken, figures)


def _held(flight: HealthyFlight, truth: Truth, flown: Flown) -> dict[str, tuple[float, float]]:
    """Return the RMS and its limit of what was to be held in the last 30 s.

    Nothing where power does not suffice or the flight still climbs or descends. A sensor with steps
    may show half of one beside the set point.
    """
    if _lacks_power(truth, flown) or _still_climbs(flight, truth, flown):
        return {}
    times = TIMES[flight.weather.turbulence_severity]
    ticks = truth["time_s"] >= truth["time_s"][-1] - HELD_S
    count = int(np.count_nonzero(ticks))
    held = {}
    for name, limit in HELD.items():
        off = (flown.shown[name] - flown.ordered[name])[-count:]
        if name == "heading":
            off = (off + 180.0) % 360.0 - 180.0
        rms = float(np.sqrt(np.mean(off**2)))
        held[name] = rms, times * limit + 0.5 * flight.steps.get(name, 0.0)
    return held


def _lacks_power(truth: Truth, flown: Flown) -> bool:
    """Return whether the throttle is full while energy is to be gained, or idle while it is lost.

    Full throttle above both set points is no lack of power.
    """
    late = truth["time_s"] >= truth["time_s"][-1] - HELD_S - _SETTLES_S
    count = int(np.count_nonzero(late))
    shown_ft, ordered_ft = (
        (it["altitude"] + (it["airspeed"] * KT_TO_MPS) ** 2 / _TWICE_G_FT)[-count:]
        for it in (flown.shown, flown.ordered)
    )
    throttle, short = truth["throttle"][late][-len(shown_ft) :], shown_ft < ordered_ft
    return bool(np.mean(np.where(short, throttle >= _FULL, throttle <= _IDLE)) > _LACKING)


def _still_climbs(flight: HealthyFlight, truth: Truth, flown: Flown) -> bool:
    """Return whether the last altitude cannot be reached before the last 30 s.

    At the configured rates of climb and descent, from where it was when it was ordered.
    """
    if flown.last_order is None:
        return False
    time_s = truth["time_s"] - truth["time_s"][0]
    at = int(np.searchsorted(time_s, flown.last_order.time_s))
    shown_ft, ordered_ft = flown.shown["altitude"], flown.ordered["altitude"]
    change_ft = float(ordered_ft[-1] - shown_ft[min(at, len(shown_ft) - 1)])
    limits = flight.limits
    most_fpm = limits.most_climb_fpm if change_ft > 0.0 else limits.most_sink_fpm
    has_s = float(time_s[-1]) - HELD_S - _SETTLES_S - flown.last_order.time_s
    return abs(change_ft) > most_fpm * has_s / 60.0
