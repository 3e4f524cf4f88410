"""A campaign's outcomes as text and as JSON."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from .draw import Bounds, Fault, Flight
from .flying import Outcome
from .healthy import WRONG, HealthyFlight
from .verdict import KINDS


def clean_share(outcomes: Sequence[Outcome]) -> float:
    """Return the share of flights in which nothing was broken."""
    return sum(outcome.verdict.is_clean for outcome in outcomes) / len(outcomes)


def text(outcomes: Sequence[Outcome]) -> str:
    """Return the tables, then every flight that is not clean with the command that repeats it."""
    parts = [
        table("aircraft", outcomes, lambda flight: flight.aircraft),
        table("turbulence", outcomes, lambda flight: str(flight.weather.turbulence_severity)),
        table("delay", outcomes, _delay),
        table("fault", outcomes, lambda flight: flight.fault.what if flight.fault else "none"),
    ]
    bad = [outcome for outcome in outcomes if not outcome.verdict.is_clean]
    parts += [failure(outcome) for outcome in bad]
    clean = len(outcomes) - len(bad)
    parts.append(
        f"{clean} of {len(outcomes)} flights clean, {100.0 * clean_share(outcomes):.1f} %; "
        f"{sum(outcome.simulated_s for outcome in outcomes):.0f} s flown in "
        f"{sum(outcome.cpu_s for outcome in outcomes):.0f} s of processor time"
    )
    return "\n\n".join(parts)


def failure(outcome: Outcome) -> str:
    """Return what broke in a flight, its conditions and the command that flies it again."""
    broken = outcome.verdict.broken
    words = "; ".join(f"{kind}: {broken[kind]}" for kind in broken) or "clean"
    lines = [conditions(outcome.flight), words, *(alarm.words for alarm in outcome.alarms)]
    lines += [f"refused at {refused}" for refused in outcome.refused]
    return "\n    ".join([outcome.command, *lines])


def conditions(flight: Flight) -> str:
    """Return the conditions of a flight in a line."""
    servo_hz, fault = flight.actuation.servo_hz, flight.fault
    receiver = flight.receiver
    parts = [
        f"{flight.aircraft}, {flight.loading.weight_lb:.0f} lb",
        f"{flight.airspeed_kt:.0f} kt ({flight.airspeed_kt / flight.stall_kt:.2f} Vs)",
        f"turbulence {flight.weather.turbulence_severity}",
        f"{flight.delay_ms:.0f} ms late",
        "no servos" if servo_hz is None else f"servos of {servo_hz:.1f} Hz",
    ]
    if isinstance(flight, HealthyFlight):
        parts += [
            f"noise {flight.noise:.1f}",
            "position" if flight.measures_position else "no position",
            "trim measured" if flight.measures_trim else "trim not measured",
            *(f"{name} in steps of {step:g}" for name, step in flight.steps.items()),
            "biases in 1 sd:",
        ]
        parts[-1] += (
            "".join(
                f" {channel.rpartition('_')[0]} {sds:+.1f}"
                for channel, sds in flight.biases_in_sigma.items()
            )
            or " the sensors' own"
        )
    else:
        parts += [
            "no receiver" if receiver is None else f"receiver of {receiver.rate_hz:.0f} Hz",
            "timed pattern" if flight.is_pattern else "orders",
        ]
    vertical = [gust.down_mps for gust in flight.gusts]
    if vertical:
        # Plus zero, because a rounded -0 looks like an error.
        speeds = ", ".join(f"{round(mps, 1) + 0.0:+.1f}" for mps in vertical)
        parts.append(f"gusts of {speeds} m/s (positive down)")
    if fault is not None:
        lasts = "" if fault.lasts_s is None else f" for {fault.lasts_s:.1f} s"
        parts.append(f"{fault.what}{_amount(fault)} at {fault.begins_s:.0f} s{lasts}")
    return ", ".join(parts)


def _amount(fault: Fault) -> str:
    """Return how much, of those faults that have an amount."""
    if fault.what in ("airspeed biased", WRONG):
        return f" by {fault.amount:+.1f} kt"
    return f" ({100.0 * fault.amount:.0f} %)" if fault.what == "samples lost" else ""


def document(outcomes: Sequence[Outcome], seed: int, bounds: Bounds) -> dict[str, Any]:
    """Return it for JSON."""
    return {
        "seed": seed,
        "delay_ms": bounds.delay_ms,
        "turbulence": bounds.turbulence,
        "kind": bounds.kind,
        "raw_sensors": bounds.raw_sensors,
        "clean_share": clean_share(outcomes),
        "flights": [outcome.document() for outcome in outcomes],
    }


def _delay(flight: Flight) -> str:
    least = 25 * int(flight.delay_ms // 25)
    return f"{least:3} to {least + 25} ms"


def table(
    title: str,
    outcomes: Sequence[Outcome],
    group_of: Callable[[Any], str],
    of_kinds: Sequence[str] = KINDS,
) -> str:
    """Return how many flights of each group are clean, and how many broke what."""
    kinds = [kind for kind in of_kinds if any(kind in it.verdict.broken for it in outcomes)]
    rows = []
    groups = sorted({group_of(outcome.flight) for outcome in outcomes})
    for group in (*groups, "all"):
        its = [it for it in outcomes if group in ("all", group_of(it.flight))]
        counts = [sum(kind in it.verdict.broken for it in its) for kind in kinds]
        rows.append([group, len(its), f"{100.0 * clean_share(its):.0f} %", *counts])
    return markdown([title, "flights", "clean", *kinds], rows)


def markdown(head: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    """Return a table whose columns are aligned."""
    cells = [list(map(str, row)) for row in (head, *rows)]
    widths = [max(len(row[i]) for row in cells) for i in range(len(head))]
    lines = [
        "| " + " | ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)) + " |"
        for row in cells
    ]
    lines.insert(1, "|" + "|".join("-" * (width + 2) for width in widths) + "|")
    return "\n".join(lines)
