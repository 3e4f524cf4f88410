"""The built-in aircraft in the air, and a station beside it."""

from __future__ import annotations

import contextlib
import itertools
import os
from collections.abc import Callable
from pathlib import Path

from daemon_under_test import DaemonUnderTest
from ground_station import Station

from visitor import Visitor

# Engages by command only. In the air; without a plan.
AIR = """
[built-in]
engage_at_s = 31622400.0
[engage]
command_needs_switch = false
[guidance]
mode = "hold"
[telemetry]
instance = "{instance}"
[recording]
folder = "{folder}/recordings"
"""
_numbers = itertools.count(1)

Visit = Callable[..., Visitor]


class Air:
    """The built-in aircraft in the air, in hold mode, and a station beside it."""

    def __init__(self, folder: Path, fccd: Path, program: Path, ends: contextlib.ExitStack) -> None:
        instance = f"air-{os.getpid()}-{next(_numbers)}"
        config = folder / "fccd.toml"
        config.write_text(AIR.format(instance=instance, folder=folder))
        words: list[str | Path] = [fccd, "run", "--quiet", "--config", config]
        self.folder = folder
        self.daemon = ends.enter_context(DaemonUnderTest(words, folder))
        options: list[str | Path] = [
            "--config",
            config,
            "--state",
            folder / "state",
            "--fccd",
            fccd,
        ]
        self.station = Station([program, *options], fccd, instance)
        ends.callback(self.station.end)

    def landed(self) -> str:
        """Return the name of the flight that has ended."""
        flights = self.station.ask("GET", "/api/flights")[1]
        return str(next(one["file"] for one in flights if not one["being_written"]))
