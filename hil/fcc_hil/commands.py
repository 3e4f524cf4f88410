"""The commands `suite`, `margins`, `tune`, `soak`, `raw`, `campaign`, and two benchmarks."""

from __future__ import annotations

import argparse
import fnmatch
import os
import sys
from pathlib import Path
from typing import Any

from . import app_timing_command, documents, flood, plan_command, ranges, raw_command, replacement
from .aircraft import AIRCRAFT
from .campaign import command as campaign
from .printable import say
from .progress import bar
from .soak import Soak, soak
from .table import markdown
from .workers import all_workers

_LARGEST_SEEDS = 1_000
_AXES = ("elevator", "aileron", "rudder", "throttle")


def seeds(text: str) -> tuple[int, ...]:
    """Read seeds such as `1,2,7-9`. Raises argparse.ArgumentTypeError."""
    found: list[int] = []
    for part in text.split(","):
        first, dash, last = part.partition("-")
        try:
            begin, end = int(first), int(last if dash else first)
        except ValueError:
            raise argparse.ArgumentTypeError(f"'{text}': give seeds, as in 1,2,7-9") from None
        if not 0 <= begin <= end or end - begin >= _LARGEST_SEEDS:
            raise argparse.ArgumentTypeError(
                f"'{part}': give seeds from 0 up, ascending, at most {_LARGEST_SEEDS}"
            )
        found += range(begin, end + 1)
    return tuple(found)


def add(commands: Any) -> None:
    """Add these commands to a parser's."""
    suite = commands.add_parser(
        "suite", help="fly many aircraft in all conditions and check them against limits"
    )
    suite.add_argument(
        "--only", metavar="PATTERN", help="cases whose name matches, as in 'c172*noise*'"
    )
    suite.add_argument("--quick", action="store_true", help="only those flown as a test")
    ranges.add_workers(suite)
    ranges.add_files(suite, json="write all figures here", picture="write a picture here")
    suite.set_defaults(run=_suite)

    margins = commands.add_parser(
        "margins", help="measure gain and phase margins with the loop broken at each actuator"
    )
    margins.add_argument(
        "--aircraft",
        type=ranges.names(tuple(AIRCRAFT)),
        default=("c172p",),
        metavar="NAME,NAME",
        help="(default c172p)",
    )
    margins.add_argument(
        "--airspeeds",
        type=ranges.numbers(20.0, 500.0, "kt"),
        metavar="KT,KT",
        help="(default: 1.3 Vs, cruise and the greatest)",
    )
    margins.add_argument(
        "--axes",
        type=ranges.names(_AXES),
        default=_AXES,
        metavar="AXIS,AXIS",
        help=f"of {', '.join(_AXES)} (all)",
    )
    margins.add_argument(
        "--delays",
        type=ranges.numbers(0.0, 1_000.0, "ms"),
        default=(25.0,),
        metavar="MS,MS",
        help="from a measurement to the effect of the command (25)",
    )
    margins.add_argument(
        "--servo",
        type=ranges.number(0.0, 100.0, "Hz"),
        default=3.0,
        metavar="HZ",
        help="0 for none",
    )
    margins.add_argument(
        "--weights",
        type=ranges.names(("light", "heavy", "file")),
        default=("file",),
        metavar="NAME,NAME",
        help="light and heavy as in the campaign, or file (default: file)",
    )
    ranges.add_workers(margins)
    ranges.add_files(margins, json="write all figures here", picture="write a picture here")
    margins.set_defaults(run=_margins)
    campaign.add(commands)

    raw_command.add(commands)
    plan_command.add(commands)

    tune = commands.add_parser("tune", help="search gains for an aircraft")
    tune.add_argument(
        "--aircraft",
        required=True,
        choices=list(AIRCRAFT),
        metavar="NAME",
        help=f"one of {', '.join(AIRCRAFT)}",
    )
    tune.add_argument("-o", "--output", type=ranges.file_to_write, required=True, metavar="FILE")
    tune.add_argument(
        "--from",
        dest="given",
        type=Path,
        metavar="FILE",
        help="initial configuration (the aircraft's own, or stock gains)",
    )
    tune.add_argument(
        "--cost",
        default="even",
        metavar="COST",
        help="even, accurate, gentle, or weights, as in altitude_rms_ft=2,movement=1 (%(default)s)",
    )
    tune.add_argument(
        "--search",
        metavar="KEY,KEY",
        help="numbers of the configuration to search (the five of autopilot.scale)",
    )
    tune.add_argument("--seeds", type=seeds, default=(1, 2), metavar="1,2,7-9")
    tune.add_argument("--legs", type=ranges.count, default=2, help="of each flight (%(default)s)")
    tune.add_argument(
        "--turbulence", type=int, default=0, choices=range(8), metavar="0..7", help="severity"
    )
    tune.add_argument(
        "--evaluations",
        type=ranges.count,
        default=120,
        metavar="N",
        help="candidates (%(default)s)",
    )
    ranges.add_workers(tune)
    tune.add_argument(
        "--dask", metavar="ADDRESS", help="fly on a Dask cluster, as in tcp://10.0.0.5:8786"
    )
    tune.set_defaults(run=_tune)

    soaks = commands.add_parser(
        "soak", help="fly for a long time under stress, and compare with the machine's own delays"
    )
    ranges.add_daemon(soaks)
    soaks.add_argument(
        "--minutes",
        type=ranges.number(0.01, 100_000.0, "min"),
        default=30.0,
        help="(default %(default)s)",
    )
    soaks.add_argument("--rate", type=ranges.count, default=100, metavar="HZ", help="(%(default)s)")
    soaks.add_argument("--idle", action="store_true", help="without stress-ng")
    ranges.add_files(soaks, json="write all figures here")
    soaks.set_defaults(run=_soak)

    floods = commands.add_parser(
        "bench-flood", help="fly without and with 100,000 datagrams a second of another host"
    )
    ranges.add_daemon(floods)
    floods.add_argument(
        "--seconds", type=float, default=30.0, metavar="S", help="of each (%(default)s)"
    )
    floods.set_defaults(run=_flood)

    app_timing_command.add(commands)


