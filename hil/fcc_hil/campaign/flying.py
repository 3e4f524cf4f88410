"""Flies one flight of the campaign in lockstep, by the daemon's own loop."""

from __future__ import annotations

import hashlib
import math
import time
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import fcc
import numpy as np

from ..aircraft import by_name
from ..configurations import configuration, with_values, without_section
from ..lockstep_rig import Conditions, LockstepRig
from ..noise import NoiseLevels
from ..plant import Plant, TrimError
from ..raw_calibration import calibrate
from ..raw_flight import MEASURED, RAW_LATITUDE_DEG, RAW_STANDBY_S
from ..raw_sensors import FIELD_UT
from ..rig import Event
from ..sensor_faults import Faults
from ..settings import Settings
from ..state import State
from ..truth import Truth
from ..units import FT_TO_M, KT_TO_MPS
from . import airspeed
from .air import mover
from .alarms import Alarm, alarms_of
from .draw import LEGS_S, Bounds, Flight, Order, draw
from .faults import ENGINE_OUT, RawFaults, put_in
from .verdict import GROUND_FT, HELD, Flown, Verdict, hits_ground, judge

_ENGAGES_WITHIN_S = 10.0
_TRIES_FOR_S = 1.0
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
    return fly(draw(task.number, task.seed, task.bounds))[0]


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
    alarms: tuple[Alarm, ...] = ()
    refused: tuple[str, ...] = ()
    if rig.holds_control:
        engaged_s = rig.time_s
        flown = _fly(rig, flight)
        alarms, refused = flown.alarms, flown.refused
        since = rig.truth().since(engaged_s)
        verdict = judge(flight, since, flown)
        if flight.bounds.kind == "airspeed" and flight.fault is not None:
            of_fault = airspeed.figures(flight, flight.fault, since, flown)
            verdict = replace(verdict, figures={**verdict.figures, **of_fault})
    else:
        inhibits = ", ".join(rig.machine.engage_inhibits) or "refused"
        verdict = Verdict({"not engaged": inhibits}, {})
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
        alarms=alarms,
        refused=refused,
    )
    return outcome, truth


def config_of(flight: Flight) -> str:
    """Return the configuration: the aircraft's own, or the defaults.

    With the flight's pattern, and the stalling speed of the greatest weight.
    """
    values: dict[str, float | str | list[float]] = {
        "autopilot.envelope.stall_airspeed_kt": flight.limits.stall_setting_kt,
        "guidance.mode": "hold",
    }
    text = without_section(configuration(flight.aircraft), "guidance")
    if flight.pattern is not None:
        values["guidance.mode"] = "timed-pattern"
        values |= {f"guidance.{key}": value for key, value in asdict(flight.pattern).items()}
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
    without = MEASURED if by_raw else frozenset()
    conditions = Conditions(
        levels=levels,
        sensor_delay_ticks=flight.sensor_delay_ticks,
        receiver=None if by_raw else flight.receiver,
        actuation=flight.actuation,
        gust=mover(flight.gusts, lambda: plant.time_s - engaged_s[0]) if flight.gusts else None,
        raw_sensors=sensors,
        calibration=None if sensors is None else calibrate(sensors, seed, FIELD_UT),
        raw_fault=falsify,
        without=without | {"gnss"} if by_raw and not flight.has_receiver else without,
        biases=flight.biases,
        trim=flight.measures_trim,
        position=flight.measures_position and not by_raw,
    )
    settings = Settings(aircraft=flight.aircraft, seed=seed, noise=not by_raw)
    rig = LockstepRig(settings, plant, fcc.Machine(config_of(flight)), conditions)
    errors = flight.errors()
    faults = Faults(lambda: rig.time_s, lambda more: rig.set_faults([*errors, *more]), seed)
    rig.set_faults(errors)
    rig.prepare()
    if by_raw:
        rig.fly_to(RAW_STANDBY_S)
    _engage(rig)
    engaged_s[0] = rig.time_s
    if flight.fault is not None:
        put_in(flight.fault, faults, by_raw=by_raw)
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


def _fly(rig: LockstepRig, flight: Flight) -> Flown:
    """Fly to the end, or until the controls are released or the ground is reached."""
    machine, plant, engaged_s = rig.machine, rig.plant, rig.time_s
    first_m = machine.setpoints.altitude_m
    rows: list[tuple[float, ...]] = []
    faults: list[tuple[float, frozenset[str]]] = [(0.0, frozenset())]
    fault = flight.fault
    stops_s = fault.begins_s if fault is not None and fault.what == ENGINE_OUT else math.inf

    def is_over() -> bool:
        shown = _shown(rig, flight)
        ordered = machine.setpoints
        rows.append(
            (
                *(shown.heading_rad, shown.altitude_m, shown.airspeed_mps),
                *(ordered.heading_rad, ordered.altitude_m, ordered.airspeed_mps),
            )
        )
        if rig.time_s - engaged_s >= stops_s:
            plant.fail_engines()
        now = frozenset(machine.faults)
        if now != faults[-1][1]:
            faults.append((rig.time_s - engaged_s, now))
        return not rig.holds_control or not plant.fdm["position/h-agl-ft"] > GROUND_FT

    changes_s, refused = [], []
    for order in (*flight.orders, None):
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
                changes_s.append(order.time_s)
            except (fcc.Error, ValueError) as error:
                refused.append(f"{order.time_s:.0f} s: {error}")
    degrees = np.array([math.degrees(1.0), 1.0 / FT_TO_M, 1.0 / KT_TO_MPS] * 2)
    columns = (np.array(rows) * degrees).T
    since = [replace(event, time_s=event.time_s - engaged_s) for event in rig.events]
    alarms = alarms_of(since, faults, rig.time_s - engaged_s)
    return Flown(
        shown=dict(zip(HELD, columns[:3], strict=True)),
        ordered=dict(zip(HELD, columns[3:], strict=True)),
        changes_s=LEGS_S if flight.pattern else tuple(changes_s),
        refused=tuple(refused),
        alarms=tuple(_followed(alarm, rig.truth().since(engaged_s)) for alarm in alarms),
    )


def _shown(rig: LockstepRig, flight: Flight) -> State | fcc.Estimate:
    """Return what the sensors show; of raw sensors, what navigation makes of it."""
    if flight.bounds.raw_sensors is not None or rig.measured is None:
        return rig.machine.estimate
    return rig.measured


def _command(machine: fcc.Machine, order: Order, from_m: float) -> None:
    machine.command(
        heading_rad=None if order.heading_deg is None else math.radians(order.heading_deg),
        pressure_altitude_m=(None if order.climb_ft is None else from_m + order.climb_ft * FT_TO_M),
        airspeed_mps=None if order.airspeed_kt is None else order.airspeed_kt * KT_TO_MPS,
    )


def _followed(alarm: Alarm, truth: Truth) -> Alarm:
    """Return it with what followed."""
    after = truth.since(float(truth["time_s"][0]) + alarm.begins_s)
    lowest_ft = float(np.min(after["altitude_ft"]))
    return replace(alarm, lowest_ft=lowest_ft, into_ground=hits_ground(after))
