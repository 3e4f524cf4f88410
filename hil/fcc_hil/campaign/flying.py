"""Flies one flight of the campaign in lockstep, by the daemon's own loop."""

from __future__ import annotations

import hashlib
import math
import time
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import fcc

from ..aircraft import by_name
from ..configurations import configuration, with_values, without_section
from ..lockstep_rig import Conditions, LockstepRig
from ..noise import NoiseLevels
from ..pattern import Leg, SetPoints
from ..plant import Plant, TrimError
from ..raw_calibration import calibrate
from ..raw_flight import MEASURED, RAW_LATITUDE_DEG, RAW_STANDBY_S
from ..raw_sensors import FIELD_UT
from ..rig import Event
from ..sensor_faults import Faults
from ..settings import Settings
from ..truth import Truth
from ..units import FT_TO_M, KT_TO_MPS, wrap_heading
from . import airspeed, healthy
from .air import mover
from .alarms import Alarm
from .draw import HOLD_S, LEG_S, Bounds, Fault, Flight, Order, draw
from .healthy import TUBE, WRONG, HealthyFlight
from .raw_faults import RawFaults
from .set_points import fly_set_points
from .set_points import judge as judge_set_points
from .verdict import Verdict, judge

_ENGAGES_WITHIN_S = 10.0
_TRIES_FOR_S = 1.0
_GROUND_FT = 50.0
_NO_EVENTS: tuple[Event, ...] = ()


@dataclass(frozen=True)
class Outcome:
    """The result of a flight."""

    flight: Flight
    verdict: Verdict
    events: tuple[Event, ...]
    """What the autopilot reported; times are those of the flight."""
    digest: str
    """Of every bit of the truth: equal for equal flights; empty if it was not flown."""
    simulated_s: float
    cpu_s: float
    alarms: tuple[Alarm, ...] = ()
    """Of a healthy flight."""
    refused: tuple[str, ...] = ()

    @property
    def command(self) -> str:
        """The command that flies it again."""
        flight = self.flight
        words = f"--flight {flight.number} --seed {flight.seed}"
        return f"fcc campaign {words}{flight.bounds.words}"

    def document(self) -> dict[str, Any]:
        """Return it for JSON."""
        return {
            "flight": asdict(self.flight) | {"delay_ms": self.flight.delay_ms},
            "stall_kt": self.flight.stall_kt,
            "broken": dict(self.verdict.broken),
            "figures": self.verdict.figures,
            "alarms": [asdict(alarm) | {"lasted_s": alarm.lasted_s} for alarm in self.alarms],
            "refused": self.refused,
            "events": [asdict(event) for event in self.events],
            "digest": self.digest,
            "simulated_s": self.simulated_s,
            "cpu_s": self.cpu_s,
            "command": self.command,
        }


@dataclass(frozen=True)
class Task:
    """Which flight to fly."""

    number: int
    seed: int
    bounds: Bounds


def fly_task(task: Task) -> Outcome:
    """Fly one flight and judge it."""
    return fly(drawn(task.number, task.seed, task.bounds))[0]


def drawn(number: int, seed: int, bounds: Bounds) -> Flight:
    """Draw a flight of any kind."""
    return (draw if bounds.kind == Bounds().kind else healthy.draw)(number, seed, bounds)


def fly(flight: Flight, recording: Path | None = None) -> tuple[Outcome, Truth | None]:
    """Fly and judge; return the outcome, and the truth unless the aircraft could not be trimmed.

    With `recording`, save the autopilot's there.
    """
    began_s = time.process_time()
    try:
        rig = _rig(flight)
    except (TrimError, ValueError) as error:
        verdict = Verdict({"not flown": str(error)}, {})
        return Outcome(flight, verdict, _NO_EVENTS, "", 0.0, time.process_time() - began_s), None
    inhibits = "" if rig.holds_control else ", ".join(rig.machine.engage_inhibits) or "refused"
    engaged_s = rig.time_s
    verdict, flown = Verdict({"not engaged": inhibits}, {}), None
    if inhibits:
        pass
    elif isinstance(flight, HealthyFlight):
        flown = fly_set_points(rig, flight)
        since = rig.truth().since(engaged_s)
        verdict = judge_set_points(flight, since, flown)
        if flight.fault is not None:
            of_fault = airspeed.figures(flight, flight.fault, since, flown)
            verdict = replace(verdict, figures={**verdict.figures, **of_fault})
    else:
        legs, refused = _fly(rig, flight)
        verdict = judge(flight, rig.truth(), legs, refused, is_released=not rig.holds_control)
    truth = rig.truth()
    if recording is not None:
        rig.save_recording(recording)
    outcome = Outcome(
        flight=flight,
        verdict=verdict,
        events=tuple(rig.events),
        digest=hashlib.sha256(truth.table().tobytes()).hexdigest(),
        simulated_s=rig.time_s,
        cpu_s=time.process_time() - began_s,
        alarms=() if flown is None else flown.alarms,
        refused=() if flown is None else flown.refused,
    )
    return outcome, truth


