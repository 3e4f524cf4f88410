"""The command line: `fcc COMMAND`, or `python -m fcc_hil COMMAND`."""

from __future__ import annotations

import argparse
import json
import math
import signal
import sys
import threading
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, cast

from . import actions, watcher_load
from . import commands as flights
from .aircraft import AIRCRAFT
from .daemon import DaemonError, command
from .faults import Address, Faults
from .fly import FlightError, Plan, fly, peer_row, print_progress, write_document
from .pattern import TimedPattern
from .peer import fly_peer
from .plant import TrimError, Weather
from .plot import plot_flight
from .process import StandInError, StandInProcess
from .soak import SoakError
from .standin import BEACON_GROUP, Settings
from .table import table
from .udp import ReplyPort

_LOOK_S = 0.05
_KILL = actions.Action("end at once, as a crash does", lambda _, __: None)


def _address(text: str) -> Address:
    host, colon, port = text.rpartition(":")
    if not colon or not port.isdigit() or not 0 < int(port) < 65_536:
        raise argparse.ArgumentTypeError(f"'{text}': give HOST:PORT, as in 127.0.0.1:49001")
    return host, int(port)


def _rows(text: str) -> tuple[int, ...]:
    try:
        return tuple(int(number) for number in text.split(","))
    except ValueError:
        raise argparse.ArgumentTypeError(f"'{text}': give row numbers, as in 3,17,20") from None


def _appointment(text: str) -> tuple[float, str]:
    seconds, _, action = text.partition(":")
    try:
        at_s = float(seconds)
    except ValueError:
        at_s = -1.0
    if not 0.0 <= at_s < math.inf or not action:
        raise argparse.ArgumentTypeError(
            f"'{text}': give SECONDS:ACTION or SECONDS:ACTION:ARGUMENT, as in 30:pause, 30:freeze:2"
        )
    if action != "kill":
        try:
            actions.parse(action)
        except ValueError as error:
            raise argparse.ArgumentTypeError(str(error)) from None
    return at_s, action


def _reply_port(text: str) -> ReplyPort:
    if text in ("same", "next"):
        return cast(ReplyPort, text)
    if not text.isdigit() or int(text) > 65_535:
        raise argparse.ArgumentTypeError(f"'{text}': give a port, next or same")
    return int(text)


def _frame_rates(text: str) -> tuple[float, float]:
    least, dash, greatest = text.partition("-")
    try:
        rates_hz = float(least), float(greatest)
    except ValueError:
        rates_hz = 0.0, 0.0
    if not dash or not 1.0 <= rates_hz[0] <= rates_hz[1] <= 1_000.0:
        raise argparse.ArgumentTypeError(f"'{text}': give LEAST-GREATEST, as in 20-144")
    return rates_hz


def _simulator_options(parser: argparse.ArgumentParser) -> None:
    default = Settings()
    parser.add_argument(
        "--aircraft",
        default=default.aircraft,
        choices=list(AIRCRAFT),
        metavar="NAME",
        help=f"one of {', '.join(AIRCRAFT)} (default %(default)s)",
    )
    parser.add_argument("--seed", type=int, default=default.seed, help="of every random sequence")
    parser.add_argument("--host", default=default.host, help="address to listen on (%(default)s)")
    parser.add_argument(
        "--port",
        type=int,
        default=default.port,
        help="UDP port to listen on, 0 for any free one (default %(default)s)",
    )
    parser.add_argument(
        "--reply-port",
        type=_reply_port,
        default=default.reply_port,
        metavar="PORT",
        help="UDP port to send from: a number, 0 for any free one, next for the one after --port, "
        "as X-Plane sends from 49001, or same (default %(default)s)",
    )
    parser.add_argument(
        "--frame-rate",
        type=float,
        default=default.frame_rate_hz,
        metavar="HZ",
        help="frames a second; below 19 simulated time slows down (default %(default)s)",
    )
    parser.add_argument(
        "--frame-rates",
        type=_frame_rates,
        default=default.frame_rates_hz,
        metavar="LEAST-GREATEST",
        help="frame rates that vary at random about --frame-rate, as in 20-144",
    )
    parser.add_argument("--plain", action="store_true", help="without a real X-Plane's manners")
    parser.add_argument(
        "--axial-sign",
        type=int,
        choices=(1, -1),
        default=1,
        help="of the axial load in row 4, in which sources differ",
    )
    parser.add_argument(
        "--silent-windows",
        action="store_true",
        help="send nothing while a map, a menu or an alert is open",
    )
    parser.add_argument(
        "--xplane-version",
        type=int,
        default=default.version,
        metavar="N",
        help="as X-Plane reports it: 101500, 115501, 121000 (default %(default)s)",
    )
    parser.add_argument("--heading", type=float, default=0.0, metavar="DEG", help="initial heading")
    parser.add_argument(
        "--variation",
        type=float,
        default=0.0,
        metavar="DEG",
        help="magnetic variation, positive to the east",
    )
    air = parser.add_argument_group("air and sensors")
    air.add_argument("--qnh", type=float, metavar="INHG", help="pressure at sea level")
    air.add_argument("--noise", action="store_true", help="noise on the sensors")
    air.add_argument("--wind-from", type=float, default=0.0, metavar="DEG", help="true direction")
    air.add_argument("--wind", type=float, default=0.0, metavar="KT", help="steady wind")
    air.add_argument(
        "--turbulence",
        type=int,
        default=0,
        choices=range(8),
        metavar="0..7",
        help="severity after MIL-F-8785C: 0 calm, 3 light, 4 moderate",
    )
    network = parser.add_argument_group("network faults, in both directions")
    for name, what in (
        ("loss", "lost"),
        ("duplicate", "duplicated"),
        ("reorder", "overtaken by the next"),
        ("truncate", "truncated"),
    ):
        network.add_argument(
            f"--{name}", type=float, default=0.0, metavar="FRACTION", help=f"of datagrams {what}"
        )
    network.add_argument("--delay", type=float, default=0.0, metavar="MS", help="of every datagram")
    network.add_argument("--jitter", type=float, default=0.0, metavar="MS", help="added, uniform")