def _suite(options: argparse.Namespace) -> int:
    from .suite import report  # noqa: PLC0415 - needs the module fcc, which others do not
    from .suite.flying import fly_all  # noqa: PLC0415
    from .suite.matrix import cases  # noqa: PLC0415

    chosen = [
        case
        for case in cases()
        if (case.is_quick or not options.quick)
        and fnmatch.fnmatchcase(case.name, options.only or "*")
    ]
    if not chosen:
        names = "\n  ".join(case.name for case in cases())
        raise ValueError(f"--only '{options.only}' matches no case; there are:\n  {names}")
    flown = {}
    with bar("flying", len(chosen)) as notify:
        for outcome in fly_all(chosen, options.workers):
            flown[outcome.case.name] = outcome
            notify(len(flown), outcome.case.name)
    outcomes = [flown[case.name] for case in chosen]
    say(report.text(outcomes))
    if path := os.environ.get("FCC_MEASURED"):
        seeds = sorted({seed for case in chosen for seed in case.seeds})
        Path(path).write_text("".join(f"seed\t{seed}\n" for seed in seeds))
    if options.json:
        documents.write(options.json, report.document(outcomes))
    if options.picture:
        from .suite.picture import draw  # noqa: PLC0415 - matplotlib takes a second

        draw(options.picture, outcomes)
    return 1 if any(outcome.broken for outcome in outcomes) else 0


def _margins(options: argparse.Namespace) -> int:
    from . import margins  # noqa: PLC0415 - needs the module fcc
    from .margins import report  # noqa: PLC0415 - matplotlib takes a second

    conditions = [
        margins.Condition(name, airspeed_kt, axis, delay_ms / 1e3, options.servo, weight)
        for name in options.aircraft
        for weight in (("" if each == "file" else each) for each in options.weights)
        for delay_ms in options.delays
        for airspeed_kt in options.airspeeds or margins.airspeeds_kt(name, weight)
        for axis in options.axes
    ]
    measured = []
    with bar("measuring", len(conditions)) as notify:
        for found in margins.measure_all(conditions, options.workers):
            measured.append(found)
            notify(len(measured), found.condition.aircraft)
    say(report.text(measured))
    if options.json:
        document = [found.document() for found in measured]
        documents.write(options.json, document)
    if options.picture:
        report.draw(options.picture, measured)
    return 0 if all(found.holds for found in measured) else 1