def config_of(flight: Flight) -> str:
    """Return the configuration: the aircraft's own, or the defaults.

    With the flight's pattern, and the stalling speed of the greatest weight.
    """
    values: dict[str, float | str | list[float]] = {
        "autopilot.envelope.stall_airspeed_kt": flight.limits.stall_setting_kt,
    }
    text = configuration(flight.aircraft)
    if isinstance(flight, HealthyFlight):
        text = without_section(text, "guidance")
        values["guidance.mode"] = "hold"
    else:
        first = flight.orders[0]
        values |= {
            "guidance.mode": "timed-pattern",
            # The first command ends the pattern.
            "guidance.hold_s": HOLD_S if flight.is_pattern else 10.0 * HOLD_S,
            "guidance.leg_s": LEG_S,
            "guidance.turn_deg": first.turn_deg if flight.is_pattern else 0.0,
            "guidance.climb_ft": first.climb_ft if flight.is_pattern else 0.0,
        }
    if flight.bounds.raw_sensors is not None:
        # Where X-Plane is the source, there are no raw readings.
        text = without_section(text, "x-plane")
        values["navigation.method"] = "kalman"
        values["navigation.magnetic_field_ut"] = list(FIELD_UT)
    return with_values(text, values)


def _rig(flight: Flight) -> LockstepRig:
    aircraft = replace(
        by_name(flight.aircraft), airspeed_kt=flight.airspeed_kt, loading=flight.loading
    )
    # One flight's turbulence and noise are not another's.
    seed = (flight.seed * 10_007 + flight.number) % 2**31
    sensors = flight.bounds.raw_sensors
    by_raw = sensors is not None
    plant = Plant(
        aircraft,
        seed=seed,
        weather=flight.weather,
        latitude_deg=RAW_LATITUDE_DEG if by_raw else 0.0,
    )
    usual = NoiseLevels()
    levels = NoiseLevels(**{name: flight.noise * sigma for name, sigma in asdict(usual).items()})
    engaged_s = [math.inf]
    falsify = RawFaults(flight.fault, lambda: plant.time_s - engaged_s[0]) if by_raw else None
    conditions = Conditions(
        levels=levels,
        sensor_delay_ticks=flight.sensor_delay_ticks,
        receiver=None if by_raw else flight.receiver,
        actuation=flight.actuation,
        gust=mover(flight.gusts, lambda: plant.time_s - engaged_s[0]) if flight.gusts else None,
        raw_sensors=sensors,
        calibration=None if sensors is None else calibrate(sensors, seed, FIELD_UT),
        raw_fault=falsify,
        without=MEASURED if by_raw else frozenset(),
    )
    errors = []
    if isinstance(flight, HealthyFlight):
        errors = flight.errors()
        conditions = replace(
            conditions,
            biases=flight.biases,
            trim=flight.measures_trim,
            position=flight.measures_position and not by_raw,
        )
    if by_raw and flight.receiver is None:
        conditions = replace(conditions, without=conditions.without | {"gnss"})
    settings = Settings(aircraft=flight.aircraft, seed=seed, noise=not by_raw)
    rig = LockstepRig(settings, plant, fcc.Machine(config_of(flight)), conditions)
    faults = Faults(lambda: rig.time_s, lambda more: rig.set_faults([*errors, *more]), seed)
    if not isinstance(flight, HealthyFlight):
        for name, by in flight.biases.items():
            faults.bias(name, by=by)
    rig.set_faults([*errors, *faults.all])
    rig.prepare()
    if by_raw:
        rig.fly_to(RAW_STANDBY_S)
    _engage(rig)
    engaged_s[0] = rig.time_s
    if flight.fault is not None:
        _put_in(flight.fault, faults, by_raw=by_raw)
    return rig


