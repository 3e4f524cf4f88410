"""The benchmark: the autopilot and JSBSim's own on the same task, in one run."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from .lockstep import Scenario, fly
from .peer import PEER_AIRCRAFT, fly_peer
from .plant import Weather
from .score import Score

_AIRCRAFT = ("c172p", "c172x")
_DELAY_TICKS = 1
TUNING_SEEDS = (
    *(1, 2, 3, 101, 102),
    *range(300, 308),
    *range(500, 516),
    *range(900, 910),
    *range(2026, 2031),
)
"""Seeds used for tuning; the benchmark uses others."""
SEED = 11
_TURBULENCE = Weather(turbulence_severity=3)


def scenarios(legs: int) -> Iterator[tuple[str, Scenario]]:
    """Yield each scenario with its name."""
    for aircraft in _AIRCRAFT:
        calm = Scenario(aircraft=aircraft, legs=legs, seed=SEED)
        noisy = replace(calm, noise=True, delay_ticks=_DELAY_TICKS)
        yield f"fccd, {aircraft}, calm", calm
        yield f"fccd, {aircraft}, noise, 25 ms late", noisy
        yield f"fccd, {aircraft}, noise, 100 ms late", replace(noisy, delay_ticks=4)
        yield f"fccd, {aircraft}, and turbulence 3", replace(noisy, weather=_TURBULENCE)


def run(legs: int) -> Iterator[tuple[str, Score]]:
    """Fly the peer, then every scenario; yield each score as it comes."""
    yield f"JSBSim's own autopilot, {PEER_AIRCRAFT}, calm", fly_peer(legs, SEED)[0]
    for name, scenario in scenarios(legs):
        yield name, fly(scenario)[0]
