"""The command `raw`: the timed pattern with raw sensors."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

from . import documents, ranges
from .aircraft import AIRCRAFT
from .printable import say
from .rig import FlightError


def add(commands: Any) -> None:
    """Add the command."""
    raw = commands.add_parser(
        "raw", help="fly the timed pattern with raw sensors, by them or beside others"
    )
    raw.add_argument(
        "--sensors", choices=("phone", "board"), default="phone", help="(default: phone)"
    )
    raw.add_argument("--aircraft", choices=sorted(AIRCRAFT), default="c172p")
    ranges.add_seed(raw)
    raw.add_argument(
        "--navigation",
        choices=("measured", "kalman"),
        default="measured",
        help="fly by ideal sensors, or by attitude from the raw ones (default: measured)",
    )
    raw.add_argument(
        "--turbulence", type=int, choices=range(8), default=3, help="severity, 0 to 7 (default: 3)"
    )
    raw.add_argument(
        "--board",
        type=ranges.number(0.0, 0.01),
        metavar="P",
        help="fly through a servo board, on a line that gets each bit wrong with this probability",
    )
    raw.add_argument(
        "--airframe",
        type=Path,
        metavar="FILE",
        help="fly without an airspeed sensor, by what --learned wrote here in another flight",
    )
    ranges.add_files(
        raw,
        learned="write what was learned of the aircraft here, [autopilot.airframe] in TOML",
        out="write readings and truth here, .npz",
        json="write the figures here",
    )
    raw.set_defaults(run=_raw)


def _raw(options: argparse.Namespace) -> int:
    from . import raw_flight  # noqa: PLC0415 - needs the module fcc, which others do not

    line = None if options.board is None else raw_flight.BoardLine(options.board)
    try:
        learned = options.airframe
        airframe = None if learned is None else raw_flight.read_learned(learned)
        flight = raw_flight.fly(
            options.sensors,
            navigation=options.navigation,
            aircraft=options.aircraft,
            seed=options.seed,
            turbulence=options.turbulence,
            board=line,
            airframe=airframe,
        )
    except (FlightError, OSError, ValueError) as error:
        say(f"{error}", to=sys.stderr)
        return 1
    if line is not None:
        say(
            f"frames to the board: {line.board.received}, corrupt {line.board.corrupt}; "
            f"from it: {line.computer.received}, corrupt {line.computer.corrupt}"
        )
    arrays, worst, errors = flight.arrays, flight.score["worst"], flight.errors()
    for name in sorted(name for name in arrays if name.endswith("_t_s")):
        times_s = arrays[name]
        rate_hz = (len(times_s) - 1) / (times_s[-1] - times_s[0])
        say(f"{name.removesuffix('_t_s'):22} {len(times_s):6} readings, {rate_hz:5.1f} Hz")
    say(f"\nnavigation: {options.navigation}; RMS errors against the truth, while engaged")
    for name, figure in errors.items():
        say(f"{name:22} {figure:6.2f}")
    say(f"\n{len(flight.score['legs'])} legs, the worst of each")
    for name, value in worst.items():
        say(f"{name:22} {value:6.2f}" if isinstance(value, float) else f"{name:22}  never")
    if options.json is not None:
        figures = {"navigation": options.navigation, "errors": errors, **flight.score}
        documents.write(options.json, figures)
    if options.learned is not None and flight.learned is not None:
        raw_flight.write_learned(options.learned, flight.learned)
        say(f"written to {options.learned}")
    if options.out is not None:
        raw_flight.save(options.out, arrays)
        say(f"written to {options.out}")
    return 0
