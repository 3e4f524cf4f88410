"""A flight of the daemon through the timed pattern: stand-in, daemon, switch, score.

The stand-in runs in a process of its own, the daemon in another; this one only
watches. The switch is moved inside the simulator, as a person would, so no network
fault can lose it. The score is made from JSBSim's truth and never from what the
daemon says of itself.
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from .cockpit import GENERIC_LIGHTS, OVERRIDE_JOYSTICK, OVERRIDE_THROTTLES
from .daemon import Daemon
from .pattern import TimedPattern
from .peer import fly_peer
from .process import StandInProcess
from .score import Score, score
from .standin import Progress, Settings
from .truth import COLUMNS, Truth

ENGAGE_SWITCH = f"{GENERIC_LIGHTS}[0]"

_SUBSCRIBE_S = 15.0
_STEADY_S = 2.0
_ENGAGE_S = 3.0
_RELEASE_S = 3.0
_LOOK_S = 0.05
# Real time may run this much longer than the simulated flight before we give up.
_PATIENCE = 1.5


class FlightError(RuntimeError):
    """The flight could not be flown to its end."""


@dataclass(frozen=True)
class Order:
    """What to fly."""

    daemon: Sequence[str]
    """The daemon's command line."""
    settings: Settings = field(default_factory=Settings)
    legs: int = 8
    pattern: TimedPattern = field(default_factory=TimedPattern)
    engage_switch: str = ENGAGE_SWITCH


@dataclass(frozen=True)
class Flight:
    """What came of it."""

    order: Order
    figures: Score
    truth: Truth
    engaged_at_s: float
    report: dict[str, Any] | None
    """What the daemon said of itself."""
    exit_code: int
    standin: dict[str, Any]
    """The stand-in's status at the end."""
    failures: list[str]
    """What went wrong, in words; empty after a good flight."""

    def document(self, peer: Score) -> dict[str, Any]:
        """Return the flight as other tools read it."""
        settings = self.order.settings
        report = self.report or {}
        return {
            "aircraft": settings.aircraft,
            "seed": settings.seed,
            "timing": report.get("timing"),
            "flight": self.figures,
            "peer": peer,
            "events": report.get("events"),
            "conditions": {
                "legs": self.order.legs,
                "noise": settings.noise,
                "inbound": asdict(settings.inbound),
                "outbound": asdict(settings.outbound),
                "weather": asdict(settings.weather),
                "frame_rate_hz": settings.frame_rate_hz,
            },
            "standin": self.standin,
            "exit_code": self.exit_code,
            "failures": self.failures,
        }


def progress_line(order: Order, engaged_at_s: float, progress: Progress) -> str:
    """Return one line that says where the flight stands."""
    now = dict(zip(COLUMNS, progress.now, strict=True))
    leg = min(order.legs, order.pattern.legs_begun(progress.time_s - engaged_at_s))
    return (
        f"{progress.time_s - engaged_at_s:6.1f} s  leg {leg} of {order.legs}  "
        f"altitude {now['altitude_ft']:7.1f} ft  heading {now['heading_deg']:5.1f}°  "
        f"airspeed {now['airspeed_kt']:5.1f} kt  bank {now['roll_deg']:5.1f}°"
    )


