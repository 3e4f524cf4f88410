"""The command line: `fcc COMMAND`, or `python -m fcc_hil COMMAND`."""

from __future__ import annotations

import argparse
import importlib.metadata
import json
import os
import signal
import sys
import threading
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import actions, documents, ranges, simulator_options, watcher_load
from . import commands as flights
from .daemon import DaemonError, command
from .fly import (
    Plan,
    altitudes_note,
    fly,
    print_progress,
)
from .pattern import TimedPattern
from .peer import fly_peer
from .plant import TrimError
from .plot import plot_pattern
from .printable import say
from .process import StandInError, StandInProcess, interrupt
from .rig import FlightError
from .standin import BEACON_GROUP
from .table import table

if TYPE_CHECKING:
    from _typeshed import SupportsWrite

_LOOK_S = 0.05
# 128 and the number of SIGPIPE, as a shell reports it.
_PIPE_CLOSED = 141
_KILL = actions.Action("end at once, as a crash does", lambda _, __: None)


def _fly(options: argparse.Namespace) -> int:
    # A signal ends the daemon and the stand-in, too.
    signal.signal(signal.SIGTERM, interrupt)
    plan = Plan(
        command(options.fccd, options.config),
        simulator_options.settings(options),
        options.legs,
        actions=tuple(sorted(options.at)),
    )
    if note := altitudes_note(plan.settings):
        say(note)
    flight = fly(plan, print_progress)
    peer, _ = fly_peer(plan.legs, plan.settings.seed, plan.pattern)
    say(
        "\n"
        + table(
            [
                (f"fccd, {plan.settings.aircraft}", flight.figures),
                ("JSBSim's c172x autopilot", peer),
            ]
        )
    )
    frames = flight.standin["frames"]
    say(
        f"stand-in: {frames['frames']} frames, {frames['slipped']} slipped, "
        f"late {frames['lateness_us']['p99']:.0f} us at p99, "
        f"work {frames['work_us']['p99']:.0f} us at p99"
    )
    if options.json:
        documents.write(options.json, flight.document(peer))
    if options.plot:
        plot_pattern(
            options.plot,
            flight.truth,
            plan.pattern,
            flight.engaged_at_s,
            plan.legs,
            f"fccd flies JSBSim's {plan.settings.aircraft} through the timed pattern",
        )
        say(f"written: {options.plot}")
    for failure in flight.failures:
        say(f"failed: {failure}", to=sys.stderr)
    return 1 if flight.failures else 0


def _standin(options: argparse.Namespace) -> int:
    settings = replace(
        simulator_options.settings(options),
        beacon=BEACON_GROUP if options.beacon else None,
        data_target=options.data_target,
        data_rows=options.data_rows,
        person=options.person or bool(options.misbehave),
        misbehaves_in=options.misbehave,
        board=options.board,
    )
    stop = threading.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: stop.set())
    with StandInProcess(settings) as simulator:
        say(
            f"{settings.aircraft} flies on UDP {settings.host}:{simulator.port} and sends from "
            f"port {simulator.reply_port}; Ctrl-C ends it"
        )
        if settings.board == "udp":
            say(f"its servo board is on UDP {settings.host}:{simulator.board_port()}")
        elif settings.board:
            say(f"its servo board is on the serial line {settings.board}")
        sys.stdout.flush()
        began_s = time.monotonic()
        todo = sorted(options.at)
        while not stop.wait(_LOOK_S):
            ran_s = time.monotonic() - began_s
            while todo and todo[0][0] <= ran_s:
                action = todo.pop(0)[1]
                say(f"{ran_s:.1f} s: {action}")
                if action == "kill":
                    simulator.kill()
                    return 0
                simulator.act(action)
            if options.seconds is not None and ran_s >= options.seconds:
                break
        status: dict[str, Any] = simulator.status()
    print(json.dumps(status, indent=2))
    return 0


def _peer(options: argparse.Namespace) -> int:
    climb_ft = 0.0 if options.level else TimedPattern().climb_ft
    pattern = TimedPattern(climb_ft=climb_ft)
    figures, truth = fly_peer(options.legs, options.seed, pattern)
    if options.json:
        print(json.dumps(figures, indent=2))
    else:
        say(table([("JSBSim's c172x autopilot", figures)]))
    if options.plot:
        title = "JSBSim's own c172x autopilot on the timed pattern"
        plot_pattern(options.plot, truth, pattern, 0.0, options.legs, title)
        say(f"written: {options.plot}")
    return 0


def _bench_live(options: argparse.Namespace) -> int:
    load = watcher_load.Load(
        options.fccd, options.watcher, options.rounds, options.seconds, options.watchers
    )
    flights = []
    for flight in watcher_load.run(load):
        flights.append(flight)
        say(
            f"{flight.watchers:5} watchers: late {flight.p99_us:6.1f} us at p99, "
            f"{flight.p99_9_us:6.1f} us at p99.9, {flight.max_us:7.1f} us at most; "
            f"{flight.ticks} ticks, {flight.missed} missed, {flight.dropped} records lost",
        )
    ratio = watcher_load.ratio(flights)
    say(f"median p99.9 with watchers over that without: {ratio:.2f}")
    lost = any(flight.dropped or flight.exit_code for flight in flights)
    return 1 if lost else 0


