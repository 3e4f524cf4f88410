"""A flight plan with JSBSim in lockstep, by raw sensors with a satellite receiver of 5 Hz.

python -m fcc_hil plan --plan config/plans/twelve-legs.waypoints --wind 20 --wind-from 270
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import fcc
import numpy as np

from . import clearance, plan_file, plan_score, plan_start
from .flown_plan import FlownPlan, go_arounds, of_truth
from .lockstep_rig import Conditions, LockstepRig
from .plant import Weather
from .raw_calibration import calibrate
from .raw_flight import MEASURED, RAW_STANDBY_S
from .raw_sensors import FIELD_UT
from .rig import FlightError
from .standin import Settings

SENSORS = "board"
RUNWAY_STANDBY_S = 30.0
"""On its wheels; navigation settles."""
LOITER_M = 800.0
REACHED = re.compile(r"item (\d+) of the plan is reached")
LONGEST_S = 3600.0
AFTER_S = 5.0
_CALM = Weather()


def configuration(plan: Path, navigation: str, wind_kt: float, *, mode: str = "plan") -> str:
    """Return the text of a configuration that flies a plan, or has one and flies otherwise."""
    north, east, down = FIELD_UT
    file = str(plan.resolve()).replace("\\", "\\\\").replace('"', '\\"')
    return (
        f'[guidance]\nmode = "{mode}"\n'
        f'[plan]\nfile = "{file}"\nwind_kt = {max(wind_kt, 0.0):.1f}\n'
        f"loiter_radius_m = {LOITER_M:.1f}\n"
        f'[navigation]\nmethod = "{navigation}"\nmagnetic_field_ut = [{north}, {east}, {down}]\n'
    )


@dataclass(frozen=True)
class PlanConditions:
    """How a plan is flown."""

    aircraft: str = "c172p"
    weather: Weather = _CALM
    seed: int = 1
    sensors: str = SENSORS
    """Of `fcc.RawSensors`."""
    without: frozenset[str] = frozenset()
    """Readings that there are not."""
    config: str = ""
    """Added to the configuration."""
    raw_fault: Callable[[fcc.Measurements, float], None] | None = None
    """Called in each tick with the raw readings, and the time in s, to falsify them."""
    terrain: Path | None = None
    """The folder of elevation tiles that are the ground, and that the autopilot has, too."""


def terrain_section(conditions: PlanConditions) -> str:
    """Return the section that gives the autopilot the ground, if it is that of tiles."""
    if conditions.terrain is None:
        return ""
    return f"[terrain]\nfolder = {json.dumps(str(conditions.terrain.resolve()))}\n"


def fly(
    plan: Path,
    conditions: PlanConditions,
    *,
    longest_s: float = LONGEST_S,
    watch: Callable[[LockstepRig], bool] | None = None,
) -> tuple[plan_score.PlanScore, FlownPlan]:
    """Fly a plan to its end; return its score and the flight.

    The aircraft begins in level flight over the plan's home, towards its first place, or on its
    wheels there if the plan begins with a take-off. `watch` is called in each tick once it is
    engaged, and ends the flight. Raises FlightError, ValueError for a plan that is none, and
    fcc.ConfigError for one that cannot be flown.
    """
    seed, sensors = conditions.seed, conditions.sensors
    read = plan_file.read(plan)
    takes_off = plan_start.takes_off(read)
    text = configuration(plan, "kalman", conditions.weather.wind_kt)
    machine = fcc.Machine(text + terrain_section(conditions) + conditions.config)
    plant = plan_start.plant(
        read, conditions.aircraft, seed=seed, weather=conditions.weather, terrain=conditions.terrain
    )
    between = Conditions(
        raw_sensors=sensors,
        calibration=calibrate(sensors, seed, FIELD_UT),
        without=MEASURED | conditions.without,
        raw_fault=conditions.raw_fault,
    )
    settings = Settings(aircraft=conditions.aircraft, seed=seed)
    rig = LockstepRig(settings, plant, machine, between)
    rig.engage(after_s=RUNWAY_STANDBY_S if takes_off else RAW_STANDBY_S)
    demands: list[tuple[float, ...]] = []
    begun_s = rig.time_s
    reached: dict[int, float] = {}
    seen = 0
    last = max(item.number for item in read.items if item.has_place)
    end_s = math.inf
    modes: list[str] = []

    def keep() -> bool:
        nonlocal seen, end_s
        points = machine.setpoints
        demands.append(
            (
                points.guidance_item,
                points.course_rad,
                points.airspeed_mps,
                points.altitude_above_reference_m,
            )
        )
        modes.append(points.guidance_mode)
        for event in rig.events[seen:]:
            if found := REACHED.search(event.text):
                reached[int(found[1])] = event.time_s
        seen = len(rig.events)
        if last in reached:
            end_s = min(end_s, reached[last] + AFTER_S)
        is_over = watch is not None and watch(rig)
        return is_over or rig.time_s >= end_s or not rig.holds_control

    rig.fly_to(rig.time_s + longest_s, keep)
    if not rig.holds_control:
        raise FlightError("; ".join(event.text for event in rig.events[-3:]))
    item, course_rad, airspeed_mps, altitude_m = np.array(demands).T
    flown = replace(
        of_truth(rig.truth().since(begun_s + 0.5 * machine.period_s)),
        item=item,
        course_rad=course_rad,
        airspeed_demand_mps=airspeed_mps,
        altitude_demand_m=altitude_m,
    )
    score = plan_score.score(read, flown, reached, LOITER_M, go_arounds(modes))
    if conditions.terrain is not None:
        score = replace(score, terrain=clearance.score(flown, modes))
    return score, flown
