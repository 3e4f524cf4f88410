"""The cost of a flight: a weighted sum of its figures, each relative to a good value.

A figure counts as two parts its mean over the legs and one part the worst leg, divided by a good
value for a light aircraft; the times to settle by the duration of the leg, twice that if a leg
never settles. Movement is the travel of elevator, aileron and rudder per second, relative to 0.5 of
their range: without it, the search gains a little accuracy at the price of oscillating surfaces.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from ..lockstep import Scenario, fly
from ..motion import movement_per_s
from ..score import Score
from ..truth import Truth

_GOOD = MappingProxyType(
    {
        "heading_overshoot_deg": 0.5,
        "heading_rms_deg": 0.4,
        "altitude_overshoot_ft": 2.0,
        "altitude_rms_ft": 1.0,
        "turn_loss_ft": 2.0,
        "airspeed_error_kt": 3.0,
        "lateral_acceleration_g": 0.05,
    }
)
_SETTLING = ("heading_settle_s", "altitude_settle_s")
_MOVEMENT = "movement"
_GOOD_MOVEMENT_PER_S = 0.5

NOT_FLOWN = 1_000.0
"""The cost of a flight that is not completed, or cannot be started."""

Weights = Mapping[str, float]


@dataclass(frozen=True)
class Cost:
    """Weights of the figures; a figure without a weight does not count."""

    name: str
    weights: Weights


# Plain dictionaries, because they are sent to the flying processes.
_EVEN: Weights = dict.fromkeys((*_SETTLING, *_GOOD, _MOVEMENT), 1.0)

COSTS = MappingProxyType(
    {
        "even": Cost("even", _EVEN),
        "accurate": Cost("accurate", {**_EVEN, "altitude_rms_ft": 4.0, "heading_rms_deg": 2.0}),
        "gentle": Cost("gentle", {**_EVEN, "lateral_acceleration_g": 3.0, _MOVEMENT: 4.0}),
    }
)
"""Costs by name."""


def cost_of(text: str) -> Cost:
    """Return a cost by its name in COSTS, or from weights, as in `altitude_rms_ft=2,movement=1`.

    Raises ValueError with the known names.
    """
    if text in COSTS:
        return COSTS[text]
    weights = {}
    for part in text.split(","):
        name, equals, number = part.partition("=")
        if name not in _EVEN or not equals:
            raise ValueError(
                f"cost '{text}': give one of {', '.join(COSTS)}, or weights of "
                f"{', '.join(_EVEN)}, as in altitude_rms_ft=2,movement=1"
            )
        try:
            weights[name] = float(number)
        except ValueError:
            weights[name] = float("nan")
        if not 0.0 <= weights[name] < float("inf"):
            raise ValueError(f"cost: the weight of {name} is '{number}': give a number from 0 up")
    if not any(weights.values()):
        raise ValueError("cost: every weight is 0: give at least one above")
    return Cost(text, weights)


@dataclass(frozen=True)
class Flight:
    """A flight of a candidate, for a worker."""

    scenario: Scenario
    weights: Weights


def flight_cost(flight: Flight) -> float:
    """Fly; return the cost. A flight that fails costs NOT_FLOWN."""
    scenario = flight.scenario
    try:
        flown, truth = fly(scenario)
    except (ValueError, RuntimeError, ArithmeticError):
        return NOT_FLOWN
    total = weighed(flown, truth, scenario.pattern.leg_s, flight.weights)
    return min(total, NOT_FLOWN) if np.isfinite(total) else NOT_FLOWN


def weighed(flown: Score, truth: Truth, leg_s: float, weights: Weights) -> float:
    """Return the weighted sum of a flight's figures."""
    total = 0.0
    for name, weight in weights.items():
        if name == _MOVEMENT:
            total += weight * movement_per_s(truth) / _GOOD_MOVEMENT_PER_S
            continue
        good = leg_s if name in _SETTLING else _GOOD[name]
        values = [dict(leg)[name] for leg in flown["legs"]]
        known = [value if isinstance(value, float) else 2.0 * leg_s for value in values]
        total += weight * (2.0 * sum(known) / len(known) + max(known)) / 3.0 / good
    return float(total)