class _Parser(argparse.ArgumentParser):
    """A parser whose help is printed, or not printed with an error.

    ``argparse`` ignores that its help could not be written.
    """

    def print_help(self, file: SupportsWrite[str] | None = None) -> None:
        """Print the help."""
        (sys.stdout if file is None else file).write(self.format_help())


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(
        prog="fcc", description="Fly JSBSim's aircraft with fccd, or with its loop in lockstep."
    )
    parser.add_argument(
        "--version", action="version", version=f"%(prog)s {importlib.metadata.version('fcc-hil')}"
    )
    commands = parser.add_subparsers(required=True, metavar="COMMAND")

    flies = commands.add_parser(
        "fly", help="fly the daemon through the timed pattern in real time and score it"
    )
    ranges.add_daemon(flies)
    flies.add_argument("--config", type=Path, help="the daemon's configuration")
    flies.add_argument(
        "--legs", type=ranges.count, default=8, help="of 20 s each (default %(default)s)"
    )
    ranges.add_files(flies, json="write timing and score here", plot="write a picture here (PNG)")
    simulator_options.add(flies)
    flies.set_defaults(run=_fly)

    serves = commands.add_parser("standin", help="run the stand-in for X-Plane until Ctrl-C")
    serves.add_argument("--beacon", action="store_true", help="send the beacon by multicast")
    serves.add_argument(
        "--data-target",
        type=simulator_options.address,
        metavar="HOST:PORT",
        help="target of Data Output",
    )
    serves.add_argument(
        "--data-rows",
        type=simulator_options.rows,
        default=(),
        metavar="N,N",
        help="its rows, as in 3,17,20",
    )
    serves.add_argument(
        "--person",
        action="store_true",
        help="with a person, who does what `fccd x-plane check --yes` asks for",
    )
    serves.add_argument(
        "--misbehave",
        type=simulator_options.steps,
        default=(),
        metavar="N,N",
        help="misbehave in what these steps of that check show",
    )
    serves.add_argument("--seconds", type=float, metavar="S", help="end after so many seconds")
    serves.formatter_class = argparse.RawDescriptionHelpFormatter
    serves.epilog = "actions, for --at:\n" + "\n".join(
        f"  {name + str(action.argument):24}{action.does}"
        for name, action in (*actions.ACTIONS.items(), ("kill", _KILL))
    )
    simulator_options.add(serves)
    serves.add_argument(
        "--board",
        default="",
        metavar="PATH",
        help="a servo board drives the surfaces: at a serial line, to which this path will lead, "
        "or at a UDP port (udp)",
    )
    serves.set_defaults(run=_standin)

    peer = commands.add_parser("peer", help="fly JSBSim's own autopilot through the pattern")
    peer.add_argument("--legs", type=ranges.count, default=8, help="(default %(default)s)")
    ranges.add_seed(peer, "of every random sequence")
    peer.add_argument("--level", action="store_true", help="turn without climbing")
    peer.add_argument("--json", action="store_true", help="print the score as JSON")
    ranges.add_files(peer, plot="write a picture here (PNG)")
    peer.set_defaults(run=_peer)

    bench_live = commands.add_parser(
        "bench-live", help="fly with and without watchers that join, leave and are killed"
    )
    ranges.add_daemon(bench_live)
    bench_live.add_argument("--watcher", type=Path, required=True, help="the example `watch`")
    bench_live.add_argument(
        "--rounds", type=int, default=5, help="of two flights each (default %(default)s)"
    )
    bench_live.add_argument(
        "--seconds", type=float, default=300.0, metavar="S", help="of each flight (%(default)s)"
    )
    bench_live.add_argument(
        "--watchers", type=int, default=1000, help="in every second flight (%(default)s)"
    )
    bench_live.set_defaults(run=_bench_live)

    flights.add(commands)
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command; return the exit code: 0 success, 1 failure, 2 wrong usage.

    If the reader of its output has ended, as `head` does, the command ends silently, with 141.
    """
    try:
        try:
            return _run(arguments)
        finally:
            # Here, and not when Python ends: a closed pipe is found by writing to it.
            sys.stdout.flush()
    except BrokenPipeError:
        _drop_output()
        return _PIPE_CLOSED
    except OSError as error:
        _drop_output()
        say(f"error: the output could not be written: {error}", to=sys.stderr)
        return 1


def _drop_output() -> None:
    """Do not try again, when Python ends, to write what could not be written."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _run(arguments: Sequence[str] | None) -> int:
    options = _parser().parse_args(arguments)
    try:
        code: int = options.run(options)
    except BrokenPipeError:
        raise
    except (
        FlightError,
        DaemonError,
        StandInError,
        TrimError,
        ValueError,
        OSError,
    ) as error:
        say(f"error: {error}", to=sys.stderr)
        return 1
    except KeyboardInterrupt:
        say("interrupted", to=sys.stderr)
        return 130
    return code


if __name__ == "__main__":
    sys.exit(main())
