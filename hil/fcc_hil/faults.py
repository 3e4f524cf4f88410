"""A network that loses, duplicates, reorders, truncates and delays datagrams, seeded."""

from __future__ import annotations

import heapq
import itertools
import random
from dataclasses import dataclass
from typing import Generic, TypeVar

Address = tuple[str, int]
Item = TypeVar("Item")

# A reordered datagram is held until the next one has passed, or for this time.
_HELD_AT_MOST_S = 0.2


@dataclass(frozen=True)
class Faults:
    """The probability of each fault for a datagram, 0..1, and delays."""

    loss: float = 0.0
    duplicate: float = 0.0
    reorder: float = 0.0
    """Overtaken by the datagram after it."""
    truncate: float = 0.0
    """Truncated at a random length."""
    delay_s: float = 0.0
    """Of every datagram."""
    jitter_s: float = 0.0
    """Added to the delay, uniform from 0; may reorder."""

    def __post_init__(self) -> None:
        """Refuse probabilities outside 0..1 and negative times."""
        for name in ("loss", "duplicate", "reorder", "truncate"):
            if not 0.0 <= getattr(self, name) <= 1.0:
                raise ValueError(f"{name} = {getattr(self, name)}: give a fraction from 0 to 1")
        for name in ("delay_s", "jitter_s"):
            if not 0.0 <= getattr(self, name) <= 10.0:
                raise ValueError(f"{name} = {getattr(self, name)}: give 0 to 10 seconds")


@dataclass
class FaultCounts:
    """Faults of the datagrams in one direction."""

    offered: int = 0
    lost: int = 0
    duplicated: int = 0
    reordered: int = 0
    truncated: int = 0


class FaultyLink(Generic[Item]):
    """One direction of the network: datagrams are put in with `offer` and taken out with `due`.

    `Item` is the datagram's destination or source.
    """

    def __init__(self, faults: Faults, seed: int) -> None:
        """Start the random sequence that belongs to `seed`."""
        self.faults = faults
        self.counts = FaultCounts()
        self._random = random.Random(seed)
        self._order = itertools.count()
        self._queue: list[tuple[float, int, Item, bytes]] = []
        self._held: tuple[float, Item, bytes] | None = None

    def offer(self, now_s: float, item: Item, datagram: bytes) -> None:
        """Put a datagram on the link at a time in s."""
        faults, counts, draw = self.faults, self.counts, self._random.random
        counts.offered += 1
        # All random numbers are drawn for every datagram: a fault of one does not change the next.
        lose, double, hold, cut, where, late = (draw() for _ in range(6))
        if lose < faults.loss:
            counts.lost += 1
            return
        if cut < faults.truncate:
            counts.truncated += 1
            datagram = datagram[: int(where * len(datagram))]
        arrives_s = now_s + faults.delay_s + late * faults.jitter_s
        if hold < faults.reorder and self._held is None:
            counts.reordered += 1
            self._held = (arrives_s + _HELD_AT_MOST_S, item, datagram)
            return
        self._push(arrives_s, item, datagram)
        if double < faults.duplicate:
            counts.duplicated += 1
            self._push(arrives_s, item, datagram)
        if self._held is not None:
            _, held_item, held = self._held
            self._held = None
            self._push(arrives_s, held_item, held)

    def due(self, now_s: float) -> list[tuple[Item, bytes]]:
        """Take the datagrams that have arrived by a time in s, in their order of arrival."""
        if self._held is not None and self._held[0] <= now_s:
            self._push(*self._held)
            self._held = None
        arrived = []
        while self._queue and self._queue[0][0] <= now_s:
            _, _, item, datagram = heapq.heappop(self._queue)
            arrived.append((item, datagram))
        return arrived

    def _push(self, arrives_s: float, item: Item, datagram: bytes) -> None:
        heapq.heappush(self._queue, (arrives_s, next(self._order), item, datagram))