def _tune(options: argparse.Namespace) -> int:
    from . import tuning  # noqa: PLC0415 - needs the module fcc

    task = tuning.Task(
        aircraft=options.aircraft,
        config=options.given.read_text(encoding="utf-8") if options.given else None,
        keys=tuple(options.search.split(",")) if options.search else tuning.SCALE_KEYS,
        cost=tuning.cost_of(options.cost),
        seeds=options.seeds,
        evaluations=options.evaluations,
        legs=options.legs,
        turbulence=options.turbulence,
    )
    with (
        all_workers(tuning.flight_cost, options.dask, options.workers) as fly_all,
        bar("tuning", task.evaluations) as show,
    ):

        def notify(flown: int, least: float) -> None:
            show(min(flown, task.evaluations), f"cost {least:.3f}")

        found = tuning.tune(task, fly_all, notify)
    head = (
        f"# Tuned for JSBSim's {task.aircraft}: cost '{task.cost.name}' {found.after:.3f}, was "
        f"{found.before:.3f};\n# {found.evaluations} candidates on seeds "
        f"{', '.join(map(str, task.seeds))}.\n\n"
    )
    replacement.write(options.output, head + found.config)
    say(
        f"cost {found.before:.3f} as given, {found.guessed:.3f} by measured responses, "
        f"{found.after:.3f} found in {found.evaluations} candidates",
    )
    for key, value in found.values.items():
        say(f"  {key} = {value:g}")
    say(f"written: {options.output}", to=sys.stderr)
    return 0


def _soak(options: argparse.Namespace) -> int:
    seconds = 60.0 * options.minutes
    task = Soak(options.fccd, seconds, options.rate, not options.idle)
    with bar("flying", round(seconds)) as show:
        result = soak(task, lambda flown_s: show(round(flown_s), "flying"))
    late, machine = result.lateness_us, result.machine
    rows = {
        "ticks": f"{result.ticks}, {result.missed} missed, "
        f"{result.overruns} longer than their budget",
        "late, us": f"{late['p50']:.3f} median, {late['p99']:.3f} p99, "
        f"{late['p99_9']:.1f} p99.9, {late['max']:.0f} max",
        "within 2 %": f"{100.0 * result.within_2_percent:.3f} % of the periods",
        "page faults": f"{result.page_faults}"
        + ("" if result.memory_locked else "; the memory was not locked"),
        "waits": f"{result.voluntary_switches_per_tick:.6f} a tick, one of them for the timer; "
        f"preempted {result.involuntary_switches} times",
        "CPU": f"{result.cpu_percent:.2f} % of a core",
        "cyclictest": f"{machine.cycles} ticks, {machine.periods_lost} periods lost, "
        f"{machine.max_us:.0f} us late at most"
        + (
            ""
            if result.has_own_cpu
            else f"; not bound to the loop's CPU, which is any of {result.cpus}"
        ),
    }
    say(markdown(["what", "figure"], rows.items()))
    failures = result.failures()
    for failure in failures:
        say(f"failed: {failure}", to=sys.stderr)
    if options.json:
        documents.write(options.json, result.document())
    return 1 if failures else 0


def _flood(options: argparse.Namespace) -> int:
    result = flood.fly(flood.Plan(options.fccd, options.seconds))
    more = result.flooded_percent - result.quiet_percent
    print(
        f"{result.per_second:.0f} datagrams a second of others: the daemon takes "
        f"{result.flooded_percent:.2f} % of a core, {more:+.2f} % against "
        f"{result.quiet_percent:.2f} % without; {result.missed} ticks missed"
    )
    failures = result.failures()
    for failure in failures:
        print(f"failed: {failure}", file=sys.stderr)
    return 1 if failures else 0
