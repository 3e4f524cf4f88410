"""The peer: JSBSim's own c172x autopilot, flown through the same pattern and scored alike.

Its model carries a heading hold and an altitude hold (`c172ap.xml`), each with a
set point and a switch; both are on from engagement. They act at the flight model's
own 120 Hz on the true state, with no delay, so the peer has every advantage of
place. It limits its bank to 30 degrees itself. It has no autothrottle: although its
interface names an airspeed set point, no component reads it, so the throttle stays
at trim, as a pilot leaves it who has only these two modes.
"""

from __future__ import annotations

from .pattern import TimedPattern
from .plant import Plant
from .score import Score
from .state import Controls
from .truth import STEPS_PER_ROW, Truth, row
from .units import FT_TO_M

PEER_AIRCRAFT = "c172x"


def fly_peer(
    legs: int = 8, seed: int = 1, pattern: TimedPattern | None = None
) -> tuple[Score, Truth]:
    """Fly the pattern with JSBSim's autopilot in lockstep; return its score and the truth."""
    pattern = pattern or TimedPattern()
    plant = Plant(PEER_AIRCRAFT, seed=seed)
    rows = [row(plant.state(), plant.controls)]
    captured = Truth(rows).captured_at(plant.time_s)
    engaged_at_s = plant.time_s
    fdm = plant.fdm
    # Its altitude is above the ground, which is at sea level here.
    above_ground_ft = (plant.state().height_m - plant.state().elevation_m) / FT_TO_M
    fdm["ap/heading_hold"] = 1
    fdm["ap/altitude_hold"] = 1
    while plant.time_s < engaged_at_s + pattern.duration_s(legs):
        aim = pattern.set_points(plant.time_s - engaged_at_s, captured)
        fdm["ap/heading_setpoint"] = aim.heading_deg
        fdm["ap/altitude_setpoint"] = aim.altitude_ft + above_ground_ft
        plant.step(STEPS_PER_ROW)
        rows.append(row(plant.state(), _commanded(plant)))
    truth = Truth(rows)
    return truth.score(pattern, legs, engaged_at_s), truth


def _commanded(plant: Plant) -> Controls:
    """Return what the autopilot commands, which it adds to the pilot's centred controls."""
    return Controls(
        elevator=-plant.fdm["ap/elevator_cmd"],
        aileron=plant.fdm["ap/aileron_cmd"],
        throttle=plant.trim.throttle,
    )
