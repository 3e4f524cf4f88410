"""A flight under test: flies, and checks requirements on the flight.

    flight.engages(by=3)
    flight.flies(to=20)
    flight.settles(heading, within=2, by=17)
    flight.overshoots_less_than(heading, 1.5)

An assertion checks the flight so far, and continues the flight if it concerns a later time. It uses
the aircraft's true state, never the sensors or the autopilot. Times are simulated seconds: `to`,
`from_` and `since` count from engagement, `by` from the event that it belongs to.

In real time the simulator continues while a test runs its own code. A test's flight ends where the
test has flown it to, so the result is the same in either case.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from . import flown_plan, plan_score
from .faulty_sensors import SensorFault
from .pattern import SetPoints, TimedPattern
from .plan_file import PlanFile
from .quantities import Condition, Quantity, Samples, finite, quantity_of
from .quantities import positive as _positive
from .quantities import seconds as _seconds
from .requirements import (
    Stretch,
    Verdict,
    all_below,
    never,
    overshoots_less_than,
    passes,
    settles,
    stays,
)
from .rig import ENGAGED, FAILSAFE, RELEASED, Event, FlightError, Rig
from .sensor_faults import Faults
from .tangent_plane import away_m
from .truth import TRUTH_HZ, Truth

STATES = ("standby", "engaged", "failsafe", "stopped")

_ROW_S = 1.0 / TRUTH_HZ
_TOLERANCE_S = 1e-6
_LAST_HAPPENINGS = 6
_SET_POINTS = ("heading", "altitude", "airspeed")
_STEP_S = 5.0
"""What is flown between two looks at where the aircraft is over the ground."""
_STANDS_MPS = 0.5


class RequirementError(AssertionError):
    """A requirement is not met: the requirement, and the flight."""


@dataclass(frozen=True)
class Leg:
    """A stretch of constant set points; times since engagement."""

    start_s: float
    end_s: float
    before: SetPoints
    points: SetPoints


class Flight:
    """One flight of an aircraft by the autopilot."""

    def __init__(
        self, rig: Rig, pattern: TimedPattern | None, seed: int = 1, plan: PlanFile | None = None
    ) -> None:
        """Fly on a rig; `pattern` is the autopilot's pattern, None to hold or with a plan."""
        self.rig = rig
        self.pattern = pattern
        self.plan = plan
        self.faults = Faults(lambda: rig.time_s, rig.set_faults, seed)
        self._is_prepared = False
        self._engaged_at_s: float | None = None
        self._captured: SetPoints | None = None
        # How far the test has flown, since the aircraft was set up.
        self._flown_to_s = 0.0

    def __repr__(self) -> str:
        return f"<Flight of {self.rig.name}: {self.state} at {self._flown_to_s:.2f} s>"

    # Flying.

    @property
    def state(self) -> str:
        """Return the autopilot's state: one of STATES."""
        changes = [h.text for h in self.rig.events if " -> " in h.text]
        return changes[-1].partition(" -> ")[2].partition(":")[0] if changes else STATES[0]

    @property
    def engaged_at_s(self) -> float:
        """Return when it engaged, in s since the aircraft was set up."""
        if self._engaged_at_s is None:
            raise FlightError("the autopilot is not engaged yet: call flight.engages(by=3) first")
        return self._engaged_at_s

    @property
    def time_s(self) -> float:
        """Return how far the test has flown since engagement."""
        return self._flown_to_s - self.engaged_at_s

    @property
    def captured(self) -> SetPoints:
        """Return the state at engagement, which gave the set points."""
        if self._captured is None:
            self._captured = self.rig.truth().captured_at(self.engaged_at_s)
        return self._captured

    def truth(self) -> Truth:
        """Return the true state so far, in s since the aircraft was set up."""
        return self.rig.truth()

    def flies(self, seconds: float | None = None, *, to: float | None = None) -> None:
        """Fly for so many seconds, or until so many after engagement."""
        if (seconds is None) == (to is None):
            raise TypeError("give how long to fly, flies(20), or to when, flies(to=20)")
        if to is not None:
            self._fly_to(self.engaged_at_s + _seconds("to", to))
        else:
            self._prepare()
            self._fly_to(self._flown_to_s + _seconds("seconds", seconds))

    def switches_off(self) -> None:
        """Switch the engage switch off."""
        self.rig.set_switch(on=False)

    # What the autopilot does.

    def engages(self, *, by: float) -> None:
        """Require that the autopilot engages within `by` s after the switch goes on."""
        __tracebackhide__ = True
        by = _seconds("by", by)
        self._prepare()
        switched_s = self.rig.time_s
        self.rig.set_switch(on=True)
        found = self._await(ENGAGED, switched_s, switched_s + by)
        flown = f"it is still {self.state} {by:g} s after the switch went on"
        if found is not None:
            self._engaged_at_s, self._captured = found.time_s, None
            flown = f"it engages after {found.time_s - switched_s:.2f} s"
        is_met = found is not None and found.time_s <= switched_s + by + _TOLERANCE_S
        self._hold(f"the autopilot engages by {by:g} s", Verdict(is_met, flown), events=True)

    def falls_into_failsafe(self, *, by: float, after: SensorFault | float | None = None) -> None:
        """Require a failsafe within `by` s after a fault, a time, or now."""
        __tracebackhide__ = True
        by = _seconds("by", by)
        since_s, words = self._since(after)
        found = self._await(FAILSAFE, since_s, since_s + by, self.rig.failsafe_shows_after_s)
        required = f"the autopilot enters failsafe by {by:g} s after {words}"
        self._hold(required, self._judge(found, since_s, by), events=True)

    def releases(self, *, by: float, after: SensorFault | float | None = None) -> None:
        """Require that the controls are centred and released within `by` s."""
        __tracebackhide__ = True
        by = _seconds("by", by)
        since_s, words = self._since(after)
        found = self._await(RELEASED, since_s, since_s + by)
        verdict = self._judge(found, since_s, by)
        if verdict.is_met and self.rig.not_centred:
            verdict = Verdict(is_met=False, flown=self.rig.not_centred)
        required = f"the controls are centred and released by {by:g} s after {words}"
        self._hold(required, verdict, events=True)

    # What the aircraft does.

    def settles(
        self,
        quantity: Quantity | str,
        *,
        within: float,
        by: float,
        at: float | None = None,
        since: float | None = None,
        for_: float = 3.0,
    ) -> None:
        """Require that it comes within `within` of its set point, and stays there.

        From `by` s after the last change of the set point (or after `since`) on, for `for_` s and
        until the end of the flight so far. `at` replaces the set point.
        """
        __tracebackhide__ = True
        quantity, within = quantity_of(quantity), _positive("within", within)
        by, for_ = _seconds("by", by), _seconds("for_", for_)
        leg = self._leg(self.time_s)
        since_s = leg.start_s if since is None else _seconds("since", since)
        ends_s = np.inf if at is not None else leg.end_s - _ROW_S
        if since_s + by > ends_s:
            raise ValueError(
                f"by is {by:g} s: the set points change again {ends_s - since_s + _ROW_S:g} s "
                "after they last did"
            )
        self._fly_to(self.engaged_at_s + min(since_s + by + for_, ends_s))
        stretch = self._stretch(quantity, at, since_s, min(self.time_s, ends_s))
        self._hold(
            f"{quantity} settles within {quantity.words(within)} of {_target(stretch, at)} "
            f"by {by:g} s after {since_s:g} s",
            settles(stretch, within, since_s + by),
        )

    def stays(
        self,
        quantity: Quantity | str,
        *,
        within: float,
        at: float | None = None,
        from_: float = 0.0,
        to: float | None = None,
    ) -> None:
        """Require that it stays within `within` of its set point from one time to another.

        By default from engagement until now; `at` replaces the set point.
        """
        __tracebackhide__ = True
        quantity, within = quantity_of(quantity), _positive("within", within)
        from_, to = self._span(from_, to)
        stretch = self._stretch(quantity, at, from_, to)
        self._hold(
            f"{quantity} stays within {quantity.words(within)} of {_target(stretch, at)} "
            f"from {from_:g} s to {to:g} s",
            stays(stretch, within),
        )

    def overshoots_less_than(
        self, quantity: Quantity | str, limit: float, *, since: float | None = None
    ) -> None:
        """Require that it goes less than `limit` past its set point since the last change."""
        __tracebackhide__ = True
        quantity, limit = quantity_of(quantity), _positive("limit", limit)
        leg = self._leg(self.time_s if since is None else _seconds("since", since))
        stretch = self._stretch(quantity, None, leg.start_s, min(self.time_s, leg.end_s - _ROW_S))
        before = _set_point(quantity, leg.before)
        change = float(quantity.difference(np.array(_set_point(quantity, leg.points)), before))
        self._hold(
            f"{quantity} overshoots {_target(stretch, None)} by less than {quantity.words(limit)}",
            overshoots_less_than(stretch, limit, change),
        )

    def never(self, what: Condition | str, *, from_: float = 0.0, to: float | None = None) -> None:
        """Require that a condition, `abs(bank) > 35`, or a state, "failsafe", never occurs."""
        __tracebackhide__ = True
        if isinstance(what, str):
            if what not in STATES:
                raise ValueError(f"there is no state {what!r}; choose one of {', '.join(STATES)}")
            from_, to = self._span(from_, to)
            came = [h for h in self._events(from_, to) if f" -> {what}" in h.text]
            flown = f"{came[0].text} at {self._since_engaged(came[0]):.2f} s" if came else ""
            required = f"the autopilot is never in {what} from {from_:g} s to {to:g} s"
            self._hold(required, Verdict(not came, flown))
            return
        if not isinstance(what, Condition):
            raise TypeError(f"never {what!r}: give a condition, abs(bank) > 35, or a state's name")
        from_, to = self._span(from_, to)
        stretch = self._stretch(what.quantity, 0.0, from_, to)
        required = f"{what} never from {from_:g} s to {to:g} s"
        self._hold(required, never(what, stretch.time_s, stretch.values))

    # Where it goes over the ground.

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

    # How it is done.

    def _prepare(self) -> None:
        if not self._is_prepared:
            self.rig.prepare()
            self._is_prepared = True
            self._flown_to_s = max(self._flown_to_s, self.rig.time_s)

    def _fly_to(self, time_s: float) -> None:
        if time_s > self._flown_to_s:
            self.rig.fly_to(time_s)
            self._flown_to_s = time_s

    def _find(self, text: str, since_s: float) -> Event | None:
        for happening in self.rig.events:
            if happening.time_s >= since_s - _TOLERANCE_S and happening.text.startswith(text):
                return happening
        return None

    def _await(
        self, text: str, since_s: float, until_s: float, later_s: float = 0.0
    ) -> Event | None:
        """Fly on until an event begins with `text`, or it is too late."""
        found = self._find(text, since_s)
        if found is None:
            # A late event is reported, too.
            self.rig.fly_to(until_s + later_s + 1.0, lambda: self._find(text, since_s) is not None)
            found = self._find(text, since_s)
        seen_s = until_s if found is None else found.time_s
        self._flown_to_s = max(self._flown_to_s, seen_s)
        return found

    def _since(self, after: SensorFault | float | None) -> tuple[float, str]:
        if after is None:
            return self._flown_to_s, f"{self.time_s:.2f} s"
        if isinstance(after, SensorFault):
            return after.begins_s, f"{after.words} at {after.begins_s - self.engaged_at_s:.2f} s"
        after = _seconds("after", after)
        return self.engaged_at_s + after, f"{after:g} s"

    def _judge(self, found: Event | None, since_s: float, by: float) -> Verdict:
        if found is None:
            return Verdict(is_met=False, flown=f"it is {self.state} {by:g} s later")
        after_s = found.time_s - since_s
        is_met = after_s <= by + _TOLERANCE_S
        return Verdict(is_met, f"{found.text}, {after_s:.2f} s later")

    def _span(self, from_: object, to: object | None) -> tuple[float, float]:
        """Return a span since engagement; fly to its end."""
        start_s = _seconds("from_", from_)
        end_s = self.time_s if to is None else _seconds("to", to)
        if end_s < start_s:
            raise ValueError(f"from {start_s:g} s to {end_s:g} s: the end is before the start")
        self._fly_to(self.engaged_at_s + end_s)
        return start_s, end_s

    def _leg(self, since_engaged_s: float) -> Leg:
        pattern, captured = self.pattern, self.captured
        if pattern is None:
            return Leg(0.0, np.inf, captured, captured)
        begun = pattern.legs_begun(since_engaged_s + _TOLERANCE_S)
        start_s = 0.0 if begun == 0 else pattern.hold_s + (begun - 1) * pattern.leg_s
        points = pattern.set_points(start_s + _TOLERANCE_S, captured)
        before = pattern.set_points(max(0.0, start_s - _ROW_S), captured)
        return Leg(start_s, pattern.hold_s + begun * pattern.leg_s, before, points)

    def _stretch(self, quantity: Quantity, at: float | None, from_s: float, to_s: float) -> Stretch:
        truth = self.rig.truth()
        time_s = truth["time_s"] - self.engaged_at_s
        shown = (time_s >= from_s - _TOLERANCE_S) & (time_s <= to_s + _TOLERANCE_S)
        if not np.any(shown):
            raise FlightError(f"nothing was flown from {from_s:g} s to {to_s:g} s")
        values = quantity.of(truth.__getitem__)[shown]
        if at is not None:
            targets: Samples = np.full(len(values), finite("at", at))
        else:
            pattern, captured = self.pattern, self.captured
            points = [
                captured
                if pattern is None
                else pattern.set_points(max(0.0, float(t)) + _TOLERANCE_S, captured)
                for t in time_s[shown]
            ]
            targets = np.array([_set_point(quantity, point) for point in points])
        return Stretch(quantity, time_s[shown], values, targets)

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

    def _since_engaged(self, happening: Event) -> float:
        return happening.time_s - self.engaged_at_s

    def _events(self, from_s: float, to_s: float) -> list[Event]:
        return [h for h in self.rig.events if from_s < self._since_engaged(h) <= to_s]

    def _hold(self, required: str, verdict: Verdict, *, events: bool = False) -> None:
        __tracebackhide__ = True
        if verdict.is_met:
            return
        lines = [f"required: {required}", f"flown:    {verdict.flown}"]
        if events:
            log = [f"{h.time_s:.2f} s {h.text}" for h in self.rig.events]
            lines.append("events:   " + ("; ".join(log[-_LAST_HAPPENINGS:]) or "nothing"))
        raise RequirementError("\n".join(lines))


def _set_point(quantity: Quantity, points: SetPoints) -> float:
    if quantity.name not in _SET_POINTS:
        raise ValueError(
            f"guidance sets no {quantity.name}: give at=..., or ask for one of "
            f"{', '.join(_SET_POINTS)}"
        )
    value = {
        "heading": points.heading_deg,
        "altitude": points.altitude_ft,
        "airspeed": points.airspeed_kt,
    }[quantity.name]
    return value * quantity.units[quantity.unit]


def _target(stretch: Stretch, at: float | None) -> str:
    first, last = float(stretch.targets[0]), float(stretch.targets[-1])
    if at is None and first != last:
        return "its set point"
    return stretch.quantity.words(last)


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
