"""Requirements on a flight, checked against the truth: pure functions without clocks.

Each takes samples and returns a verdict with a description of the flight. Times are seconds since
engagement.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .quantities import Condition, Quantity, Samples

_TIME_TOLERANCE_S = 1e-6
"""Sums of ticks and of frames are not exact."""


@dataclass(frozen=True)
class Verdict:
    """Whether a requirement is met, and a description of the flight."""

    is_met: bool
    flown: str


@dataclass(frozen=True)
class Stretch:
    """A stretch of a flight: times, a quantity, and its target."""

    quantity: Quantity
    time_s: Samples
    values: Samples
    targets: Samples

    @property
    def errors(self) -> Samples:
        """Return the errors, in the quantity's unit."""
        return self.quantity.difference(self.values, self.targets)

    def at(self, index: int) -> str:
        """Describe one sample and its error."""
        quantity = self.quantity
        return (
            f"at {self.time_s[index]:.2f} s {quantity} is {quantity.words(self.values[index])}, "
            f"{quantity.words(float(self.errors[index]))} off"
        )


def settles(stretch: Stretch, within: float, by_s: float) -> Verdict:
    """Whether nothing is more than `within` off from `by_s` on."""
    is_outside = np.abs(stretch.errors) > within
    late = np.flatnonzero(is_outside & (stretch.time_s >= by_s - _TIME_TOLERANCE_S))
    outside = np.flatnonzero(is_outside)
    if len(outside) == 0:
        return Verdict(is_met=True, flown="it is never outside")
    last = int(outside[-1])
    if last + 1 < len(stretch.time_s):
        settled = f"it is inside to stay from {stretch.time_s[last + 1]:.2f} s on"
    else:
        settled = f"it is still outside at {stretch.time_s[last]:.2f} s, where what is flown ends"
    if len(late) == 0:
        return Verdict(is_met=True, flown=settled)
    return Verdict(is_met=False, flown=f"{stretch.at(int(late[0]))}; {settled}")


def stays(stretch: Stretch, within: float) -> Verdict:
    """Whether nothing is more than `within` off."""
    errors = np.abs(stretch.errors)
    worst = int(np.argmax(errors))
    outside = np.flatnonzero(errors > within)
    if len(outside) == 0:
        return Verdict(is_met=True, flown=f"at most: {stretch.at(worst)}")
    first = int(outside[0])
    worst_words = "" if worst == first else f"; at worst: {stretch.at(worst)}"
    return Verdict(is_met=False, flown=f"{stretch.at(first)}{worst_words}")


def overshoots_less_than(stretch: Stretch, limit: float, change: float) -> Verdict:
    """Whether nothing is `limit` or more past the target, in the direction of its change.

    If the target did not change, either direction counts.
    """
    errors = stretch.errors
    past = np.abs(errors) if change == 0.0 else errors * np.sign(change)
    worst = int(np.argmax(past))
    beyond = max(0.0, float(past[worst]))
    if beyond == 0.0:
        return Verdict(is_met=limit > 0.0, flown="it does not overshoot")
    words = f"by {stretch.quantity.words(beyond, 2)}: {stretch.at(worst)}"
    return Verdict(is_met=beyond < limit, flown=words)


def passes(time_s: Samples, away_m: Samples, within: float) -> Verdict:
    """Whether something is so near at any time."""
    index = int(np.argmin(away_m))
    words = f"it comes within {away_m[index]:.1f} m of it, at {time_s[index]:.2f} s"
    return Verdict(is_met=bool(away_m[index] <= within), flown=words)


def all_below(values: Sequence[tuple[str, float, float | None, str]]) -> Verdict:
    """Whether no value is farther from 0 than its limit: names, values, limits and units."""
    words = ", ".join(f"{name} {value:.1f} {unit}" for name, value, _, unit in values)
    is_met = all(limit is None or abs(value) <= limit for _, value, limit, _ in values)
    return Verdict(is_met, words)


def never(condition: Condition, time_s: Samples, values: Samples) -> Verdict:
    """Whether a condition is met at no sample."""
    quantity = condition.quantity
    extreme = int(np.argmax(values) if condition.side == "above" else np.argmin(values))
    most = f"{quantity.words(float(values[extreme]))} at {time_s[extreme]:.2f} s"
    hits = np.flatnonzero(condition.holds(values))
    if len(hits) == 0:
        return Verdict(is_met=True, flown=f"{quantity} comes to {most}")
    return Verdict(
        is_met=False,
        flown=f"{quantity} is {condition.side} it from {time_s[hits[0]]:.2f} s on, "
        f"and comes to {most}",
    )
