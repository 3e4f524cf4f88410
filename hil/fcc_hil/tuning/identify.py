"""An aircraft's response to its controls, measured in small steps from trim.

An aircraft that responds half as much as the Cessna 172 on which the gains were tuned needs gains
twice as large: `[autopilot.scale]`, as a first guess.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from ..configurations import with_values
from ..plant import Plant
from ..state import Controls, State
from ..truth import STEPS_PER_ROW, TRUTH_HZ

REFERENCE = "c172p"

_SURFACE_STEP = 0.08
_THROTTLE_STEP = 0.1
_SURFACE_S = 0.6
_THROTTLE_S = 4.0
_LEAST, _MOST = 0.05, 20.0
"""A scale beyond these means a surface without effect; the limit is used."""


@dataclass(frozen=True)
class Answer:
    """The effect of one unit of each control after a short time, at the trimmed airspeed."""

    pitch_radps: float
    roll_radps: float
    yaw_radps: float
    acceleration_mps2: float


def answer(aircraft: str) -> Answer:
    """Measure an aircraft's responses. Raises ValueError and `TrimError` as `Plant` does."""
    return Answer(
        pitch_radps=_change(aircraft, Controls(elevator=_SURFACE_STEP), _SURFACE_S).pitch_rate_radps
        / _SURFACE_STEP,
        roll_radps=_change(aircraft, Controls(aileron=_SURFACE_STEP), _SURFACE_S).roll_rate_radps
        / _SURFACE_STEP,
        yaw_radps=_change(aircraft, Controls(rudder=_SURFACE_STEP), _SURFACE_S).yaw_rate_radps
        / _SURFACE_STEP,
        acceleration_mps2=_change(
            aircraft, Controls(throttle=_THROTTLE_STEP), _THROTTLE_S
        ).airspeed_mps
        / _THROTTLE_STEP
        / _THROTTLE_S,
    )


def _change(aircraft: str, step: Controls, seconds: float) -> State:
    """Return the change by a step of a control relative to the same flight without it."""
    plain, moved = _after(aircraft, Controls(), seconds), _after(aircraft, step, seconds)
    return replace(
        moved,
        pitch_rate_radps=moved.pitch_rate_radps - plain.pitch_rate_radps,
        roll_rate_radps=moved.roll_rate_radps - plain.roll_rate_radps,
        yaw_rate_radps=moved.yaw_rate_radps - plain.yaw_rate_radps,
        airspeed_mps=moved.airspeed_mps - plain.airspeed_mps,
    )


def _after(aircraft: str, step: Controls, seconds: float) -> State:
    plant = Plant(aircraft)
    # Downwards if there is no margin upwards.
    up = plant.trim.throttle + step.throttle <= 1.0
    throttle = plant.trim.throttle + (step.throttle if up else -step.throttle)
    plant.write(replace(step, throttle=throttle))
    plant.step(round(seconds * TRUTH_HZ) * STEPS_PER_ROW)
    state = plant.state()
    return state if up else replace(state, airspeed_mps=-state.airspeed_mps)


def first_guess(aircraft: str, config: str = "") -> str:
    """Return a configuration with the scale that follows from an aircraft's responses.

    Gains follow airspeed, so responses are compared at each aircraft's own reference airspeed,
    which is set to the trimmed one.
    """
    reference, ours = answer(REFERENCE), answer(aircraft)
    return with_values(
        config,
        {
            "autopilot.reference_airspeed_kt": Plant(aircraft).aircraft.airspeed_kt,
            "autopilot.scale.elevator": _ratio(reference.pitch_radps, ours.pitch_radps),
            "autopilot.scale.aileron": _ratio(reference.roll_radps, ours.roll_radps),
            "autopilot.scale.rudder": _ratio(reference.yaw_radps, ours.yaw_radps),
            "autopilot.scale.throttle": _ratio(reference.acceleration_mps2, ours.acceleration_mps2),
        },
    )


def _ratio(reference: float, ours: float) -> float:
    if ours * reference <= 0.0:
        return _MOST
    return float(f"{min(_MOST, max(_LEAST, reference / ours)):.3g}")
