"""The command `bench-android`."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

from . import app_timing, documents, ranges
from .printable import say


def add(commands: Any) -> None:
    """Add it to a parser's commands."""
    app = commands.add_parser(
        "bench-android", help="compare the loop's timing in the Android app with the daemon's"
    )
    ranges.add_daemon(app)
    app.add_argument("--app", type=Path, required=True, help="android/tests/timing-flight")
    app.add_argument("--rounds", type=ranges.count, default=5, help="(default %(default)s)")
    app.add_argument(
        "--seconds",
        type=ranges.number(1.0, 3600.0, "s"),
        default=60.0,
        metavar="S",
        help="of each flight (%(default)s)",
    )
    app.add_argument(
        "--rate",
        type=ranges.number(1.0, 1_000.0, "Hz"),
        default=40.0,
        metavar="HZ",
        help="of the loop (%(default)s)",
    )
    ranges.add_files(app, json="write all figures here")
    app.set_defaults(run=_compare)


def _compare(options: argparse.Namespace) -> int:
    comparison = app_timing.Comparison(
        options.fccd, options.app, options.rounds, options.seconds, options.rate
    )
    flights = []
    for flight in app_timing.run(comparison):
        flights.append(flight)
        say(f"  {flight.loop}: late {flight.p99_us:,.0f} us at p99", to=sys.stderr)
    say(app_timing.table(flights))
    for fifo, what in ((False, "without SCHED_FIFO"), (True, "with it")):
        ratio = app_timing.ratio(flights, fifo=fifo)
        say(f"median p99 of the app over the best daemon's, {what}: {ratio:.2f}")
    if options.json:
        documents.write(options.json, app_timing.document(comparison, flights))
    return 0
