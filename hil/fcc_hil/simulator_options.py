"""The options of the command line that describe a simulator, and what they say."""

from __future__ import annotations

import argparse
import math
from pathlib import Path
from typing import Any, cast

from . import actions, ranges
from .aircraft import AIRCRAFT
from .faults import Address, Faults
from .misbehaviour import MISBEHAVIOURS
from .plant import Weather
from .settings import Start
from .standin import Settings
from .terrain_tiles import Tiles
from .udp import ReplyPort

_SHARES = {
    "loss": "lost",
    "duplicate": "duplicated",
    "reorder": "overtaken by the next",
    "truncate": "truncated",
}
"""The faults of a share of datagrams, and what they do."""


def address(text: str) -> Address:
    """Read HOST:PORT. Raises argparse.ArgumentTypeError, as do the others."""
    host, colon, port = text.rpartition(":")
    if not colon or not port.isdigit() or not 0 < int(port) < 65_536:
        raise argparse.ArgumentTypeError(f"'{text}': give HOST:PORT, as in 127.0.0.1:49001")
    return host, int(port)


def rows(text: str) -> tuple[int, ...]:
    """Read numbers of rows."""
    try:
        return tuple(int(number) for number in text.split(","))
    except ValueError:
        raise argparse.ArgumentTypeError(f"'{text}': give row numbers, as in 3,17,20") from None


def steps(text: str) -> tuple[int, ...]:
    """Read numbers of steps of `fccd x-plane check`."""
    numbers = rows(text)
    unknown = [number for number in numbers if number not in MISBEHAVIOURS]
    if unknown:
        raise argparse.ArgumentTypeError(
            f"'{text}': there is no step {unknown[0]}: give 1 to {max(MISBEHAVIOURS)}"
        )
    return numbers


def appointment(text: str) -> tuple[float, str]:
    """Read SECONDS:ACTION."""
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


def _tiles(text: str) -> Path:
    try:
        Tiles(Path(text))
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from None
    return Path(text)


def add(parser: argparse.ArgumentParser) -> None:
    """Add the options to a parser."""
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
        metavar="HZ",
        help="frames a second, all of one length; below 19 simulated time slows down (they vary "
        f"about {default.frame_rate_hz:g})",
    )
    parser.add_argument(
        "--frame-rates",
        type=_frame_rates,
        metavar="LEAST-GREATEST",
        help="frame rates that vary at random, about --frame-rate (20-144)",
    )
    parser.add_argument(
        "--plain",
        action="store_true",
        help="without a real X-Plane's manners: even frames, standard pressure, local axes that "
        "are level at the start, surfaces that follow at once",
    )
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
    parser.add_argument(
        "--replay-clock",
        choices=("past", "still"),
        default="past",
        help="what the flight time does in a replay (default %(default)s)",
    )
    parser.add_argument(
        "--latitude", type=ranges.number(-90.0, 90.0), default=0.0, metavar="DEG", help="initial"
    )
    parser.add_argument(
        "--longitude",
        type=ranges.number(-180.0, 180.0),
        default=0.0,
        metavar="DEG",
        help="initial",
    )
    parser.add_argument(
        "--terrain",
        type=_tiles,
        metavar="FOLDER",
        help="elevation tiles (.hgt) that are the ground (level)",
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
    air.add_argument(
        "--qnh", type=float, metavar="INHG", help=f"pressure at sea level ({default.qnh_inhg:g})"
    )
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
    parser.add_argument(
        "--at",
        type=appointment,
        action="append",
        default=[],
        metavar="S:ACTION",
        help="S seconds after the start do an action (`fcc standin --help` lists them); may be "
        "repeated, as in --at 30:pause --at 40:run --at 50:freeze:1.5",
    )
    network = parser.add_argument_group("network faults, in both directions")
    for name, what in _SHARES.items():
        network.add_argument(
            f"--{name}", type=float, default=0.0, metavar="FRACTION", help=f"of datagrams {what}"
        )
    network.add_argument("--delay", type=float, default=0.0, metavar="MS", help="of every datagram")
    network.add_argument("--jitter", type=float, default=0.0, metavar="MS", help="added, uniform")


def settings(options: argparse.Namespace) -> Settings:
    """Return what they say."""
    faults = Faults(
        delay_s=options.delay / 1e3,
        jitter_s=options.jitter / 1e3,
        **{name: getattr(options, name) for name in _SHARES},
    )
    given: dict[str, Any] = {}
    if options.qnh is not None:
        given["qnh_inhg"] = options.qnh
    if options.frame_rate is not None:
        given["frame_rate_hz"] = options.frame_rate
    elif options.frame_rates is not None:
        least_hz, greatest_hz = options.frame_rates
        given["frame_rate_hz"] = min(greatest_hz, max(least_hz, Settings.frame_rate_hz))
    if options.frame_rate is not None or options.frame_rates is not None:
        given["frame_rates_hz"] = options.frame_rates
    return (Settings.plain if options.plain else Settings)(
        **given,
        aircraft=options.aircraft,
        seed=options.seed,
        host=options.host,
        port=options.port,
        reply_port=options.reply_port,
        version=options.xplane_version,
        start=Start(options.latitude, options.longitude),
        terrain=options.terrain,
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
        replays_clock=options.replay_clock == "past",
        inbound=faults,
        outbound=faults,
    )
