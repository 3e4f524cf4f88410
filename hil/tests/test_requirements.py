"""Requirements on flights with known samples: a rig that replays functions."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fcc_hil import airspeed, altitude, attitude, bank, heading, throttle
from fcc_hil.faulty_sensors import SensorFault
from fcc_hil.flight import Flight, RequirementError
from fcc_hil.pattern import TimedPattern
from fcc_hil.quantities import QUANTITIES, Quantity
from fcc_hil.rig import ENGAGED, FAILSAFE, RELEASED, Event, FlightError
from fcc_hil.truth import COLUMNS, Row, Truth

ENGAGED_AT_S = 1.0
PATTERN = TimedPattern(hold_s=10.0, leg_s=10.0, turn_deg=90.0, climb_ft=100.0)

Flown = Callable[[float], float]


class TableRig:
    """Flies functions of the time since engagement."""

    name = "a table"
    failsafe_shows_after_s = 0.0
    holds_control = True

    def __init__(self, coming: Sequence[Event] = (), **flown: Flown) -> None:
        self.time_s = 0.0
        self.events: list[Event] = []
        self.not_centred = ""
        self._coming = [Event(ENGAGED_AT_S, ENGAGED), *coming]
        self._flown = flown
        self._rows: list[Row] = [self._row()]

    def prepare(self) -> None:
        self.fly_to(0.5)

    def set_switch(self, *, on: bool) -> None:
        pass

    def fly_to(self, time_s: float, until: Callable[[], bool] | None = None) -> None:
        while self.time_s < time_s - 1e-6 and not (until is not None and until()):
            self.time_s = round((self.time_s + 0.025) * 40.0) / 40.0
            self._rows.append(self._row())
            self.events = [h for h in self._coming if h.time_s <= self.time_s]

    def set_faults(self, faults: Sequence[SensorFault]) -> None:
        pass

    def truth(self) -> Truth:
        return Truth(self._rows)

    def save_recording(self, path: Path) -> list[Path]:  # noqa: ARG002
        return []

    def close(self) -> None:
        pass

    def _row(self) -> Row:
        level: dict[str, Flown] = {
            "time_s": lambda t: t + ENGAGED_AT_S,
            "altitude_ft": lambda _: 3_000.0,
            "airspeed_kt": lambda _: 100.0,
        }
        since_s = self.time_s - ENGAGED_AT_S
        columns: dict[str, Flown] = {**level, **self._flown}
        return tuple(columns[name](since_s) if name in columns else 0.0 for name in COLUMNS)


def _flight(*coming: Event, pattern: TimedPattern | None = PATTERN, **flown: Flown) -> Flight:
    flight = Flight(TableRig(coming, **flown), pattern)
    flight.engages(by=1.0)
    return flight


def _turn(t: float) -> float:
    """Turn at 15 degrees a second from 10 s on, 4 past the set point, and back by 18 s."""
    if t < 10.0:
        return 0.0
    if t < 16.0:
        return 15.0 * (t - 10.0)
    return 90.0 + (4.0 * math.sin(math.pi * (t - 16.0) / 2.0) if t < 18.0 else 0.0)


def test_a_heading_settles_when_it_stays_inside() -> None:
    flight = _flight(heading_deg=_turn)
    flight.flies(to=10)
    # 4 sin(pi/2 (t - 16)) is 2 at 16 1/3 s and at 17 2/3 s.
    flight.settles(heading, within=2, by=7.675, for_=1)
    with pytest.raises(RequirementError) as refused:
        flight.settles(heading, within=2, by=7.65, for_=1)
    assert str(refused.value).splitlines() == [
        "required: heading settles within 2.0 deg of 90.0 deg by 7.65 s after 10 s",
        "flown:    at 17.65 s heading is 92.1 deg, 2.1 deg off; "
        "it is inside to stay from 17.68 s on",
    ]


def test_a_value_that_leaves_again_has_not_settled() -> None:
    flight = _flight(heading_deg=lambda t: 90.0 if 11.0 < t < 18.0 else 0.0)
    flight.flies(to=10)
    flight.settles(heading, within=2, by=2, for_=1)
    flight.flies(to=19.5)
    with pytest.raises(RequirementError, match=r"still outside at 19\.50 s"):
        flight.settles(heading, within=2, by=2, for_=1)


def test_an_overshoot_is_past_the_set_point_in_the_turns_direction() -> None:
    flight = _flight(heading_deg=_turn)
    flight.flies(to=19.9)
    flight.overshoots_less_than(heading, 4.01)
    with pytest.raises(RequirementError, match=r"by 4\.00 deg: at 17\.00 s heading is 94\.0 deg"):
        flight.overshoots_less_than(heading, 4)
    with pytest.raises(RequirementError, match=r"overshoots 1\.5708 rad|overshoots 1\.6 rad"):
        flight.overshoots_less_than(heading("rad"), 0.069)


def test_short_of_the_set_point_is_no_overshoot() -> None:
    flight = _flight(altitude_ft=lambda t: 3_000.0 if t < 10.0 else 3_090.0)
    flight.flies(to=19)
    flight.overshoots_less_than(altitude, 0.1)


def test_staying_follows_the_set_points_and_counts_in_the_unit_asked() -> None:
    flight = _flight(altitude_ft=lambda t: 3_010.0 if t < 10.0 else 3_110.0, pattern=PATTERN)
    flight.stays(altitude, within=0.1, to=19.9)
    flight = _flight(altitude_ft=lambda t: 3_000.0 if t < 5.0 else 3_010.0, pattern=None)
    flight.stays(altitude, within=10.1, to=9)
    flight.stays(altitude("m"), within=3.1, to=9)
    with pytest.raises(RequirementError) as refused:
        flight.stays(altitude("m"), within=3, to=9)
    assert str(refused.value).splitlines() == [
        "required: altitude stays within 3.0 m of 914.4 m from 0 s to 9 s",
        "flown:    at 5.00 s altitude is 917.4 m, 3.0 m off",
    ]
    flight.stays(altitude, at=3_010, within=1, from_=5)


def test_headings_are_compared_the_short_way_round() -> None:
    flight = _flight(heading_deg=lambda t: 359.0 if t < 0.0 else (359.0 + 2.0 * (t % 2)) % 360.0)
    flight.stays(heading, within=5, at=1, to=9)
    with pytest.raises(RequirementError, match="off"):
        flight.stays(heading, within=5, at=180, to=9)


def test_a_heading_that_never_settles_has_no_time() -> None:
    flight = _flight(roll_deg=lambda t: -5.0 * t, throttle=lambda _: 0.5)
    flight.flies(to=7)
    flight.never(abs(bank) > 35.1)
    flight.never(bank > 0.1)
    flight.never(throttle < 0.4)
    with pytest.raises(RequirementError) as refused:
        flight.never(abs(bank) > 30)
    assert str(refused.value).splitlines() == [
        "required: |bank| above 30.0 deg never from 0 s to 7 s",
        "flown:    |bank| is above it from 6.03 s on, and comes to 35.0 deg at 7.00 s",
    ]
    flight.never(abs(bank) > 30, to=6)


def test_states_are_awaited_and_judged_by_their_time() -> None:
    flight = _flight(
        Event(4.0, f"{FAILSAFE}: airspeed is missing or too old"),
        Event(6.0, "failsafe -> standby"),
        Event(6.0, RELEASED),
    )
    flight.flies(to=2.5)
    fault = flight.faults.loss(airspeed)
    assert fault.begins_s == 3.5
    flight.falls_into_failsafe(by=0.5, after=fault)
    assert flight.state == "failsafe"
    flight.releases(by=2.5, after=fault)
    assert flight.state == "standby"
    with pytest.raises(RequirementError) as refused:
        flight.falls_into_failsafe(by=0.4, after=fault)
    assert str(refused.value).splitlines() == [
        "required: the autopilot enters failsafe by 0.4 s after loss of airspeed at 2.50 s",
        "flown:    engaged -> failsafe: airspeed is missing or too old, 0.50 s later",
        "events:   1.00 s standby -> engaged; 4.00 s engaged -> failsafe: airspeed is missing or "
        "too old; 6.00 s failsafe -> standby; 6.00 s release sent to the actuators",
    ]
    with pytest.raises(RequirementError, match=r"failsafe: airspeed .* at 3\.00 s"):
        flight.never("failsafe")
    with pytest.raises(RequirementError, match="it is standby 1 s later"):
        flight.falls_into_failsafe(by=1)


def test_controls_released_while_deflected_are_a_failure() -> None:
    rig = TableRig([Event(3.0, RELEASED)])
    flight = Flight(rig, None)
    flight.engages(by=1)
    rig.not_centred = "released with elevator +0.20"
    with pytest.raises(RequirementError, match=r"elevator \+0\.20"):
        flight.releases(by=5)


def test_an_autopilot_that_does_not_engage_in_time() -> None:
    with pytest.raises(RequirementError) as refused:
        Flight(TableRig(), PATTERN).engages(by=0.4)
    assert str(refused.value).splitlines() == [
        "required: the autopilot engages by 0.4 s",
        "flown:    it engages after 0.50 s",
        "events:   1.00 s standby -> engaged",
    ]


def test_invalid_requirements_are_refused() -> None:
    flight = Flight(TableRig(), PATTERN)
    with pytest.raises(FlightError, match="engages"):
        flight.settles(heading, within=1, by=1)
    flight.engages(by=1)
    with pytest.raises(ValueError, match="sets no bank: give at="):
        flight.stays(bank, within=1)
    with pytest.raises(ValueError, match="not a single number"):
        flight.stays(attitude, within=1, at=0)
    with pytest.raises(ValueError, match="change again 10 s"):
        flight.settles(heading, within=1, by=11)
    with pytest.raises(ValueError, match="is before the start"):
        flight.stays(heading, within=1, from_=5, to=4)
    with pytest.raises(ValueError, match="no state 'panic'"):
        flight.never("panic")
    with pytest.raises(TypeError, match=r"a condition for flight.never"):
        flight.never(10 < bank < 20)
    with pytest.raises(TypeError, match="give a condition"):
        flight.never(None)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match=r"flies\(20\)"):
        flight.flies()


nonsense: st.SearchStrategy[object] = st.one_of(
    st.sampled_from([math.nan, math.inf, -math.inf, "2", None, [], True]),
    st.floats(max_value=0.0, exclude_max=True, allow_infinity=False),
)


@given(
    value=nonsense,
    ask=st.sampled_from(
        [
            ("within", lambda f, v: f.settles(heading, within=v, by=5)),
            ("by", lambda f, v: f.settles(heading, within=2, by=v)),
            ("for_", lambda f, v: f.settles(heading, within=2, by=5, for_=v)),
            ("within", lambda f, v: f.stays(altitude, within=v)),
            ("from_", lambda f, v: f.stays(altitude, within=1, from_=v)),
            ("limit", lambda f, v: f.overshoots_less_than(heading, v)),
            ("by", lambda f, v: f.falls_into_failsafe(by=v)),
            ("by", lambda f, v: f.releases(by=v)),
            ("by", lambda f, v: f.engages(by=v)),
            ("to", lambda f, v: f.flies(to=v) if v is not None else f.flies(to="")),
        ]
    ),
)
def test_invalid_amounts_are_refused_by_name(
    value: object, ask: tuple[str, Callable[[Flight, object], None]]
) -> None:
    name, call = ask
    flight = Flight(TableRig(), None)
    flight.engages(by=1)
    with pytest.raises((TypeError, ValueError), match=f"^{name} is "):
        call(flight, value)


@given(quantity=st.sampled_from(list(QUANTITIES.values())), unit=st.text(max_size=5))
def test_units_that_are_not_its_own_are_refused(quantity: Quantity, unit: str) -> None:
    if unit in quantity.units:
        return
    with pytest.raises(ValueError, match=f"{quantity.name} is measured in "):
        quantity(unit)


@given(limit=st.sampled_from([math.nan, math.inf, "3", None]))
def test_limits_that_are_not_finite_are_refused(limit: float) -> None:
    with pytest.raises((TypeError, ValueError), match=r"^limit is "):
        _ = bank > limit