def fly(order: Order, say: Callable[[str], None]) -> Flight:
    """Fly an order in real time. Raises FlightError if it cannot be flown to its end."""
    with StandInProcess(order.settings) as simulator, Daemon(order.daemon) as daemon:
        say(f"{order.settings.aircraft} flies on UDP port {simulator.port}")
        _await(
            simulator,
            daemon,
            lambda progress: progress.subscriptions > 0,
            _SUBSCRIBE_S,
            f"the daemon has not subscribed to anything on UDP port {simulator.port}; "
            "check the simulator's address and port in its configuration",
        )
        start_s = simulator.progress().time_s
        _await(
            simulator,
            daemon,
            lambda progress: progress.time_s >= start_s + _STEADY_S,
            _STEADY_S + _ENGAGE_S,
            "simulated time stands still",
        )
        engaged_at_s = simulator.write(order.engage_switch, 1.0)
        _await(
            simulator,
            daemon,
            lambda progress: progress.overridden,
            _ENGAGE_S,
            f"the daemon has not taken the controls {_ENGAGE_S:.0f} s after {order.engage_switch} "
            "went to 1; check the engage switch in its configuration",
        )
        _watch(order, simulator, daemon, engaged_at_s, say)
        failures = _switch_off(order, simulator, daemon)
        exit_code = daemon.stop()
        report = daemon.report()
        if exit_code != 0:
            failures.append(f"the daemon ended with exit code {exit_code}")
        if report is None:
            failures.append("the daemon printed no JSON object")
        else:
            missed = report.get("timing", {}).get("missed", 0)
            if missed:
                failures.append(f"the loop missed {missed} ticks")
        # The status first: handing the truth over takes longer than a frame.
        status = simulator.status()
        truth = simulator.truth()
    figures = score(
        truth.trace(),
        order.pattern.legs(order.legs, engaged_at_s, truth.captured_at(engaged_at_s)),
    )
    return Flight(order, figures, truth, engaged_at_s, report, exit_code, status, failures)


def _await(
    simulator: StandInProcess,
    daemon: Daemon,
    arrived: Callable[[Progress], bool],
    patience_s: float,
    otherwise: str,
) -> None:
    deadline_s = time.monotonic() + patience_s
    while not arrived(simulator.progress()):
        if daemon.exit_code is not None:
            raise FlightError(f"the daemon ended with exit code {daemon.exit_code}")
        if time.monotonic() > deadline_s:
            raise FlightError(otherwise)
        time.sleep(_LOOK_S)


def _watch(
    order: Order,
    simulator: StandInProcess,
    daemon: Daemon,
    engaged_at_s: float,
    say: Callable[[str], None],
) -> None:
    duration_s = order.pattern.duration_s(order.legs)
    give_up_s = time.monotonic() + duration_s * _PATIENCE + _ENGAGE_S
    next_line_s = engaged_at_s
    while True:
        progress = simulator.progress()
        if progress.time_s >= next_line_s:
            say(progress_line(order, engaged_at_s, progress))
            next_line_s += 1.0
        # One more row than the last leg needs, so that it is complete.
        if progress.time_s > engaged_at_s + duration_s + _LOOK_S:
            return
        if daemon.exit_code is not None:
            raise FlightError(
                f"the daemon ended with exit code {daemon.exit_code}, "
                f"{progress.time_s - engaged_at_s:.1f} s into the flight"
            )
        if time.monotonic() > give_up_s:
            raise FlightError("simulated time runs too slowly; is the machine overloaded?")
        time.sleep(_LOOK_S)


def _switch_off(order: Order, simulator: StandInProcess, daemon: Daemon) -> list[str]:
    """Move the switch back; return what is wrong with how the daemon let go."""
    simulator.write(order.engage_switch, 0.0)
    deadline_s = time.monotonic() + _RELEASE_S
    while simulator.progress().overridden and time.monotonic() < deadline_s:
        if daemon.exit_code is not None:
            # Its last words may still be on their way.
            deadline_s = min(deadline_s, time.monotonic() + 0.5)
        time.sleep(_LOOK_S)
    return [
        f"{path} is still 1 {_RELEASE_S:.0f} s after the switch went off"
        for path in (OVERRIDE_JOYSTICK, OVERRIDE_THROTTLES)
        if simulator.read(path) == 1.0
    ]


def peer_row(order: Order) -> Score:
    """Return the score of JSBSim's own autopilot on the same pattern, in calm air."""
    figures, _ = fly_peer(order.legs, order.settings.seed, order.pattern)
    return figures


def write_document(path: Path, document: dict[str, Any]) -> None:
    """Write a flight's document as JSON."""
    path.write_text(json.dumps(document, indent=2) + "\n")


def say_on_stderr(line: str) -> None:
    """Show a line of progress: over the last one on a terminal, else below it."""
    end = "\r" if sys.stderr.isatty() else "\n"
    print(line.ljust(100) if end == "\r" else line, end=end, file=sys.stderr, flush=True)
