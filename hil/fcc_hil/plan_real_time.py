"""A flight plan flown by the daemon: in real time, over X-Plane's protocol.

The stand-in measures attitude, position and height above the ground, as X-Plane does. The score is
computed from its true state; of the daemon's recording only what it flew when: item, course of the
path, and demands.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import fcc
import numpy as np

from . import clearance, plan_file, plan_flight, plan_score, plan_start
from .daemon_rig import DaemonRig
from .flown_plan import FlownPlan, go_arounds, of_truth
from .fly import progress_line
from .plan_flight import PlanConditions
from .rig import FlightError
from .settings import Settings
from .units import STANDARD_INHG

_ENGAGE_S = 3.0
_STEADY_S = 5.0
"""Before the switch goes on."""
_LINE_S = 1.0


def fly(
    plan: Path,
    conditions: PlanConditions,
    fccd: Path,
    scratch: Path,
    notify: Callable[[str], None],
) -> tuple[plan_score.PlanScore, FlownPlan]:
    """Fly a plan to its end; return its score and the flight.

    It begins as in lockstep (`plan_flight.fly`). The recording stays in the folder `scratch`.
    Raises FlightError, and ValueError for a plan that is none.
    """
    read = plan_file.read(plan)
    simulator = Settings(
        aircraft=conditions.aircraft,
        seed=conditions.seed,
        weather=conditions.weather,
        terrain=conditions.terrain,
        # The plan's altitudes are those of the daemon's altimeter setting.
        qnh_inhg=STANDARD_INHG,
    )
    text = plan_flight.configuration(plan, "measured", conditions.weather.wind_kt)
    text += plan_flight.terrain_section(conditions) + conditions.config
    rig = DaemonRig(fccd, plan_start.settings(read, simulator), text, scratch)
    try:
        rig.prepare()
        rig.fly_to(rig.time_s + _STEADY_S)
        rig.set_switch(on=True)
        engaged_at_s = rig.time_s
        rig.fly_to(engaged_at_s + _ENGAGE_S, lambda: rig.holds_control)
        if not rig.holds_control:
            raise FlightError(f"not engaged; the messages of fccd:\n{rig.log}")
        reached = _watch(rig, read, engaged_at_s, notify)
        truth = rig.truth().since(engaged_at_s)
        recordings = rig.save_recording(scratch / "flight.mcap")
    finally:
        rig.close()
    flown, modes = _with_demands(of_truth(truth), recordings)
    score = plan_score.score(read, flown, reached, plan_flight.LOITER_M, go_arounds(modes))
    if conditions.terrain is not None:
        score = replace(score, terrain=clearance.score(flown, modes))
    return score, flown


def _watch(
    rig: DaemonRig, plan: plan_file.PlanFile, engaged_at_s: float, notify: Callable[[str], None]
) -> dict[int, float]:
    """Wait for the end of the plan; return when each item was reached."""
    last = max(item.number for item in plan.items if item.has_place)
    reached: dict[int, float] = {}
    seen, next_line_s = 0, 0.0

    def has_ended() -> bool:
        nonlocal seen, next_line_s
        for event in rig.events[seen:]:
            if found := plan_flight.REACHED.search(event.text):
                reached[int(found[1])] = event.time_s
        seen = len(rig.events)
        if time.monotonic() >= next_line_s:
            next_line_s = time.monotonic() + _LINE_S
            where = f"item {max(reached, default=0)} reached"
            notify(progress_line(rig.progress, engaged_at_s, where))
        return not rig.holds_control or rig.time_s > reached.get(last, np.inf) + plan_flight.AFTER_S

    rig.fly_to(engaged_at_s + plan_flight.LONGEST_S, has_ended)
    if not rig.holds_control:
        raise FlightError(f"control was given back; the messages of fccd:\n{rig.log}")
    return reached


def _with_demands(flown: FlownPlan, recordings: list[Path]) -> tuple[FlownPlan, list[str]]:
    """Add what the daemon recorded of its demands, by the simulator's clock, and its modes."""
    opened = [fcc.Recording(path) for path in recordings]
    records = np.concatenate([np.asarray(recording.records) for recording in opened])
    records = records[np.isfinite(records["plant_time_s"])]
    if not len(records):
        raise FlightError("the recording has no time of the simulator")
    at = np.searchsorted(records["plant_time_s"], flown.time_s, side="right") - 1
    then = records[np.maximum(at, 0)]
    names: dict[int, str] = opened[0].columns["desired_guidance_mode"]["codes"]
    demanded = replace(
        flown,
        item=then["desired_guidance_item"].astype(np.float64),
        course_rad=then["desired_course_rad"],
        airspeed_demand_mps=then["desired_airspeed_mps"],
        altitude_demand_m=then["desired_altitude_above_reference_m"],
    )
    # A recording's names have spaces, those of the module have none.
    return demanded, [names[code].replace(" ", "-") for code in then["desired_guidance_mode"]]
