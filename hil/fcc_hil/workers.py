"""Runs pieces of work in processes of this machine, or on a Dask cluster.

Both do the same work and return the same results in the same order, each as soon as it and those
before it are done.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import AbstractContextManager, contextmanager
from multiprocessing import get_context
from typing import TypeVar

Piece = TypeVar("Piece")
Result = TypeVar("Result")


@contextmanager
def local_workers(
    work: Callable[[Piece], Result], count: int | None = None
) -> Iterator[Callable[[Sequence[Piece]], Iterator[Result]]]:
    """Yield processes of this machine, by default one for each processor."""
    count = count or os.cpu_count() or 1
    if count == 1:
        yield lambda pieces: map(work, pieces)
        return
    # Forked children would inherit the locks of the caller's threads.
    with ProcessPoolExecutor(count, mp_context=get_context("spawn")) as pool:
        yield lambda pieces: pool.map(work, pieces)


@contextmanager
def on_dask(
    work: Callable[[Piece], Result], address: str, timeout_s: float = 10.0
) -> Iterator[Callable[[Sequence[Piece]], Iterator[Result]]]:
    """Yield the workers of a Dask cluster, which also need this package and `fcc`.

    Raises ValueError if Dask is not installed or there is no answer at the address.
    """
    try:
        from distributed import Client  # noqa: PLC0415 - only where it is asked for
    except ImportError:
        raise ValueError(
            "Dask is not installed: pip install 'fcc-hil[dask]', or fly on this machine"
        ) from None
    try:
        client = Client(address, timeout=timeout_s)
    except (OSError, TimeoutError, ValueError) as error:
        raise ValueError(
            f"no Dask scheduler at {address}: {error}; start one with `dask scheduler`"
        ) from None
    try:
        # The same piece has the same result, but results must not be cached.
        yield lambda pieces: (future.result() for future in client.map(work, pieces, pure=False))
    finally:
        client.close()


def all_workers(
    work: Callable[[Piece], Result], scheduler: str | None, count: int | None
) -> AbstractContextManager[Callable[[Sequence[Piece]], Iterator[Result]]]:
    """Return those of the Dask cluster at an address, or else `count` of this machine."""
    return on_dask(work, scheduler) if scheduler else local_workers(work, count)
