"""Flies the suite's cases in parallel processes and judges them."""

from __future__ import annotations

import hashlib
import math
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..lockstep import Scenario, fly
from ..motion import LEAST, motion
from ..pattern import TimedPattern
from ..peer import fly_peer
from ..score import LegScore, Score, worst
from ..truth import Truth
from ..workers import local_workers
from .limits import broken
from .matrix import Case


@dataclass(frozen=True)
class Outcome:
    """The result of a case."""

    case: Case
    figures: dict[str, float | None]
    """By the names in `limits.UNITS`."""
    score: Score | None
    """None if the flight ended before its legs did."""
    broken: tuple[str, ...]
    """Limits exceeded, as text; or the reason why the case could not be flown."""
    digest: str
    """Of every bit of the flight: equal for equal flights."""
    simulated_s: float
    cpu_s: float
    """Processor time of flying and scoring, including trimming."""

    def document(self) -> dict[str, Any]:
        """Return it for JSON."""
        return {
            "name": self.case.name,
            "group": self.case.group,
            "aircraft": self.case.scenario.aircraft,
            "seeds": list(self.case.seeds),
            "figures": self.figures,
            "limits": dict(self.case.limits),
            "broken": list(self.broken),
            "legs": self.score["legs"] if self.score else [],
            "digest": self.digest,
            "simulated_s": self.simulated_s,
            "cpu_s": self.cpu_s,
        }


def fly_case(case: Case) -> Outcome:
    """Fly one case and judge it. If it cannot be flown, that is an outcome, not an exception."""
    began_s = time.process_time()
    try:
        flights = [_fly(case, seed) for seed in case.seeds]
    except (ValueError, RuntimeError, ArithmeticError) as error:
        reason = f"not flown to its end: {error}"
        return Outcome(case, {}, None, (reason,), "", 0.0, time.process_time() - began_s)
    figures = _figures(case.scenario, flights)
    digest = hashlib.sha256()
    for _, truth in flights:
        digest.update(truth.table().tobytes())
    return Outcome(
        case=case,
        figures=figures,
        score=_together(flights),
        broken=tuple(broken(figures, case.limits)),
        digest=digest.hexdigest(),
        simulated_s=sum(float(truth["time_s"][-1]) for _, truth in flights),
        cpu_s=time.process_time() - began_s,
    )


def fly_all(cases: Sequence[Case], workers: int | None = None) -> Iterator[Outcome]:
    """Fly cases in `workers` processes (one for each processor by default).

    Yields the outcomes of the longest flights first. Each flight depends only on its case, so the
    number of processes does not change it.
    """
    with local_workers(fly_case, workers) as fly_each:
        # The longest first, so that no process is left with one at the end.
        yield from fly_each(sorted(cases, key=_duration_s, reverse=True))


def _duration_s(case: Case) -> float:
    return case.scenario.pattern.duration_s(case.scenario.legs) * len(case.seeds)


def _fly(case: Case, seed: int) -> tuple[Score, Truth]:
    scenario = replace(case.scenario, seed=seed)
    if case.is_peer:
        return fly_peer(scenario.legs, seed, scenario.pattern)
    return fly(scenario)


def _together(flights: Sequence[tuple[Score, Truth]]) -> Score:
    legs = [leg for flown, _ in flights for leg in flown["legs"]]
    return {"legs": legs, "worst": worst(legs)}


def _figures(scenario: Scenario, flights: Sequence[tuple[Score, Truth]]) -> dict[str, float | None]:
    together = _together(flights)
    legs = together["legs"]
    figures: dict[str, float | None] = dict(together["worst"].items())  # type: ignore[arg-type]
    unsettled = sum(leg["heading_settle_s"] is None for leg in legs)
    holds = [_hold(scenario, truth) for _, truth in flights]
    motions = [_motion(scenario, truth) for _, truth in flights]
    for name in motions[0]:
        worst_of = min if name in LEAST else max
        figures[name] = worst_of(moved[name] for moved in motions)
    return figures | {
        "unsettled_share": unsettled / len(legs),
        "mean_altitude_rms_ft": float(np.mean([leg["altitude_rms_ft"] for leg in legs])),
        "turned_back_deg": max(_turned_back_deg(scenario, truth) for _, truth in flights),
        "hold_heading_error_deg": max(hold["heading_rms_deg"] for hold in holds),
        "hold_altitude_error_ft": max(hold["altitude_rms_ft"] for hold in holds),
    }


def _turned_back_deg(scenario: Scenario, truth: Truth) -> float:
    """Return how far the heading goes back against the direction of the turns, once they began."""
    time_s = truth["time_s"] - truth["time_s"][0]
    turned_deg = np.degrees(np.unwrap(np.radians(truth["heading_deg"])))
    turning = (
        math.copysign(1.0, scenario.pattern.turn_deg) * turned_deg[time_s > scenario.pattern.hold_s]
    )
    return float(np.max(np.maximum.accumulate(turning) - turning))


def _motion(scenario: Scenario, truth: Truth) -> dict[str, float]:
    start_s = float(truth["time_s"][0])
    legs = scenario.pattern.legs(scenario.legs, start_s, truth.captured_at(start_s))
    return motion(truth, legs)


def _hold(scenario: Scenario, truth: Truth) -> LegScore:
    """Score the end of the hold before the first leg."""
    start_s, hold_s = float(truth["time_s"][0]), scenario.pattern.hold_s
    hold = TimedPattern(hold_s=0.0, leg_s=hold_s, turn_deg=0.0, climb_ft=0.0)
    return truth.score(hold, 1, start_s)["worst"]
