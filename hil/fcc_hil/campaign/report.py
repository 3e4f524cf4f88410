"""A campaign's outcomes as text and as JSON."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from typing import Any

from ..table import markdown
from . import airspeed
from .alarms import EXCLUSION, FAILSAFE, RELEASE, SURFACE, Alarm
from .draw import WRONG, Bounds, Fault, Flight
from .flying import Outcome
from .verdict import BROKEN

_EASY_MS, _EASY_TURBULENCE = 75.0, 4
_TAKEN_BACK_S = 60.0


def clean_share(outcomes: Sequence[Outcome]) -> float:
    """Return the share of flights in which nothing was broken."""
    return sum(outcome.verdict.is_clean for outcome in outcomes) / max(1, len(outcomes))


def tables(outcomes: Sequence[Outcome]) -> str:
    """Return the figures, the alarms by reason, and the clean flights by group."""
    parts = [_figures(outcomes), _reasons(outcomes)]
    groups: tuple[tuple[str, Callable[[Flight], str]], ...] = (
        ("aircraft", lambda flight: flight.aircraft),
        ("turbulence", lambda flight: str(flight.weather.turbulence_severity)),
        ("delay", _delay),
        ("satellite navigation", lambda flight: "measured" if flight.has_receiver else "none"),
        ("steps", lambda flight: ", ".join(flight.steps) or "none"),
        ("fault", lambda flight: flight.fault.what if flight.fault else "none"),
    )
    parts += [_groups(title, outcomes, group_of) for title, group_of in groups]
    return "\n\n".join(parts)


def flights(outcomes: Sequence[Outcome]) -> str:
    """Return each flight that is not clean, or has an alarm though nothing fails."""
    return "\n\n".join(
        failure(it)
        for it in outcomes
        if not it.verdict.is_clean or (it.alarms and it.flight.fault is None)
    )


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
    parts = [
        f"{flight.aircraft}, {flight.loading.weight_lb:.0f} lb",
        f"{flight.airspeed_kt:.0f} kt ({flight.airspeed_kt / flight.stall_kt:.2f} Vs)",
        f"turbulence {flight.weather.turbulence_severity}",
        f"{flight.delay_ms:.0f} ms late",
        "no servos" if servo_hz is None else f"servos of {servo_hz:.1f} Hz",
        f"noise {flight.noise:.1f}",
        "satellite navigation" if flight.has_receiver else "no satellite navigation",
        "trim measured" if flight.measures_trim else "trim not measured",
        *(f"{name} in steps of {step:g}" for name, step in flight.steps.items()),
        "orders" if flight.pattern is None else "timed pattern",
    ]
    biases = "".join(
        f" {channel.rpartition('_')[0]} {sds:+.1f}"
        for channel, sds in flight.biases_in_sigma.items()
    )
    parts.append("biases in 1 sd:" + (biases or " the sensors' own"))
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


def _figures(outcomes: Sequence[Outcome]) -> str:
    """Return the table of the first figures."""
    hours = sum(outcome.simulated_s for outcome in outcomes) / 3_600.0
    alarms = [alarm for outcome in outcomes for alarm in outcome.alarms]
    stopping = (EXCLUSION, FAILSAFE, RELEASE)
    alarmed = sum(any(it.kind in stopping for it in outcome.alarms) for outcome in outcomes)
    failed = sum(any(it.kind == SURFACE for it in outcome.alarms) for outcome in outcomes)
    counts = Counter(alarm.kind for alarm in alarms)
    easy = [
        it
        for it in outcomes
        if it.flight.delay_ms <= _EASY_MS
        and it.flight.weather.turbulence_severity <= _EASY_TURBULENCE
    ]
    back, lasted = _taken_back(alarms)
    grounded = sum("ground" in outcome.verdict.broken for outcome in outcomes)
    judged = sum("heading_rms" in outcome.verdict.figures for outcome in outcomes)
    rows = [
        ["flights; flight hours", f"{len(outcomes)}; {hours:.1f}"],
        [
            "flights with an exclusion, failsafe or release",
            f"{alarmed}; {_rate(alarmed, hours)} per flight hour",
        ],
        *(
            [f"{kind}s", f"{counts[kind]}; {_rate(counts[kind], hours)} per flight hour"]
            for kind in stopping
        ),
        [
            "flights with a surface called jammed, reversed or without effect",
            f"{failed}; {_rate(failed, hours)} per flight hour",
        ],
        ["into the ground", str(grounded)],
        ["clean, all", _share(outcomes)],
        [f"clean, to {_EASY_MS:g} ms and turbulence {_EASY_TURBULENCE}", _share(easy)],
        [f"excluded airspeeds taken back within {_TAKEN_BACK_S:g} s", f"{back} of {lasted}"],
        ["flights of which it is judged what is held", str(judged)],
        [
            "processor time of a flight",
            f"{sum(it.cpu_s for it in outcomes) / max(1, len(outcomes)):.1f} s",
        ],
    ]
    of_faults = [
        (it.flight, it.verdict.figures)
        for it in outcomes
        if it.flight.fault and it.flight.bounds.kind == "airspeed"
    ]
    return markdown(["figure", ""], rows + (airspeed.rows(of_faults) if of_faults else []))


def _taken_back(alarms: Sequence[Alarm]) -> tuple[int, int]:
    """Return how many excluded airspeeds were taken back in time, and of how many it is known."""
    airspeeds = [it for it in alarms if (it.kind, it.channel) == (EXCLUSION, "airspeed")]
    back = sum(it.ends_s is not None and it.lasted_s <= _TAKEN_BACK_S for it in airspeeds)
    lasted = sum(it.ends_s is None and it.lasted_s <= _TAKEN_BACK_S for it in airspeeds)
    return back, len(airspeeds) - lasted


def _rate(count: int, hours: float) -> str:
    return f"{count / hours:.2f}" if hours else "0"


def _share(outcomes: Sequence[Outcome]) -> str:
    clean = sum(outcome.verdict.is_clean for outcome in outcomes)
    return f"{100.0 * clean_share(outcomes):.1f} %; {clean} of {len(outcomes)}"


def _reasons(outcomes: Sequence[Outcome]) -> str:
    """Return the alarms by kind, channel and reason, the most frequent first."""
    alarms: dict[tuple[str, str, str], list[tuple[Outcome, Alarm]]] = {}
    for outcome in outcomes:
        for alarm in outcome.alarms:
            key = (alarm.kind, alarm.channel, alarm.reason)
            alarms.setdefault(key, []).append((outcome, alarm))
    rows = [
        [
            *key,
            len(its),
            sum(alarm.ends_s is not None for _, alarm in its),
            sum(alarm.into_ground for _, alarm in its),
            sum(not outcome.verdict.is_clean for outcome, _ in its),
            " ".join(str(outcome.flight.number) for outcome, _ in its[:10]),
        ]
        for key, its in sorted(alarms.items(), key=lambda item: -len(item[1]))
    ]
    head = ["alarm", "channel", "reason", "number", "ended", "into the ground", "not clean"]
    return markdown([*head, "flights"], rows)


def _groups(title: str, outcomes: Sequence[Outcome], group_of: Callable[[Flight], str]) -> str:
    """Return how many flights of each group are clean, and how many broke what."""
    kinds = [kind for kind in BROKEN if any(kind in it.verdict.broken for it in outcomes)]
    rows = []
    groups = sorted({group_of(outcome.flight) for outcome in outcomes})
    for group in (*groups, "all"):
        its = [it for it in outcomes if group in ("all", group_of(it.flight))]
        counts = [sum(kind in it.verdict.broken for it in its) for kind in kinds]
        rows.append([group, len(its), f"{100.0 * clean_share(its):.0f} %", *counts])
    return markdown([title, "flights", "clean", *kinds], rows)
