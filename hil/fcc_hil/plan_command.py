"""The command `plan`: fly a flight plan with JSBSim, and score it."""

from __future__ import annotations

import argparse
import signal
import sys
import tempfile
from dataclasses import asdict, astuple, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import documents, ranges
from .aircraft import AIRCRAFT
from .fly import print_progress
from .printable import say
from .process import interrupt
from .rig import FlightError
from .table import markdown

if TYPE_CHECKING:
    from .flown_plan import FlownPlan
    from .plan_flight import PlanConditions
    from .plan_score import PlanScore


def add(commands: Any) -> None:
    """Add the command."""
    plan = commands.add_parser("plan", help="fly a flight plan, and score it from the truth")
    plan.add_argument("--plan", type=Path, required=True, metavar="FILE", help="the plan")
    plan.add_argument("--aircraft", choices=sorted(AIRCRAFT), default="c172p")
    plan.add_argument("--wind", type=ranges.number(0.0, 100.0), default=0.0, metavar="KT")
    plan.add_argument(
        "--wind-from",
        type=ranges.number(0.0, 360.0),
        default=0.0,
        metavar="DEG",
        help="true (default: 0)",
    )
    plan.add_argument(
        "--turbulence", type=int, choices=range(8), default=0, help="severity (default: 0)"
    )
    ranges.add_seed(plan)
    plan.add_argument(
        "--position",
        choices=("plain", "precise"),
        default="plain",
        help="correlated error of the satellite receiver: 1.5 m, or 0.5 m (default: plain)",
    )
    plan.add_argument(
        "--no-range-finder", action="store_true", help="land by the runway's elevation"
    )
    plan.add_argument(
        "--config", type=Path, metavar="FILE", help="speeds of this aircraft, and other keys"
    )
    plan.add_argument(
        "--terrain",
        type=Path,
        metavar="FOLDER",
        help="elevation tiles (.hgt): the ground that is flown over, and known to the autopilot",
    )
    ranges.add_files(plan, json="write the figures here", plot="write a picture here, .png")
    plan.add_argument(
        "--realtime",
        action="store_true",
        help="by fccd, over X-Plane's protocol (default: by raw sensors, in lockstep)",
    )
    plan.add_argument(
        "--fccd",
        type=Path,
        default=Path("target/release/fccd"),
        metavar="FILE",
        help="with --realtime (default: target/release/fccd)",
    )
    plan.set_defaults(run=_plan)


def _in_real_time(
    options: argparse.Namespace, conditions: PlanConditions
) -> tuple[PlanScore, FlownPlan]:
    from . import plan_real_time  # noqa: PLC0415 - it needs the module fcc

    given = [
        option
        for option, is_given in (
            ("--position precise", options.position == "precise"),
            ("--no-range-finder", options.no_range_finder),
        )
        if is_given
    ]
    if given:
        raise ValueError(
            f"{' and '.join(given)} with --realtime: X-Plane's protocol has its own position and "
            "height above the ground; leave it out"
        )
    # A signal ends the daemon and the stand-in, too.
    signal.signal(signal.SIGTERM, interrupt)
    with tempfile.TemporaryDirectory(prefix="fcc-plan-") as scratch:
        return plan_real_time.fly(
            options.plan, conditions, options.fccd, Path(scratch), print_progress
        )


def _plan(options: argparse.Namespace) -> int:
    import fcc  # noqa: PLC0415 - other commands do not need the module

    from . import plan_flight, plan_plot  # noqa: PLC0415 - likewise
    from .plant import Weather  # noqa: PLC0415 - likewise

    try:
        conditions = plan_flight.PlanConditions(
            aircraft=options.aircraft,
            weather=Weather(
                wind_from_deg=options.wind_from,
                wind_kt=options.wind,
                turbulence_severity=options.turbulence,
            ),
            seed=options.seed,
            sensors="board-rtk" if options.position == "precise" else "board",
            without=frozenset({"range"} if options.no_range_finder else ()),
            terrain=options.terrain,
            config=options.config.read_text(encoding="utf-8") if options.config else "",
        )
        if options.realtime:
            score, flown = _in_real_time(options, conditions)
        else:
            score, flown = plan_flight.fly(options.plan, conditions)
    except (FlightError, OSError, ValueError, fcc.ConfigError) as error:
        say(f"{error}", to=sys.stderr)
        return 1
    _show(score)
    if options.json is not None:
        document = score.document()
        documents.write(options.json, document)
    if options.plot is not None:
        plan_plot.plot(options.plot, options.plan, flown)
    for words in score.missing:
        say(f"error: {words}", to=sys.stderr)
    return 1 if score.missing else 0


def _show(score: PlanScore) -> None:
    for scores in (score.waypoints, score.legs, score.turns, score.circles):
        if scores:
            head = [field.name for field in fields(scores[0])]
            say(markdown(head, [map(_cell, astuple(one)) for one in scores]) + "\n")
    for name, parts in (("take-off", score.takeoff), ("landing", score.landing)):
        if parts is not None:
            figures = (f"{key} {value:.1f}" for key, value in asdict(parts).items())
            say(f"\n{name}: {', '.join(figures)}")
    if (ground := score.terrain) is not None:
        what = f"{ground.lowest_m:.1f} m over the ground"
        if ground.collides:
            what = "the ground is flown into"
        say(f"\n{what} at {ground.latitude_deg:.5f}, {ground.longitude_deg:.5f}")


def _cell(value: object) -> str:
    return f"{value:.2f}" if isinstance(value, float) else str(value)
