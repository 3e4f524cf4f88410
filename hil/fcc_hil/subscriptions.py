"""RREF and RPOS subscriptions by client.

Output is bound to the frame: a value is sent on the first frame on which it is due, so at most once
per frame. All values due to a client are sent together, in random order, because X-Plane guarantees
none.
"""

from __future__ import annotations

import random
from dataclasses import dataclass, field

from .cockpit import Cockpit
from .datarefs import RPOS, Getter, getter
from .faults import Address
from .protocol import Dialect, RequestPosition, Subscribe, rpos_reply, rref_replies
from .readout import Readout

# Slightly less than a frame, so that rounding never delays a value to the next one.
_EPSILON_S = 1e-6


@dataclass(slots=True)
class _Due:
    """A rate, and when it is next due in s of frame time."""

    period_s: float
    next_s: float

    def take(self, now_s: float) -> bool:
        """Return whether it is due, and set when it will be next."""
        if now_s + _EPSILON_S < self.next_s:
            return False
        self.next_s += self.period_s
        if self.next_s <= now_s:
            self.next_s = now_s + self.period_s
        return True


@dataclass(slots=True)
class _Value:
    due: _Due
    path: str
    read: Getter


@dataclass
class _Client:
    values: dict[int, _Value] = field(default_factory=dict)
    position: _Due | None = None


class Subscriptions:
    """The subscriptions of every client."""

    def __init__(self, dialect: Dialect, *, shuffle: bool, seed: int) -> None:
        """Start without subscriptions."""
        self.unknown: dict[str, int] = {}
        """Requests for unknown datarefs, with their number; they get no answer."""
        self._dialect = dialect
        self._clients: dict[Address, _Client] = {}
        self._shuffle = random.Random(seed).shuffle if shuffle else None

    def subscribe(
        self, now_s: float, client: Address, request: Subscribe, cockpit: Cockpit
    ) -> None:
        """Begin, change or (at 0 Hz) end one client's subscription under its index."""
        values = self._clients.setdefault(client, _Client()).values
        if request.frequency_hz == 0:
            values.pop(request.index, None)
            return
        read = getter(request.path, cockpit, self._dialect)
        if read is None:
            self.unknown[request.path] = self.unknown.get(request.path, 0) + 1
            return
        period_s = 1.0 / request.frequency_hz
        known = values.get(request.index)
        if known is not None and known.path == request.path and known.due.period_s == period_s:
            return
        values[request.index] = _Value(_Due(period_s, now_s), request.path, read)

    def request_position(self, now_s: float, client: Address, request: RequestPosition) -> None:
        """Begin, change or (at 0 Hz) end one client's RPOS."""
        state = self._clients.setdefault(client, _Client())
        frequency_hz = request.frequency_hz
        state.position = _Due(1.0 / frequency_hz, now_s) if frequency_hz else None

    def paths(self) -> dict[Address, list[str]]:
        """Return the subscriptions of each client."""
        listing = {}
        for client, state in self._clients.items():
            paths = [value.path for value in state.values.values()]
            if state.position is not None:
                paths.append(RPOS)
            if paths:
                listing[client] = paths
        return listing

    def value_of(self, path: str, read: Getter, readout: Readout) -> float:  # noqa: ARG002
        """Return a value as it is sent."""
        return read(readout)

    def due(
        self, now_s: float, readout: Readout, withheld: frozenset[str] = frozenset()
    ) -> list[tuple[Address, bytes]]:
        """Return the datagrams due on this frame, without withheld values."""
        datagrams = []
        for client, state in self._clients.items():
            pairs = [
                (index, self.value_of(value.path, value.read, readout))
                for index, value in state.values.items()
                if value.due.take(now_s) and value.path not in withheld
            ]
            if self._shuffle is not None:
                self._shuffle(pairs)
            datagrams += [(client, reply) for reply in rref_replies(pairs, self._dialect)]
            is_due = state.position is not None and state.position.take(now_s)
            if is_due and RPOS not in withheld:
                datagrams.append((client, rpos_reply(readout.position())))
        return datagrams
