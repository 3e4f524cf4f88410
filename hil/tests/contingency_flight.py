"""Flights of a plan with JSBSim by raw sensors in which something is lost on the way.

The position for a while or for good, the commander, the alternator. Where it happens, the legs and
the wind are drawn.
"""

from __future__ import annotations

import math
import tempfile
from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path

import drawn_plan
import fcc
import numpy as np
from drawn_plan import LATITUDE_DEG, LONGITUDE_DEG, Drawn

from fcc_hil import plan_flight
from fcc_hil.lockstep_rig import LockstepRig
from fcc_hil.plan_flight import PlanConditions
from fcc_hil.plan_score import LandingScore, PlanScore
from fcc_hil.plant import Weather
from fcc_hil.raw_faults import lost
from fcc_hil.rig import FlightError
from fcc_hil.tangent_plane import Plane
from fcc_hil.units import FT_TO_M

ALTITUDE_M = 3_000.0 * FT_TO_M
CIRCLE_M = 800.0
"""The radius of the circle around home."""
_LEG_M = 6_000.0
_ON_CIRCLE = 1.1
_SETTLES_S, _AROUND_S = 30.0, 110.0
"""Onto the circle, and around it once at 100 kt, in 20 kt."""
_LONGEST_S = 1_500.0
_CAPACITY_AH = 1.5
"""Of an aged battery: 15 A empty it in six minutes."""
_APPROACH_M, _APPROACH_HEIGHT_M = 6_000.0, 250.0
_LOW_M, _FAR = 450.0, (-31_000.0, 0.0)
"""The altitude from which it lands, and a place that it does not come to."""
_DESCENDS_S = 60.0
_HOME = Plane(math.radians(LATITUDE_DEG), math.radians(LONGITUDE_DEG))


@dataclass(frozen=True)
class Lost:
    """What is drawn: three legs, the wind, and when it happens."""

    legs: tuple[Drawn, ...]
    weather: Weather
    after_s: float
    """Of being engaged."""


def draw(seed: int, wind_kt: float) -> Lost:
    """Draw legs of 6 km from home with turns of 30 to 90 degrees to either side."""
    drawn = np.random.default_rng(seed)
    bearing_deg, wind_from_deg = drawn.uniform(0.0, 360.0, 2)
    turns_deg = drawn.uniform(30.0, 90.0, 2) * drawn.choice([-1.0, 1.0], 2)
    places = [(0.0, 0.0)]
    for turn_deg in (0.0, *turns_deg):
        bearing_deg += turn_deg
        places.append(drawn_plan.ahead(places[-1], bearing_deg, _LEG_M))
    weather = Weather(wind_from_deg=float(wind_from_deg), wind_kt=wind_kt, turbulence_severity=2)
    legs = drawn_plan.waypoints(places[0], ALTITUDE_M, *places[1:])
    return Lost(tuple(legs), weather, float(drawn.uniform(20.0, 160.0)))


class Watch:
    """What is kept of a flight: the place that the autopilot believes, and the true one."""

    def __init__(self, lost_after_s: float) -> None:
        """Something is lost so long after the first tick."""
        self.lost_after_s = lost_after_s
        self.begun_s = math.inf
        self.rows: list[tuple[float, float, float, float, float]] = []
        """Time, error and stated uncertainty of the position, distance and believed distance from
        home, since it was lost."""
        self.modes: list[str] = []
        self.events: set[str] = set()

    @property
    def lost_s(self) -> float:
        """Return when it is lost."""
        return self.begun_s + self.lost_after_s

    def step(self, rig: LockstepRig) -> None:
        """Keep a tick."""
        self.begun_s = min(self.begun_s, rig.time_s)
        self.events = {event.text for event in rig.events}
        mode = rig.machine.setpoints.guidance_mode
        if mode not in self.modes[-1:]:
            self.modes.append(mode)
        if rig.time_s < self.lost_s:
            return
        true, believed = rig.plant.state(), rig.machine.estimate
        at = _HOME.of(
            np.array([true.latitude_rad, believed.latitude_rad]),
            np.array([true.longitude_rad, believed.longitude_rad]),
        )
        error_m, away_m = math.hypot(*(at[1] - at[0])), np.hypot(*at.T)
        self.rows.append(
            (
                rig.time_s,
                error_m,
                believed.position_uncertainty_m,
                float(away_m[0]),
                float(away_m[1]),
            )
        )


