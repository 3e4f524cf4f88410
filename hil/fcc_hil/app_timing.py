"""The loop's timing in the Android app, compared with the daemon's: flights in turn.

Both fly the built-in aircraft by the same configuration, without and with ``SCHED_FIFO``. The app
runs under Robolectric: its service and its screen, which is drawn 20 times a second, in a Java
process that makes and collects garbage. Both timings are read from the recordings, by one program.
"""

from __future__ import annotations

import json
import os
import signal
import statistics
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from .daemon import Daemon, command
from .rig import FlightError
from .table import markdown

NICE = -19
"""What the app asks for where it is refused ``SCHED_FIFO``."""
_FIFO = 80
_ENGAGED_AFTER_S = 4.0
_STARTS_WITHIN_S = 600.0
_LAST_WORDS = 1_000


@dataclass(frozen=True)
class Comparison:
    """What flies, how long and how often."""

    fccd: Path
    app: Path
    """android/tests/timing-flight: its arguments are configuration, seconds and recording."""
    rounds: int
    seconds: float
    rate_hz: float


@dataclass(frozen=True)
class Loop:
    """A program, and what it asks the kernel for."""

    name: str
    is_app: bool
    priority: int
    nice: int

    @property
    def is_fifo(self) -> bool:
        """Return whether it asks for ``SCHED_FIFO``."""
        return self.priority > 0


LOOPS = (
    Loop("daemon, nice 0", is_app=False, priority=0, nice=0),
    Loop(f"daemon, nice {NICE}", is_app=False, priority=0, nice=NICE),
    Loop(f"app, nice {NICE}", is_app=True, priority=0, nice=NICE),
    Loop(f"daemon, SCHED_FIFO {_FIFO}", is_app=False, priority=_FIFO, nice=0),
    Loop(f"app, SCHED_FIFO {_FIFO}", is_app=True, priority=_FIFO, nice=0),
)
"""In the order in which they fly in each round. The app itself asks for its nice value."""


@dataclass(frozen=True)
class Flight:
    """The figures of a flight."""

    loop: str
    policy: str
    """What the kernel granted."""
    ticks: int
    missed: int
    within_2_percent: float
    p50_us: float
    p99_us: float
    max_us: float


def run(comparison: Comparison) -> Iterator[Flight]:
    """Fly all of them, round by round; yield every flight as it ends."""
    for _ in range(comparison.rounds):
        for loop in LOOPS:
            yield fly(comparison, loop)


def fly(comparison: Comparison, loop: Loop) -> Flight:
    """Fly once, and read the timing from the recording."""
    with tempfile.TemporaryDirectory() as scratch:
        config = Path(scratch, "fccd.toml")
        config.write_text(
            f"[built-in]\nengage_at_s = {_ENGAGED_AFTER_S}\n"
            f'[guidance]\nmode = "hold"\n[loop]\nrate_hz = {comparison.rate_hz}\n'
            # Phones refuse to lock memory, and nobody watches the app.
            f"[realtime]\npriority = {loop.priority}\nlock_memory = false\n"
            "[telemetry]\nenabled = false\n"
        )
        if loop.is_app:
            words = [str(comparison.app), str(config), str(comparison.seconds)]
            _end([*words, str(Path(scratch, "app.mcap"))], comparison.seconds + _STARTS_WITHIN_S)
        else:
            words = [*command(comparison.fccd, config), "--recordings", scratch]
            with Daemon(_nice(words, loop.nice), log_to=Path(scratch, "log")) as daemon:
                time.sleep(_ENGAGED_AFTER_S + comparison.seconds)
                daemon.stop(signal.SIGINT)
        recordings = list(Path(scratch).glob("*.mcap"))
        if len(recordings) != 1:
            raise FlightError(f"{loop.name}: {len(recordings)} recordings")
        report = _end([str(comparison.fccd), "report", "--json", str(recordings[0])], 60.0)
    timing = json.loads(report)["timing"]
    late = timing["lateness_us"]
    return Flight(
        loop=loop.name,
        policy=timing["realtime"]["policy"],
        ticks=timing["ticks"],
        missed=timing["missed"],
        within_2_percent=timing["period_ms"]["within_2_percent"],
        p50_us=late["p50"],
        p99_us=late["p99"],
        max_us=late["max"],
    )


def _nice(words: Sequence[str], nice: int) -> list[str]:
    """Return a command line that begins with this nice value, if it can be had."""
    return ["nice", "-n", str(nice), *words] if nice and os.geteuid() == 0 else list(words)


def _end(words: Sequence[str], within_s: float) -> str:
    """Run a program to its end; return what it printed."""
    try:
        ended = subprocess.run(
            list(words), capture_output=True, text=True, check=False, timeout=within_s
        )
    except subprocess.TimeoutExpired:
        raise FlightError(f"{words[0]} did not end within {within_s:.0f} s") from None
    if ended.returncode != 0:
        said = (ended.stdout + ended.stderr)[-_LAST_WORDS:]
        raise FlightError(f"{words[0]} ended with {ended.returncode}: {said}")
    return ended.stdout


def median(flights: Sequence[Flight], loop: Loop, of: Callable[[Flight], float]) -> float:
    """Return the median of a figure over the flights of a loop."""
    return statistics.median(of(flight) for flight in flights if flight.loop == loop.name)


def ratio(flights: Sequence[Flight], *, fifo: bool = False) -> float:
    """Return the median p99 of the app over that of the best daemon, both with the same policy."""

    def p99s(is_app: bool) -> list[float]:
        alike = [loop for loop in LOOPS if loop.is_fifo == fifo and loop.is_app == is_app]
        return [median(flights, loop, lambda flight: flight.p99_us) for loop in alike]

    return min(p99s(is_app=True)) / min(p99s(is_app=False))


def table(flights: Sequence[Flight]) -> str:
    """Return medians over the rounds, and each round's p99, as a Markdown table."""
    rows = []
    for loop in LOOPS:
        flown = [flight for flight in flights if flight.loop == loop.name]
        if not flown:
            continue
        figures = [
            median(flown, loop, lambda flight: flight.p50_us),
            median(flown, loop, lambda flight: flight.p99_us),
            median(flown, loop, lambda flight: flight.max_us),
        ]
        within = median(flown, loop, lambda flight: flight.within_2_percent)
        rows.append(
            [
                loop.name,
                ", ".join(sorted({flight.policy for flight in flown})),
                *(f"{figure:,.0f}" for figure in figures),
                f"{within * 100.0:.1f} %",
                sum(flight.missed for flight in flown),
                ", ".join(f"{flight.p99_us:,.0f}" for flight in flown),
            ]
        )
    head = ["loop", "granted", "late p50 µs", "p99 µs", "max µs", "within ±2 %", "missed"]
    return markdown([*head, "p99 of each"], rows)


def document(comparison: Comparison, flights: Sequence[Flight]) -> dict[str, object]:
    """Return every flight, and the ratios, for JSON."""
    return {
        "rate_hz": comparison.rate_hz,
        "seconds": comparison.seconds,
        "flights": [asdict(flight) for flight in flights],
        "p99_ratio": ratio(flights),
        "p99_ratio_fifo": ratio(flights, fifo=True),
    }
