"""Flies in processes of this machine, or on a Dask cluster.

Both fly the same flights and return the same costs in the same order.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing import get_context

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


@contextmanager
def local_workers(count: int | None = None) -> Iterator[FlyAll]:
    """Yield processes of this machine, by default one for each processor."""
    count = count or os.cpu_count() or 1
    if count == 1:
        yield lambda flights: map(_cost, flights)
        return
    with ProcessPoolExecutor(count, mp_context=get_context("spawn")) as pool:
        yield lambda flights: pool.map(_cost, flights)


@contextmanager
def on_dask(address: str, timeout_s: float = 10.0) -> Iterator[FlyAll]:
    """Yield the workers of a Dask cluster, which also need this package and `fcc`.

    Raises ValueError if Dask is not installed or there is no answer at the address.
    """
    try:
        from distributed import Client  # noqa: PLC0415 - only where it is asked for
    except ImportError:
        raise ValueError(
            "Dask is not installed: pip install 'fcc-hil[dask]', or omit --dask"
        ) from None
    try:
        client = Client(address, timeout=timeout_s)
    except (OSError, TimeoutError, ValueError) as error:
        raise ValueError(
            f"no Dask scheduler at {address}: {error}; start one with `dask scheduler`"
        ) from None
    try:
        # The same flight has the same cost, but results must not be cached.
        yield lambda flights: iter(client.gather(client.map(_cost, flights, pure=False)))
    finally:
        client.close()