def _fly(
    legs: Iterable[Drawn],
    conditions: PlanConditions,
    watch: Watch,
    *,
    returns: bool = False,
    silence_s: float | None = None,
) -> PlanScore:
    """Fly to the last item, or, if it returns, around home once.

    `silence_s` is for how long there is no satellite navigation.
    """
    silence = lost("gnss")

    def fault(values: fcc.Measurements, time_s: float) -> None:
        if conditions.raw_fault is not None:
            conditions.raw_fault(values, time_s)
        if silence_s is not None and 0.0 <= time_s - watch.lost_s < silence_s:
            silence(values)

    arrived_s = math.inf

    def is_over(rig: LockstepRig) -> bool:
        nonlocal arrived_s
        watch.step(rig)
        if returns and watch.modes[-1] == "return" and watch.rows[-1][4] < _ON_CIRCLE * CIRCLE_M:
            arrived_s = min(arrived_s, rig.time_s)
        return rig.time_s >= arrived_s + _SETTLES_S + _AROUND_S

    with tempfile.TemporaryDirectory() as folder:
        plan = Path(folder, "drawn.waypoints")
        plan.write_text(drawn_plan.text(legs), encoding="utf-8")
        score, _ = plan_flight.fly(
            plan, replace(conditions, raw_fault=fault), longest_s=_LONGEST_S, watch=is_over
        )
    if returns and not math.isfinite(arrived_s):
        raise FlightError(f"it did not return: {', '.join(watch.modes)}")
    return score


@dataclass(frozen=True)
class Reckoned:
    """How well dead reckoning knew the place, by the truth."""

    error_m: float
    """At most, while there is no receiver."""
    of_stated: float
    """The largest share of two of the stated standard deviations that the error was."""
    stated_m: float
    """Two of them in the end."""
    off_circle_m: float
    """The largest distance from the circle around home while it is flown."""


def _reckoned(watch: Watch, lasts_s: float) -> Reckoned:
    rows = np.array(watch.rows)
    time_s, error_m, sigma_m, away_m, _ = rows.T
    silent = time_s - watch.lost_s < lasts_s
    around = time_s > time_s[-1] - _AROUND_S
    return Reckoned(
        error_m=float(error_m[silent].max()),
        of_stated=float((error_m / (2.0 * sigma_m))[silent].max()),
        stated_m=float(2.0 * sigma_m[silent][-1]),
        off_circle_m=float(np.abs(away_m[around] - CIRCLE_M).max()),
    )


def lose_position(
    seed: int, *, wind_kt: float, lasts_s: float
) -> tuple[Reckoned, PlanScore, Watch]:
    """Lose satellite navigation for a time; it returns after 30 s, and resumes the plan."""
    drawn = draw(seed, wind_kt)
    watch = Watch(drawn.after_s)
    keys = "[contingency]\nposition_lost_after_s = 30\n"
    conditions = PlanConditions(weather=drawn.weather, seed=seed, config=keys)
    score = _fly(drawn.legs, conditions, watch, silence_s=lasts_s)
    return _reckoned(watch, lasts_s), score, watch


def lose_position_for_good(seed: int, *, wind_kt: float) -> tuple[Reckoned, Watch]:
    """Lose satellite navigation; after a minute it returns home by dead reckoning."""
    drawn = draw(seed, wind_kt)
    watch = Watch(drawn.after_s)
    keys = "[contingency]\nposition_lost_after_s = 60\n"
    conditions = PlanConditions(weather=drawn.weather, seed=seed, config=keys)
    _fly(drawn.legs, conditions, watch, returns=True, silence_s=math.inf)
    return _reckoned(watch, math.inf), watch


def lose_commander(seed: int, *, wind_kt: float, promised_s: float) -> tuple[Reckoned, Watch]:
    """Promise a command within a time, and give none: it returns."""
    drawn = draw(seed, wind_kt)

    class Promise(Watch):
        is_given = False

        def step(self, rig: LockstepRig) -> None:
            if not self.is_given and rig.time_s >= self.lost_s:
                rig.machine.command(heartbeat_s=promised_s)
                self.is_given = True
            super().step(rig)

    watch = Promise(drawn.after_s)
    conditions = PlanConditions(weather=drawn.weather, seed=seed)
    _fly(drawn.legs, conditions, watch, returns=True)
    return _reckoned(watch, math.inf), watch


def use_battery(seed: int, *, wind_kt: float) -> tuple[LandingScore | None, Watch]:
    """Lose the alternator on the way out; it lands by the plan's landing.

    The voltage is that below which the handbook of a 172S warns.
    """
    drawn = draw(seed, wind_kt)

    class Alternator(Watch):
        def step(self, rig: LockstepRig) -> None:
            battery = rig.plant.battery
            battery.capacity_ah = _CAPACITY_AH
            battery.alternator_fails = rig.time_s >= self.lost_s
            super().step(rig)

    watch = Alternator(_DESCENDS_S + drawn.after_s)
    keys = '[contingency]\nbattery_voltage_v = 24.5\nbattery_low = "land"\n'
    conditions = PlanConditions(weather=drawn.weather, seed=seed, sensors="board-rtk", config=keys)
    home, first = drawn.legs[0], drawn.legs[1]
    legs = [
        replace(home, altitude_m=0.0),
        replace(first, altitude_m=_LOW_M),
        replace(first, at_m=_FAR, altitude_m=_LOW_M),
        *drawn_plan.landing(_APPROACH_M, _APPROACH_HEIGHT_M),
    ]
    score = _fly(legs, conditions, watch)
    return score.landing, watch
