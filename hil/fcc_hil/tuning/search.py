"""Search for gains: CMA-ES (Hansen 2016) over the logarithm of each.

Half a gain is as far off as twice the gain, and gains that depend on each other are found together.
Every candidate flies the same seeds, so candidates differ only by their gains; the search itself is
seeded, so the same task finds the same gains.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ..configurations import configuration, pattern_of, value_of, with_values
from ..lockstep import Scenario
from ..plant import Weather
from .cost import COSTS, Cost, Flight
from .identify import first_guess

SCALE_KEYS = tuple(
    f"autopilot.scale.{name}" for name in ("elevator", "aileron", "rudder", "throttle", "pace")
)
"""Searched by default: the scale of the gains."""

_FIRST_STEP = 0.25
"""One sigma of the first candidates, in the logarithm: a quarter more or less."""
_DIGITS = 4


@dataclass(frozen=True)
class Task:
    """A search."""

    aircraft: str
    config: str | None = None
    """The initial configuration; by default the aircraft's own, or stock gains."""
    keys: Sequence[str] = SCALE_KEYS
    """Numbers of the configuration to search, by dotted key, each above 0."""
    cost: Cost = field(default_factory=lambda: COSTS["even"])
    seeds: Sequence[int] = (1, 2)
    evaluations: int = 120
    """How many candidates to fly, each once for each seed."""
    legs: int = 2
    turbulence: int = 0
    """Severity after MIL-F-8785C, 0 calm."""


@dataclass(frozen=True)
class Found:
    """The best configuration found."""

    config: str
    before: float
    """Cost of the given configuration; means over the seeds."""
    guessed: float
    """Cost of the first guess from the measured responses."""
    after: float
    values: dict[str, float]
    evaluations: int


FlyAll = Callable[[Sequence[Flight]], Iterator[float]]
"""Flies all, and yields their costs in order."""
Notify = Callable[[int, float], None]
"""Called after each round with the number of candidates flown and the lowest cost so far."""


def tune(task: Task, fly_all: FlyAll, notify: Notify = lambda _flown, _least: None) -> Found:
    """Search; return the best configuration, which is never worse than the given one.

    Raises ValueError for an invalid task.
    """
    _check(task)
    import cma  # noqa: PLC0415 - the extra `tune`

    given = task.config if task.config is not None else configuration(task.aircraft)
    is_scaled = any(value_of(given, key, 0.0) for key in SCALE_KEYS)
    begun = given if is_scaled else first_guess(task.aircraft, given)
    begun = with_values(begun, {key: _value(begun, key) for key in task.keys})
    start = np.log([value_of(begun, key, 1.0) for key in task.keys])

    before, guessed = _costs(task, [given, begun], fly_all)
    least, best = min((before, given), (guessed, begun))
    flown = 2
    search = cma.CMAEvolutionStrategy(
        start, _FIRST_STEP, {"seed": 1, "verbose": -9, "maxfevals": task.evaluations}
    )
    while flown < task.evaluations and not search.stop():
        points = search.ask()
        configs = [with_values(begun, _values(task.keys, point)) for point in points]
        costs = _costs(task, configs, fly_all)
        search.tell(points, costs)
        flown += len(points)
        least, best = min((least, best), *zip(costs, configs, strict=True))
        notify(flown, least)
    return Found(
        config=_complete(best),
        before=before,
        guessed=guessed,
        after=least,
        values={key: _value(best, key) for key in task.keys},
        evaluations=flown,
    )


def scenarios(task: Task, config: str) -> list[Scenario]:
    """Return the flights of one candidate: noisy sensors, 25 ms late, one for each seed."""
    one = Scenario(
        aircraft=task.aircraft,
        legs=task.legs,
        noise=True,
        delay_ticks=1,
        weather=Weather(turbulence_severity=task.turbulence),
        pattern=pattern_of(config),
        config=config,
    )
    return [replace(one, seed=seed) for seed in task.seeds]


def _check(task: Task) -> None:
    if not task.seeds:
        raise ValueError("no seeds: give at least one")
    if task.evaluations < 3:
        raise ValueError(f"{task.evaluations} evaluations: give at least 3")
    if not task.keys:
        raise ValueError("nothing to search: give at least one key")
    try:
        import cma  # noqa: F401, PLC0415 - the extra `tune`
    except ImportError:
        raise ValueError("the optimiser is not installed: pip install 'fcc-hil[tune]'") from None


def _value(config: str, key: str) -> float:
    value = value_of(config, key, 1.0 if key in SCALE_KEYS else 0.0)
    if value <= 0.0:
        raise ValueError(
            f"{key}: the search needs an initial value above 0: put one into the configuration"
        )
    return value


def _values(keys: Sequence[str], point: Sequence[float]) -> dict[str, float]:
    return {key: float(f"{math.exp(x):.{_DIGITS}g}") for key, x in zip(keys, point, strict=True)}


def _costs(task: Task, configs: Sequence[str], fly_all: FlyAll) -> list[float]:
    """Return each configuration's mean cost over the seeds."""
    flights = [
        Flight(scenario, task.cost.weights)
        for config in configs
        for scenario in scenarios(task, config)
    ]
    costs = list(fly_all(flights))
    each = len(task.seeds)
    return [sum(costs[i : i + each]) / each for i in range(0, len(costs), each)]


def _complete(config: str) -> str:
    """Return a configuration that the daemon accepts: with an aircraft's section."""
    sections = ("[x-plane]", "[built-in]")
    if any(section in config for section in sections):
        return config
    return "[x-plane]\n\n" + config
