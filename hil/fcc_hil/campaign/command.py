"""The command `campaign`."""

from __future__ import annotations

import argparse
import time
from functools import partial
from typing import Any

from .. import documents, measured, ranges
from ..printable import say
from ..progress import bar
from ..workers import all_workers
from .draw import KINDS, Bounds, usual_bounds

_MOST_LATE_MS = 1_000.0


def add(commands: Any) -> None:
    """Add the command to a parser's."""
    usual = Bounds()
    campaign = commands.add_parser(
        "campaign", help="fly at the edges of the envelope by chance, and say what failed and how"
    )
    kinds = campaign.add_mutually_exclusive_group()
    for kind, words in (
        ("healthy", "with sensors that have ordinary errors, and nothing that fails"),
        ("airspeed", "the same with an airspeed that fails"),
    ):
        kinds.add_argument(
            f"--{kind}", dest="kind", action="store_const", const=kind, default="edges", help=words
        )
    campaign.add_argument(
        "--first",
        type=ranges.whole(0, 999_999),
        default=0,
        metavar="N",
        help="the number of the first flight (%(default)s)",
    )
    campaign.add_argument(
        "--flights", type=ranges.count, default=300, metavar="N", help="how many (%(default)s)"
    )
    ranges.add_seed(campaign, "of all that is drawn (%(default)s); see docs/campaign.md")
    campaign.add_argument(
        "--flight",
        type=ranges.whole(0, 999_999),
        metavar="N",
        help="fly only this one, and show it",
    )
    campaign.add_argument(
        "--delay-ms",
        type=ranges.number(0.0, _MOST_LATE_MS, "ms"),
        metavar="MS",
        help="the longest delay from a measurement to the effect of the command "
        f"({usual.delay_ms:g}; 150 if healthy)",
    )
    campaign.add_argument(
        "--turbulence",
        type=int,
        choices=range(8),
        metavar="0..7",
        help=f"the greatest severity ({usual.turbulence}; 5 if healthy)",
    )
    campaign.add_argument(
        "--raw",
        choices=("phone", "board"),
        help="fly by the raw sensors of this alone, calibrated on the ground",
    )
    campaign.add_argument(
        "--least-clean",
        type=ranges.number(0.0, 100.0, "%"),
        metavar="PERCENT",
        help="exit with 1 if less of the flights are clean (98; 94 if healthy)",
    )
    ranges.add_workers(campaign)
    campaign.add_argument(
        "--scheduler", metavar="ADDRESS", help="fly on a Dask cluster, as in tcp://10.0.0.5:8786"
    )
    ranges.add_files(
        campaign,
        json="write everything here",
        results="write the tables here, as a section of a page",
        picture="write a picture here",
        record="with --flight: write its recording here (.mcap)",
    )
    campaign.set_defaults(run=partial(_campaign, campaign))


def _campaign(parser: argparse.ArgumentParser, options: argparse.Namespace) -> int:
    if options.kind == "airspeed" and options.raw:
        parser.error("argument --raw: not with --airspeed: give --healthy, or neither")
    if options.record and options.flight is None:
        parser.error("argument --record: give the number of a flight with --flight, too")
    # They need the module fcc, which other commands do not.
    from . import report  # noqa: PLC0415
    from .flying import Task, fly_task  # noqa: PLC0415

    usual = usual_bounds(options.kind)
    bounds = Bounds(
        usual.delay_ms if options.delay_ms is None else options.delay_ms,
        usual.turbulence if options.turbulence is None else options.turbulence,
        options.raw,
        options.kind,
    )
    if options.flight is not None:
        return _one(options, bounds)
    numbers = range(options.first, options.first + options.flights)
    tasks = [Task(number, options.seed, bounds) for number in numbers]
    workers = all_workers(fly_task, options.scheduler, options.workers)
    began_s = time.monotonic()
    outcomes = []
    with workers as fly_all, bar("flying", len(tasks)) as notify:
        for outcome in fly_all(tasks):
            outcomes.append(outcome)
            notify(len(outcomes), f"{100.0 * report.clean_share(outcomes):.0f} % clean")
    text = report.tables(outcomes)
    say(f"{text}\n\n{report.flights(outcomes)}")
    say(f"took {time.monotonic() - began_s:.0f} s")
    if options.results:
        title = f"Campaign: {options.kind}{f', {options.raw}' if options.raw else ''}"
        command = _repeated(options, bounds)
        measured.write(options.results, title, command, text, f"seed {options.seed}")
    if options.json:
        document = report.document(outcomes, options.seed, bounds)
        documents.write(options.json, document)
    if options.picture:
        from .picture import draw as draw_picture  # noqa: PLC0415 - matplotlib takes a second

        title = (
            f"{len(outcomes)} flights, seed {options.seed}, delay to {bounds.delay_ms:g} ms, "
            f"turbulence to {bounds.turbulence}"
            + (f", {bounds.raw_sensors}" if bounds.raw_sensors else "")
        )
        draw_picture(options.picture, outcomes, title)
    least_percent = options.least_clean
    if least_percent is None:
        least_percent = KINDS[options.kind].least_clean_percent
    return 1 if 100.0 * report.clean_share(outcomes) < least_percent else 0


def _repeated(options: argparse.Namespace, bounds: Bounds) -> str:
    """Return the command that flies it again."""
    first = f" --first {options.first}" if options.first else ""
    return f"fcc campaign{bounds.words} --seed {options.seed}{first} --flights {options.flights}"


def _one(options: argparse.Namespace, bounds: Bounds) -> int:
    """Fly one flight again, and show all of it."""
    from . import report  # noqa: PLC0415
    from .draw import draw  # noqa: PLC0415
    from .flying import fly  # noqa: PLC0415

    outcome, truth = fly(draw(options.flight, options.seed, bounds), options.record)
    say(report.failure(outcome))
    for event in outcome.events:
        say(f"    {event.time_s:7.2f} s  {event.text}")
    for name, value in outcome.verdict.figures.items():
        say(f"    {name:30} {value:8.2f}")
    say(f"digest {outcome.digest}")
    if options.json:
        documents.write(options.json, outcome.document())
    if options.picture:
        from .picture import draw_flight  # noqa: PLC0415

        if truth is None:
            raise ValueError("no flight to draw: it was not flown")
        draw_flight(options.picture, truth, outcome)
    return 0 if outcome.verdict.is_clean else 1
