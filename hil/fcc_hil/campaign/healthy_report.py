"""The outcomes of a healthy campaign as text."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence

from . import airspeed
from .alarms import EXCLUSION, FAILSAFE, RELEASE, SURFACE, Alarm
from .flying import Outcome
from .healthy import HealthyFlight
from .report import failure, markdown, table
from .set_points import BROKEN

_EASY_MS, _EASY_TURBULENCE = 75.0, 4
_TAKEN_BACK_S = 60.0


def tables(outcomes: Sequence[Outcome]) -> str:
    """Return the figures, the alarms by reason, and the clean flights by group."""
    parts = [figures(outcomes), _reasons(outcomes)]
    groups: tuple[tuple[str, Callable[[HealthyFlight], str]], ...] = (
        ("aircraft", lambda flight: flight.aircraft),
        ("turbulence", lambda flight: str(flight.weather.turbulence_severity)),
        ("position", lambda flight: "measured" if flight.measures_position else "none"),
        ("steps", lambda flight: ", ".join(flight.steps) or "none"),
    )
    parts += [table(title, outcomes, group_of, BROKEN) for title, group_of in groups]
    return "\n\n".join(parts)


def flights(outcomes: Sequence[Outcome]) -> str:
    """Return each flight with an alarm, or not clean."""
    return "\n\n".join(failure(it) for it in outcomes if not it.verdict.is_clean or it.alarms)


def figures(outcomes: Sequence[Outcome]) -> str:
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
        ["flights of which the last 30 s are judged", str(judged)],
        [
            "processor time of a flight",
            f"{sum(it.cpu_s for it in outcomes) / max(1, len(outcomes)):.1f} s",
        ],
    ]
    of_faults = [(it.flight, it.verdict.figures) for it in outcomes if it.flight.fault]
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
    return f"{100.0 * clean / max(1, len(outcomes)):.1f} %; {clean} of {len(outcomes)}"


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
