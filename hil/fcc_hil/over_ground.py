"""Requirements on where a flight goes: past the places of its plan, and onto its runway."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable

from . import flown_plan, plan_score
from .plan_file import PlanFile
from .quantities import finite
from .quantities import positive as _positive
from .quantities import seconds as _seconds
from .requirements import Verdict, all_below, passes
from .rig import FlightError, Rig
from .tangent_plane import away_m
from .truth import TRUTH_HZ, Truth

_STEP_S = 5.0
"""What is flown between two looks at where the aircraft is."""
_STANDS_MPS = 0.5


class OverGroundRequirements(ABC):
    """The part of a flight that concerns the ground."""

    rig: Rig
    plan: PlanFile | None
    """The plan that is flown, if there is one."""

    @property
    @abstractmethod
    def engaged_at_s(self) -> float:
        """Return when it engaged, in s since the aircraft was set up."""

    @property
    @abstractmethod
    def time_s(self) -> float:
        """Return how far the test has flown since engagement."""

    @abstractmethod
    def _fly_to(self, time_s: float) -> None: ...

    @abstractmethod
    def _hold(self, required: str, verdict: Verdict, *, events: bool = False) -> None: ...

    def passes(self, waypoint: int | tuple[float, float], *, within: float, by: float) -> None:
        """Require that it comes within `within` m of a place, by `by` s after engagement.

        The place is that of an item of the plan, by its number, or latitude and longitude in
        degrees. What is flown ends up to 5 s behind it.
        """
        __tracebackhide__ = True
        within, by = _positive("within", within), _seconds("by", by)
        words, latitude_deg, longitude_deg = self._place(waypoint)
        verdict = self._fly_until(
            by, lambda truth: self._passes(truth, (latitude_deg, longitude_deg), within)
        )
        self._hold(f"the aircraft passes {words} within {within:g} m by {by:g} s", verdict)

    def lands(
        self,
        *,
        by: float,
        centre_line: float | None = None,
        sink: float | None = None,
        heading: float | None = None,
        along: float | None = None,
    ) -> None:
        """Require that it stands on the plan's runway by `by` s after engagement.

        Where its wheels touch, it is at most `centre_line` m off the centre line and `along` m off
        the place that the plan gives, sinks with at most `sink` ft/min, and points at most
        `heading` degrees off the runway.
        """
        __tracebackhide__ = True
        by = _seconds("by", by)
        given = {"centre_line": centre_line, "sink": sink, "heading": heading, "along": along}
        limits = {name: v if v is None else _positive(name, v) for name, v in given.items()}
        if self.plan is None:
            raise FlightError('there is no plan: @pytest.mark.autopilot(mode="plan", plan=...)')
        plan = self.plan
        verdict = self._fly_until(by, lambda truth: _lands(truth, plan, limits))
        units = {"centre_line": "m", "sink": "ft/min", "heading": "°", "along": "m"}
        within = [f"{name} {v:g} {units[name]}" for name, v in limits.items() if v is not None]
        required = f"the aircraft lands by {by:g} s" + ", ".join(["", *within]).replace(
            ", ", ": ", 1
        )
        self._hold(required, verdict, events=True)

    def _place(self, waypoint: object) -> tuple[str, float, float]:
        if isinstance(waypoint, tuple):
            latitude, longitude = (finite("waypoint", value) for value in waypoint)
            return f"{latitude:.6f}°, {longitude:.6f}°", latitude, longitude
        items = () if self.plan is None else self.plan.items
        found = [item for item in items if item.number == waypoint and item.has_place]
        if not found:
            numbers = ", ".join(str(item.number) for item in items if item.has_place) or "none"
            raise ValueError(f"no item {waypoint} of the plan has a place: those are {numbers}")
        return f"item {waypoint}", found[0].latitude_deg, found[0].longitude_deg

    def _passes(self, truth: Truth, place: tuple[float, float], within: float) -> Verdict:
        time_s = truth["time_s"] - self.engaged_at_s
        track = (truth["latitude_deg"], truth["longitude_deg"])
        return passes(time_s, away_m(*place, track), within)

    def _fly_until(self, by: float, judge: Callable[[Truth], Verdict]) -> Verdict:
        """Fly on until a verdict on what was flown since engagement is met, or it is too late."""
        while True:
            verdict = judge(self.rig.truth().since(self.engaged_at_s))
            if verdict.is_met or self.time_s >= by:
                return verdict
            self._fly_to(self.engaged_at_s + min(self.time_s + _STEP_S, by))


def _lands(truth: Truth, plan: PlanFile, limits: dict[str, float | None]) -> Verdict:
    flown = flown_plan.of_truth(truth)
    score = plan_score.score_landing(plan, flown, 0)
    # Half a second of its way.
    moves = flown_plan.moved_m(flown, rows=TRUTH_HZ // 2) > _STANDS_MPS / 2.0
    if score is None or moves:
        place = "on the ground, and moves" if score is not None else "not on the plan's runway"
        return Verdict(is_met=False, flown=f"it is {place} at the end")
    return all_below(
        [
            ("off the centre line", score.centre_line_m, limits["centre_line"], "m"),
            ("sink", score.sink_fpm, limits["sink"], "ft/min"),
            ("off the heading", score.heading_error_deg, limits["heading"], "°"),
            ("along the runway", score.along_m, limits["along"], "m"),
        ]
    )