def _engage(rig: LockstepRig) -> None:
    """Switch on; if that is refused, as in a gust below the lowest airspeed, off and on again."""
    ends_s = rig.time_s + _ENGAGES_WITHIN_S
    while not rig.holds_control and rig.time_s < ends_s:
        rig.set_switch(on=True)
        rig.fly_to(rig.time_s + _TRIES_FOR_S, until=lambda: rig.holds_control)
        if not rig.holds_control:
            rig.set_switch(on=False)
            rig.fly_to(rig.time_s + _TRIES_FOR_S)


def _put_in(fault: Fault, faults: Faults, *, by_raw: bool) -> None:
    """Put a sensor's fault in; the engine is failed by `_fly`, one raw sensor by `RawFaults`."""
    when: dict[str, Any] = {"after": fault.begins_s, "lasts": fault.lasts_s}
    sensor = fault.what.split()[0]
    if fault.what == "samples lost":
        faults.loss("everything", share=fault.amount, **when)
    elif sensor == "everything":
        faults.loss(sensor, **when)
    elif by_raw:
        return
    elif fault.what.endswith("frozen"):
        faults.freeze(sensor, **when)
    elif fault.what.endswith("biased") or fault.what == WRONG:
        faults.bias(sensor, by=fault.amount, **when)
    elif fault.what == TUBE:
        faults.blocked_tube(**when)
    elif fault.what != "engine out":
        faults.loss(sensor, **when)


def _fly(rig: LockstepRig, flight: Flight) -> tuple[list[Leg], list[str]]:
    """Fly to the end, or until the controls are released or the ground is reached.

    Returns the legs, the first of which is the hold, and the refused orders.
    """
    plant, engaged_at_s = rig.plant, rig.time_s
    now = rig.truth().captured_at(engaged_at_s)
    failed = flight.fault is not None and flight.fault.what == "engine out"
    fails_s = engaged_at_s + flight.fault.begins_s if failed and flight.fault else math.inf

    def is_over() -> bool:
        nonlocal fails_s
        if rig.time_s >= fails_s:
            plant.fail_engines()
            fails_s = math.inf
        height_ft = plant.fdm["position/h-agl-ft"]
        return not rig.holds_control or not height_ft > _GROUND_FT

    legs = [_leg(engaged_at_s, HOLD_S, now, now)]
    refused: list[str] = []
    rig.fly_to(legs[0].end_s, until=is_over)
    for drawn in flight.orders:
        if is_over():
            break
        # In failsafe no order is taken.
        waits = not flight.is_pattern and rig.machine.state != "engaged"
        order = Order(0.0, 0.0) if waits else drawn
        to = _after(order, now)
        if not flight.is_pattern and not waits:
            refused += _command(rig.machine, order, to)
        legs.append(_leg(legs[-1].end_s, LEG_S, now, to))
        now = to
        rig.fly_to(legs[-1].end_s, until=is_over)
    return legs, refused


def _after(order: Order, now: SetPoints) -> SetPoints:
    return SetPoints(
        heading_deg=wrap_heading(now.heading_deg + order.turn_deg),
        altitude_ft=now.altitude_ft + order.climb_ft,
        airspeed_kt=now.airspeed_kt if order.airspeed_kt is None else order.airspeed_kt,
    )


def _command(machine: fcc.Machine, order: Order, to: SetPoints) -> list[str]:
    """Command a change of the autopilot's own set points; return the refusal, if there is one."""
    stand = machine.setpoints
    try:
        machine.command(
            heading_rad=stand.heading_rad + math.radians(order.turn_deg),
            pressure_altitude_m=stand.altitude_m + order.climb_ft * FT_TO_M,
            airspeed_mps=None if order.airspeed_kt is None else to.airspeed_kt * KT_TO_MPS,
        )
    except (fcc.Error, ValueError) as error:
        return [str(error)]
    return []


def _leg(start_s: float, lasts_s: float, now: SetPoints, to: SetPoints) -> Leg:
    return Leg(
        start_s=start_s,
        end_s=start_s + lasts_s,
        heading_from_deg=now.heading_deg,
        heading_deg=to.heading_deg,
        altitude_from_ft=now.altitude_ft,
        altitude_ft=to.altitude_ft,
        airspeed_kt=to.airspeed_kt,
    )
