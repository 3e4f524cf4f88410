"""A flight of the daemon through the timed pattern: stand-in, daemon, switch, score.

The stand-in and the daemon run in separate processes; this one only observes. The switch is moved
inside the simulator, as by a person, so that no network fault can lose it. The score is computed
from JSBSim's true state and never from the daemon's report.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

from .cockpit import ENGAGE_SWITCH as ENGAGE_SWITCH  # noqa: PLC0414 - as others know it
from .cockpit import OVERRIDE_JOYSTICK, OVERRIDE_THROTTLES
from .daemon import Daemon
from .pattern import TimedPattern
from .printable import say
from .process import StandInProcess
from .rig import FlightError
from .score import Score
from .standin import Progress, Settings
from .truth import COLUMNS, Truth
from .units import FT_TO_M, INHG_TO_PA, STANDARD_INHG, pressure_altitude_m

_SUBSCRIBE_S = 15.0
_STEADY_S = 2.0
_ENGAGE_S = 3.0
_RELEASE_S = 3.0
_LOOK_S = 0.05
# Real time may exceed the simulated flight by this before giving up.
_PATIENCE = 1.5


@dataclass(frozen=True)
class Plan:
    """A flight to be flown."""

    daemon: Sequence[str]
    """The daemon's command line."""
    settings: Settings = field(default_factory=Settings)
    legs: int = 8
    pattern: TimedPattern = field(default_factory=TimedPattern)
    engage_switch: str = ENGAGE_SWITCH
    steady_s: float = _STEADY_S
    """Level flight before the switch goes on, in which navigation settles."""
    attempts: int = 1
    """How often the switch goes on until control is taken: after a pause of a busy machine,
    navigation by raw sensors settles anew."""
    actions: tuple[tuple[float, str], ...] = ()
    """What a person or the simulator does (`actions`), each with its time in s after engaging, in
    real time; ascending."""


