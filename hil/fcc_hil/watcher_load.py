"""The effect of watchers on the loop: flights with and without them, in turn.

The daemon flies its built-in aircraft at 1 kHz. In every second flight programs watch it one after
the other; half of them leave, half are killed with SIGKILL. The lateness of the loop is measured.
"""

from __future__ import annotations

import os
import random
import statistics
import subprocess
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from .daemon import Daemon
from .rig import FlightError

RATE_HZ = 1000
_STAY_S = (1.0, 5.0)
_LOOK_S = 0.01
_SETTLE_S = 1.0


@dataclass(frozen=True)
class Load:
    """The number of watchers, and the duration of the daemon's flight."""

    fccd: Path
    watcher: Path
    """The example `watch`: its arguments are the instance and how long to stay."""
    rounds: int
    seconds: float
    watchers: int
    seed: int = 1


@dataclass(frozen=True)
class Flight:
    """One flight's figures."""

    watchers: int
    ticks: int
    missed: int
    p99_9_us: float
    p99_us: float
    max_us: float
    dropped: int
    exit_code: int


def run(load: Load) -> Iterator[Flight]:
    """Fly each round without and with watchers; yield every flight as it ends."""
    for number in range(load.rounds):
        yield fly(load, 0, number)
        yield fly(load, load.watchers, number)


def ratio(flights: list[Flight]) -> float:
    """Return the median p99.9 with watchers over that without."""
    without = statistics.median(f.p99_9_us for f in flights if f.watchers == 0)
    watched = statistics.median(f.p99_9_us for f in flights if f.watchers > 0)
    return watched / without


def fly(load: Load, watchers: int, number: int) -> Flight:
    """Fly once; `watchers` start at a constant rate and leave or are killed."""
    chance = random.Random(load.seed + number)
    instance = f"watched-{os.getpid()}"
    with tempfile.TemporaryDirectory() as scratch:
        config = Path(scratch, "fccd.toml")
        config.write_text(
            f"[built-in]\nengage_at_s = 1.5\n[loop]\nrate_hz = {RATE_HZ}\n"
            '[guidance]\nmode = "hold"\n'
        )
        words = [str(load.fccd), "fly", "--json", "--quiet", "--config", str(config)]
        words += ["--instance", instance, "--seconds", str(load.seconds)]
        with Daemon(words, Path(scratch, "said")) as daemon:
            time.sleep(_SETTLE_S)
            _watch(load, watchers, instance, daemon, chance)
            exit_code, report = daemon.stop(), daemon.report()
    if report is None:
        raise FlightError(f"the daemon ended with {exit_code} and printed no report")
    return _figures(report, watchers, exit_code)


def _watch(load: Load, watchers: int, instance: str, daemon: Daemon, chance: random.Random) -> None:
    """Start and end watchers until all have run and the daemon has ended."""
    pace_s = (load.seconds - 2.0 * _SETTLE_S) / max(watchers, 1)
    began_s = time.monotonic()
    come = 0
    here: list[tuple[float, subprocess.Popen[Any]]] = []
    while daemon.exit_code is None:
        now_s = time.monotonic() - began_s
        if come < watchers and now_s >= come * pace_s:
            stays_s = chance.uniform(*_STAY_S)
            # Every second one would stay until the end.
            words: list[str | Path] = [
                load.watcher,
                instance,
                *([f"{stays_s:.2f}"] if come % 2 else []),
            ]
            process = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            here.append((now_s + stays_s, process))
            come += 1
        for until_s, process in list(here):
            if process.poll() is not None:
                here.remove((until_s, process))
            elif now_s > until_s + 0.5:
                process.kill()
        time.sleep(_LOOK_S)
    for _, process in here:
        process.kill()
        process.wait()


def _figures(report: dict[str, Any], watchers: int, exit_code: int) -> Flight:
    timing = report["timing"]
    return Flight(
        watchers=watchers,
        ticks=timing["ticks"],
        missed=timing["missed"],
        p99_9_us=timing["lateness_us"]["p99_9"],
        p99_us=timing["lateness_us"]["p99"],
        max_us=timing["lateness_us"]["max"],
        dropped=report["records_dropped"],
        exit_code=exit_code,
    )