def _settings(options: argparse.Namespace) -> Settings:
    faults = Faults(
        loss=options.loss,
        duplicate=options.duplicate,
        reorder=options.reorder,
        truncate=options.truncate,
        delay_s=options.delay / 1e3,
        jitter_s=options.jitter / 1e3,
    )
    given: dict[str, Any] = {} if options.qnh is None else {"qnh_inhg": options.qnh}
    if not options.plain:
        given["frame_rates_hz"] = options.frame_rates
    return (Settings.plain if options.plain else Settings)(
        **given,
        aircraft=options.aircraft,
        seed=options.seed,
        host=options.host,
        port=options.port,
        reply_port=options.reply_port,
        frame_rate_hz=options.frame_rate,
        version=options.xplane_version,
        heading_deg=options.heading,
        magnetic_variation_deg=options.variation,
        weather=Weather(
            wind_from_deg=options.wind_from,
            wind_kt=options.wind,
            turbulence_severity=options.turbulence,
        ),
        noise=options.noise,
        axial_sign=float(options.axial_sign),
        sends_while_stalled=not options.silent_windows,
        inbound=faults,
        outbound=faults,
    )


def _interrupt(*_: object) -> None:
    raise KeyboardInterrupt


def _fly(options: argparse.Namespace) -> int:
    # A signal ends the daemon and the stand-in, too.
    signal.signal(signal.SIGTERM, _interrupt)
    plan = Plan(command(options.fccd, options.config), _settings(options), options.legs)
    flight = fly(plan, print_progress)
    peer = peer_row(plan)
    print(
        "\n"
        + table(
            [
                (f"fccd, {plan.settings.aircraft}", flight.figures),
                ("JSBSim's c172x autopilot", peer),
            ]
        )
    )
    frames = flight.standin["frames"]
    print(
        f"stand-in: {frames['frames']} frames, {frames['slipped']} slipped, "
        f"late {frames['lateness_us']['p99']:.0f} us at p99, "
        f"work {frames['work_us']['p99']:.0f} us at p99"
    )
    if options.json:
        write_document(options.json, flight.document(peer))
    if options.plot:
        plot_flight(
            options.plot,
            flight.truth,
            plan.pattern,
            flight.engaged_at_s,
            plan.legs,
            f"fccd flies JSBSim's {plan.settings.aircraft} through the timed pattern",
        )
    for failure in flight.failures:
        print(f"failed: {failure}", file=sys.stderr)
    return 1 if flight.failures else 0


def _standin(options: argparse.Namespace) -> int:
    settings = replace(
        _settings(options),
        beacon=BEACON_GROUP if options.beacon else None,
        data_target=options.data_target,
        data_rows=options.data_rows,
    )
    stop = threading.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: stop.set())
    with StandInProcess(settings) as simulator:
        print(
            f"{settings.aircraft} flies on UDP {settings.host}:{simulator.port} and sends from "
            f"port {simulator.reply_port}; Ctrl-C ends it"
        )
        sys.stdout.flush()
        began_s = time.monotonic()
        todo = sorted(options.at)
        while not stop.wait(_LOOK_S):
            ran_s = time.monotonic() - began_s
            while todo and todo[0][0] <= ran_s:
                action = todo.pop(0)[1]
                print(f"{ran_s:.1f} s: {action}", flush=True)
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
    figures, truth = fly_peer(options.legs, options.seed, TimedPattern(climb_ft=climb_ft))
    if options.json:
        print(json.dumps(figures, indent=2))
    else:
        print(table([("JSBSim's c172x autopilot", figures)]))
    if options.plot:
        title = "JSBSim's own c172x autopilot on the timed pattern"
        pattern = TimedPattern(climb_ft=climb_ft)
        plot_flight(options.plot, truth, pattern, 0.0, options.legs, title)
    return 0


