"""Flights with faults, several at once, and their recordings.

The time of detection is taken from the recording, in the loop's own ticks: a busy machine makes a
test slow and not wrong.
"""

from __future__ import annotations

import itertools
import json
import subprocess
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

from daemon_under_test import Ending
from recordings import EVENT, RECORD, in_sequence, only_recording

Key = TypeVar("Key")
Result = TypeVar("Result")

AT_ONCE = 8
"""Flights in real time mostly wait."""

STANDBY = 0
"""The phase in the recording."""
ENGAGED = 1
FAILSAFE = 2

OVERRUN = 3
"""The cause of the failsafe in the recording."""

NS = 1e-9

AT_ONCE_S = 3.0
"""What takes a tick, on a busy machine."""


def at_once(flights: dict[Key, Callable[[], Result]]) -> dict[Key, Result]:
    """Run flights at the same time; raise the first failure."""
    with ThreadPoolExecutor(AT_ONCE) as pool:
        begun = {key: pool.submit(flight) for key, flight in flights.items()}
        return {key: future.result() for key, future in begun.items()}


@dataclass(frozen=True)
class Flown:
    """A completed flight."""

    ending: Ending
    records: list[Any]
    """Of each tick, decoded."""
    events: list[Any]
    """Decoded."""
    recording: Path
    injected_ns: int = 0
    """The time of the fault, by the loop's clock, which is the machine's monotonic one."""

    @classmethod
    def of(cls, ending: Ending, folder: Path, injected_ns: int = 0) -> Flown:
        """Read a flight's recording in a folder."""
        path = only_recording(folder)
        seen = in_sequence(path)
        return cls(
            ending,
            [message.content for message in seen if message.topic == RECORD],
            [message.content for message in seen if message.topic == EVENT],
            path,
            injected_ns,
        )

    @property
    def failsafes(self) -> list[int]:
        """Return the indices of the records in which failsafe began."""
        phases = [record.state.phase for record in self.records]
        return [
            place
            for place, (last, phase) in enumerate(itertools.pairwise(phases), 1)
            if phase == FAILSAFE and last != FAILSAFE
        ]

    def texts(self) -> list[str]:
        """Return the texts of the events."""
        return [event.text for event in self.events]

    def replayed(self, fccd: Path) -> dict[str, Any]:
        """Fly the recording again; return what `fccd replay` found."""
        done = subprocess.run(
            [fccd, "replay", self.recording, "--json"], capture_output=True, text=True, check=False
        )
        found: dict[str, Any] = json.loads(done.stdout)
        return {**found, "exit_code": done.returncode}


def assert_flown_again(fccd: Path, flown: Flown) -> None:
    """Every output of the replay is identical to the last bit."""
    found = flown.replayed(fccd)
    assert found["exit_code"] == 0, found
    assert found["identity"]["differing"] == 0
    assert found["ticks"] == len(flown.records)


def seconds(later: Any, earlier: Any) -> float:
    """Return the time between two records, by the loop's clock."""
    return float((later.tick.woke_ns - earlier.tick.woke_ns) * NS)


def assert_in_the_same_tick(flown: Flown, place: int, after_s: float) -> None:
    """Assert that the reaction to a part's action is in the same tick."""
    engaged_ns = next(r.tick.woke_ns for r in flown.records if r.state.phase == ENGAGED)
    last, record = flown.records[place - 1 : place + 1]
    assert last.tick.woke_ns - engaged_ns < after_s / NS <= record.tick.woke_ns - engaged_ns


def assert_regular(records: Iterable[Any], period_ns: int) -> None:
    """No tick is missing except the counted ones, and the phase is kept."""
    records = list(records)
    for last, record in itertools.pairwise(records):
        assert record.tick.number == last.tick.number + 1 + record.tick.missed
        assert (
            record.tick.scheduled_ns - last.tick.scheduled_ns
            == (record.tick.number - last.tick.number) * period_ns
        )
