"""Flies a candidate's flights for the search, in processes or on a Dask cluster."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass

from .. import workers
from ..lockstep import Scenario
from .cost import flight_cost


@dataclass(frozen=True)
class Flight:
    """A flight to be flown by a worker."""

    scenario: Scenario
    weights: Mapping[str, float]


FlyAll = Callable[[Sequence[Flight]], Iterator[float]]
"""Flies all, and yields their costs in order."""


def _cost(flight: Flight) -> float:
    return flight_cost(flight.scenario, flight.weights)


def local_workers(count: int | None = None) -> AbstractContextManager[FlyAll]:
    """Return processes of this machine, by default one for each processor."""
    return workers.local_workers(_cost, count)


def on_dask(address: str, timeout_s: float = 10.0) -> AbstractContextManager[FlyAll]:
    """Return the workers of a Dask cluster. Raises ValueError as `workers.on_dask` does."""
    return workers.on_dask(_cost, address, timeout_s)