def _bench(options: argparse.Namespace) -> int:
    from .bench import run  # noqa: PLC0415 - needs the module fcc, which the others do not

    flights = []
    for name, figures in run(options.legs):
        flights.append((name, figures))
        print(f"  flown: {name}", file=sys.stderr, flush=True)
    if options.json:
        print(json.dumps(dict(flights), indent=2))
    else:
        print(table(flights))
    return 0


def _bench_live(options: argparse.Namespace) -> int:
    load = watcher_load.Load(
        options.fccd, options.watcher, options.rounds, options.seconds, options.watchers
    )
    flights = []
    for flight in watcher_load.run(load):
        flights.append(flight)
        print(
            f"{flight.watchers:5} watchers: late {flight.p99_us:6.1f} us at p99, "
            f"{flight.p99_9_us:6.1f} us at p99.9, {flight.max_us:7.1f} us at most; "
            f"{flight.ticks} ticks, {flight.missed} missed, {flight.dropped} records lost",
            flush=True,
        )
    ratio = watcher_load.ratio(flights)
    print(f"median p99.9 with watchers over that without: {ratio:.2f}")
    lost = any(flight.dropped or flight.exit_code for flight in flights)
    return 1 if lost else 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="fcc", description=__doc__)
    commands = parser.add_subparsers(required=True, metavar="COMMAND")

    flies = commands.add_parser(
        "fly", help="fly the daemon through the timed pattern in real time and score it"
    )
    flies.add_argument("--fccd", type=Path, required=True, help="the daemon's program")
    flies.add_argument("--config", type=Path, help="the daemon's configuration")
    flies.add_argument("--legs", type=int, default=8, help="of 20 s each (default %(default)s)")
    flies.add_argument("--json", type=Path, metavar="FILE", help="write timing and score here")
    flies.add_argument("--plot", type=Path, metavar="FILE", help="write a picture here (PNG)")
    _simulator_options(flies)
    flies.set_defaults(run=_fly)

    serves = commands.add_parser("standin", help="run the stand-in for X-Plane until Ctrl-C")
    serves.add_argument("--beacon", action="store_true", help="send the beacon by multicast")
    serves.add_argument(
        "--data-target", type=_address, metavar="HOST:PORT", help="target of Data Output"
    )
    serves.add_argument(
        "--data-rows", type=_rows, default=(), metavar="N,N", help="its rows, as in 3,17,20"
    )
    serves.add_argument("--seconds", type=float, metavar="S", help="end after so many seconds")
    serves.add_argument(
        "--at",
        type=_appointment,
        action="append",
        default=[],
        metavar="S:ACTION",
        help="S seconds after the start do an action; may be repeated, as in --at 30:pause "
        "--at 40:run --at 50:freeze:1.5",
    )
    serves.formatter_class = argparse.RawDescriptionHelpFormatter
    serves.epilog = "actions, for --at:\n" + "\n".join(
        f"  {name + str(action.argument):24}{action.does}"
        for name, action in (*actions.ACTIONS.items(), ("kill", _KILL))
    )
    _simulator_options(serves)
    serves.set_defaults(run=_standin)

    peer = commands.add_parser("peer", help="fly JSBSim's own autopilot through the pattern")
    peer.add_argument("--legs", type=int, default=8, help="(default %(default)s)")
    peer.add_argument("--seed", type=int, default=1)
    peer.add_argument("--level", action="store_true", help="turn without climbing")
    peer.add_argument("--json", action="store_true", help="print the score as JSON")
    peer.add_argument("--plot", type=Path, metavar="FILE", help="write a picture here (PNG)")
    peer.set_defaults(run=_peer)

    bench = commands.add_parser(
        "bench", help="compare the autopilot with JSBSim's own, in lockstep"
    )
    bench.add_argument("--legs", type=int, default=8, help="(default %(default)s)")
    bench.add_argument("--json", action="store_true", help="print the scores as JSON")
    bench.set_defaults(run=_bench)

    bench_live = commands.add_parser(
        "bench-live", help="fly with and without watchers that join, leave and are killed"
    )
    bench_live.add_argument("--fccd", type=Path, required=True, help="the daemon's program")
    bench_live.add_argument("--watcher", type=Path, required=True, help="the example `watch`")
    bench_live.add_argument("--rounds", type=int, default=5, help="(default %(default)s)")
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
    """Run a command; return the exit code: 0 success, 1 failure, 2 wrong usage."""
    options = _parser().parse_args(arguments)
    if getattr(options, "legs", 1) < 1:
        print("error: --legs: give at least 1", file=sys.stderr)
        return 2
    try:
        code: int = options.run(options)
    except (
        FlightError,
        SoakError,
        watcher_load.FlightError,
        DaemonError,
        StandInError,
        TrimError,
        ValueError,
        OSError,
    ) as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        return 130
    return code


if __name__ == "__main__":
    sys.exit(main())