@dataclass(frozen=True)
class Flight:
    """The result."""

    plan: Plan
    figures: Score
    truth: Truth
    engaged_at_s: float
    report: dict[str, Any] | None
    """The daemon's report."""
    exit_code: int
    standin: dict[str, Any]
    """The stand-in's status at the end."""
    failures: list[str]
    """Failures, as text; empty after a good flight."""

    def document(self, peer: Score) -> dict[str, Any]:
        """Return the flight for other programs."""
        settings = self.plan.settings
        report = self.report or {}
        return {
            "aircraft": settings.aircraft,
            "seed": settings.seed,
            "timing": report.get("timing"),
            "flight": self.figures,
            "peer": peer,
            "events": report.get("events"),
            "conditions": {
                "legs": self.plan.legs,
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


def progress_line(progress: Progress, engaged_at_s: float, where: str) -> str:
    """Return one line with the state of the flight, and where in it that is."""
    now = dict(zip(COLUMNS, progress.now, strict=True))
    # Plus zero, because a rounded -0 looks like an error.
    bank_deg = round(now["roll_deg"], 1) + 0.0
    return (
        f"true: {progress.time_s - engaged_at_s:6.1f} s  {where}  "
        f"alt {now['altitude_ft']:7.1f} ft  hdg {now['heading_deg']:5.1f}°  "
        f"{now['airspeed_kt']:5.1f} kt  bank {bank_deg:5.1f}°"
    )


def altitudes_note(settings: Settings) -> str:
    """Return what the printed altitudes are above, where it is not the same; otherwise nothing."""
    higher_ft = round(pressure_altitude_m(settings.qnh_inhg * INHG_TO_PA) / FT_TO_M, -1)
    if higher_ft == 0.0:
        return ""
    return (
        "altitudes: after `true:` above sea level; in fccd's lines above the level of its "
        f"altimeter setting, by default {STANDARD_INHG:.2f} inHg. Here the pressure at sea level "
        f"is {settings.qnh_inhg:.2f} inHg, so fccd's are about {abs(higher_ft):.0f} ft "
        f"{'higher' if higher_ft > 0.0 else 'lower'}"
    )


def fly(plan: Plan, notify: Callable[[str], None]) -> Flight:
    """Fly in real time. Raise FlightError if the flight cannot be completed."""
    with StandInProcess(plan.settings) as simulator, Daemon(plan.daemon) as daemon:
        notify(f"{plan.settings.aircraft} flies on UDP port {simulator.port}")
        await_subscriptions(simulator, daemon)
        start_s = simulator.progress().time_s
        daemon.wait_until(
            lambda: simulator.progress().time_s >= start_s + plan.steady_s,
            _PATIENCE * plan.steady_s + _ENGAGE_S,
            "simulated time does not pass",
        )
        engaged_at_s = _engage(plan, simulator, daemon)
        _watch(plan, simulator, daemon, engaged_at_s, notify)
        failures = _switch_off(plan, simulator, daemon)
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
        # The status first: transferring the truth takes longer than a frame.
        status = simulator.status()
        truth = simulator.truth()
    figures = truth.score(plan.pattern, plan.legs, engaged_at_s)
    return Flight(plan, figures, truth, engaged_at_s, report, exit_code, status, failures)


def await_subscriptions(simulator: StandInProcess, daemon: Daemon) -> None:
    """Wait until the daemon has subscribed to something. Raise FlightError if it does not."""
    daemon.wait_until(
        lambda: simulator.progress().subscriptions > 0,
        _SUBSCRIBE_S,
        f"the daemon has not subscribed to anything on UDP port {simulator.port} (check the "
        "simulator's address and port in its configuration)",
    )


def switch_on(
    simulator: StandInProcess,
    daemon: Daemon,
    switch: str = ENGAGE_SWITCH,
    within_s: float = _ENGAGE_S,
) -> float:
    """Switch on, and wait for the daemon to take control; return when, in simulated time."""
    switched_at_s = simulator.write(switch, 1.0)
    daemon.wait_until(
        lambda: simulator.progress().overridden,
        within_s,
        f"the daemon has not taken the controls by {switch} (check the engage switch in its "
        "configuration)",
    )
    return switched_at_s


def _engage(plan: Plan, simulator: StandInProcess, daemon: Daemon) -> float:
    """Switch on; return the simulated time at which that was."""
    for attempt in range(1, plan.attempts + 1):
        try:
            return switch_on(simulator, daemon, plan.engage_switch)
        except FlightError:
            if attempt == plan.attempts or daemon.exit_code is not None:
                raise
            simulator.write(plan.engage_switch, 0.0)
            time.sleep(_ENGAGE_S)
    raise ValueError(f"attempts = {plan.attempts}: give at least 1")


def _watch(
    plan: Plan,
    simulator: StandInProcess,
    daemon: Daemon,
    engaged_at_s: float,
    notify: Callable[[str], None],
) -> None:
    duration_s = plan.pattern.duration_s(plan.legs)
    began_s = time.monotonic()
    give_up_s = began_s + duration_s * _PATIENCE + _ENGAGE_S
    next_line_s = engaged_at_s
    todo = list(plan.actions)
    while True:
        while todo and time.monotonic() - began_s >= todo[0][0]:
            _, action = todo.pop(0)
            notify(action)
            simulator.act(action)
        progress = simulator.progress()
        if progress.time_s >= next_line_s:
            leg = min(plan.legs, plan.pattern.legs_begun(progress.time_s - engaged_at_s))
            notify(progress_line(progress, engaged_at_s, f"leg {leg} of {plan.legs}"))
            next_line_s += 1.0
        # One more row than the last leg needs, so that it is complete.
        if progress.time_s > engaged_at_s + duration_s + _LOOK_S:
            return
        daemon.require_running()
        if time.monotonic() > give_up_s:
            raise FlightError("simulated time runs too slowly; is the machine overloaded?")
        time.sleep(_LOOK_S)


def _switch_off(plan: Plan, simulator: StandInProcess, daemon: Daemon) -> list[str]:
    """Switch off; return what is wrong with the release."""
    simulator.write(plan.engage_switch, 0.0)
    deadline_s = time.monotonic() + _RELEASE_S
    while simulator.progress().overridden and time.monotonic() < deadline_s:
        if daemon.exit_code is not None:
            # Its last datagrams may still be under way.
            deadline_s = min(deadline_s, time.monotonic() + 0.5)
        time.sleep(_LOOK_S)
    return [
        f"{path} is still 1 {_RELEASE_S:.0f} s after the switch went off"
        for path in (OVERRIDE_JOYSTICK, OVERRIDE_THROTTLES)
        if simulator.read(path) == 1.0
    ]


def print_progress(line: str) -> None:
    """Print a line of progress: over the last one on a terminal, otherwise below it."""
    end = "\r" if sys.stderr.isatty() else "\n"
    say(line.ljust(100) if end == "\r" else line, end=end, to=sys.stderr)
