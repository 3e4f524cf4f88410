"""The healthy campaign: what it draws, what it counts, what it judges, and its command."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import fcc
import numpy as np
import pytest

from fcc_hil import __main__ as commands
from fcc_hil.campaign import airspeed
from fcc_hil.campaign.alarms import Alarm, alarms_of
from fcc_hil.campaign.draw import Fault, Flight, draw, usual_bounds
from fcc_hil.campaign.flying import config_of, fly
from fcc_hil.campaign.verdict import Flown, judge
from fcc_hil.plant import Weather
from fcc_hil.rig import Event
from fcc_hil.truth import COLUMNS, TRUTH_HZ, Truth

BOUNDS = usual_bounds("healthy")
DRAWN = [draw(number, 7, BOUNDS) for number in range(600)]
KT, FT, DEG = 0.514444, 0.3048, np.pi / 180.0


@pytest.mark.parametrize(
    ("channel", "sigma"),
    [
        ("roll_rad", 1.0 * DEG),
        ("pitch_rad", 1.0 * DEG),
        ("roll_rate_radps", 0.5 * DEG),
        ("pitch_rate_radps", 0.5 * DEG),
        ("yaw_rate_radps", 0.5 * DEG),
        ("specific_force_x_mps2", 0.1),
        ("specific_force_y_mps2", 0.1),
        ("specific_force_z_mps2", 0.1),
        ("airspeed_mps", 2.0 * KT),
        ("altitude_m", 30.0 * FT),
        ("heading_rad", 3.0 * DEG),
    ],
)
def test_biases_are_normal_with_the_sigma_of_the_requirement(channel: str, sigma: float) -> None:
    biases = np.array([flight.biases[channel] for flight in DRAWN]) / sigma
    # Four standard errors of 600 draws.
    assert np.std(biases) == pytest.approx(1.0, abs=4.0 / (2.0 * 600.0) ** 0.5)
    assert np.mean(biases) == pytest.approx(0.0, abs=4.0 / 600.0**0.5)
    assert np.mean(np.abs(biases) < 1.0) == pytest.approx(0.683, abs=0.08)


def test_each_configuration_is_accepted() -> None:
    for flight in DRAWN[:50]:
        fcc.Config(config_of(flight))


def test_conditions_are_those_of_the_requirement() -> None:
    assert {flight.aircraft for flight in DRAWN} == {"c172p", "c172r", "c172x", "c182", "J3Cub"}
    assert {flight.weather.turbulence_severity for flight in DRAWN} == {0, 1, 2, 3, 4, 5}
    for values, most in (
        ([flight.delay_ms for flight in DRAWN], 150.0),
        ([flight.weather.wind_kt for flight in DRAWN], 25.0),
        ([flight.noise for flight in DRAWN if not flight.steps], 2.0),
        ([flight.weather.wind_from_deg for flight in DRAWN], 360.0),
    ):
        assert 0.0 <= min(values) < 0.05 * most
        assert 0.95 * most < max(values) <= most + 1e-9
        assert np.mean(values) == pytest.approx(0.5 * most, abs=0.06 * most)
    assert all(flight.fault is None and not flight.gusts for flight in DRAWN)
    for share, holds in (
        (1 / 4, [flight.seconds == 600.0 for flight in DRAWN]),
        (1 / 2, [flight.measures_position for flight in DRAWN]),
        (1 / 2, [flight.measures_trim for flight in DRAWN]),
        (1 / 6, [bool(flight.steps) and flight.noise == 0.0 for flight in DRAWN]),
        (1 / 6, [bool(flight.steps) and flight.noise > 0.0 for flight in DRAWN]),
    ):
        assert np.mean(holds) == pytest.approx(share, abs=0.07)
    assert {flight.seconds for flight in DRAWN} == {310.0, 600.0}
    assert {flight.steps.get("airspeed") for flight in DRAWN} == {None, 0.1, 0.5, 1.0}
    assert {flight.steps.get("heading") for flight in DRAWN} == {None, 1.0}
    steps_ft = {flight.steps["altitude"] for flight in DRAWN if "altitude" in flight.steps}
    assert min(steps_ft) == 1.0
    assert max(steps_ft) == 100.0


def test_set_points_are_those_of_the_requirement() -> None:
    # Each reads a configuration.
    flown = {flight.aircraft: flight.limits for flight in DRAWN}
    limits = {name: (one.slowest_order_kt, one.fastest_order_kt) for name, one in flown.items()}
    for flight in DRAWN:
        times_s = [order.time_s for order in flight.orders]
        gaps_s = np.diff([0.0, *times_s])
        assert min(gaps_s) >= 8.0
        assert max(gaps_s) <= 45.0 + 8.0
        assert times_s[-1] == flight.seconds - 75.0
        slowest_kt, fastest_kt = limits[flight.aircraft]
        stall_kt = flight.stall_kt
        for order in flight.orders:
            assert order.heading_deg is None or 0.0 <= order.heading_deg < 360.0
            assert order.climb_ft is None or abs(order.climb_ft) <= 1_500.0
            kt = order.airspeed_kt
            assert kt is None or slowest_kt <= kt <= fastest_kt
            assert kt is None or kt >= 1.3 * stall_kt


def test_the_same_number_and_seed_are_the_same_flight() -> None:
    assert draw(3, 7, BOUNDS) == DRAWN[3]
    assert draw(3, 8, BOUNDS) != DRAWN[3]
    short = replace(draw(1, 7, BOUNDS), seconds=20.0, orders=())
    first, second = (fly(short)[0] for _ in range(2))
    assert first.digest == second.digest
    assert first.digest != fly(replace(short, number=6))[0].digest


def _flight(severity: int = 0, **changes: object) -> Flight:
    weather = Weather(turbulence_severity=severity)
    plain = replace(DRAWN[0], aircraft="c172p", seconds=100.0, steps={}, weather=weather)
    return replace(plain, **changes)  # type: ignore[arg-type]


def _truth(**columns: float) -> Truth:
    level = {"altitude_ft": 3_000.0, "height_ft": 3_000.0, "airspeed_kt": 100.0, "load_g": 1.0}
    values = level | {"throttle": 0.6} | columns
    return Truth(
        [
            tuple({**values, "time_s": tick / TRUTH_HZ}.get(name, 0.0) for name in COLUMNS)
            for tick in range(100 * TRUTH_HZ + 1)
        ]
    )


def _flown(
    shown: dict[str, float] | None = None,
    alarms: tuple[Alarm, ...] = (),
    changes_s: tuple[float, ...] = (),
) -> Flown:
    level = {"heading": 0.0, "altitude": 3_000.0, "airspeed": 100.0}
    ticks = np.ones(100 * TRUTH_HZ)
    return Flown(
        {name: value * ticks for name, value in (level | (shown or {})).items()},
        {name: value * ticks for name, value in level.items()},
        changes_s,
        (),
        alarms,
    )


@pytest.mark.parametrize(
    ("severity", "columns", "kind"),
    [
        (0, {"airspeed_kt": 30.0}, "below Vs"),
        (5, {"angle_of_attack_deg": 16.6}, "stall"),
        (0, {"airspeed_kt": 161.0}, "above Vne"),
        (0, {"roll_deg": 38.5}, "bank"),
        (3, {"roll_deg": 45.5}, "bank"),
        (4, {"roll_deg": -52.5}, "bank"),
        (5, {"roll_deg": 60.5}, "bank"),
        (0, {"load_g": 2.31}, "load"),
        (0, {"load_g": -0.01}, "load"),
        (0, {"height_ft": 40.0}, "ground"),
    ],
)
def test_what_is_not_clean_is_found(severity: int, columns: dict[str, float], kind: str) -> None:
    flight = _flight(severity)
    assert judge(flight, _truth(), _flown()).is_clean
    assert set(judge(flight, _truth(**columns), _flown()).broken) == {kind}


@pytest.mark.parametrize(
    ("severity", "columns"),
    [
        (0, {"angle_of_attack_deg": 16.4}),
        (0, {"roll_deg": 37.5, "load_g": 2.25}),
        (3, {"roll_deg": 44.5, "load_g": 2.5}),
        (4, {"roll_deg": 51.5}),
        (5, {"roll_deg": 59.5}),
    ],
)
def test_what_is_within_the_limits_is_clean(severity: int, columns: dict[str, float]) -> None:
    assert judge(_flight(severity), _truth(**columns), _flown()).is_clean


@pytest.mark.parametrize(("severity", "times"), [(0, 1.0), (3, 2.0), (4, 4.0), (5, 8.0)])
@pytest.mark.parametrize(
    ("name", "set_point", "off"),
    [("heading", 0.0, 3.0), ("altitude", 3_000.0, 15.0), ("airspeed", 100.0, 4.0)],
)
def test_set_points_are_held_within_the_limits_times_the_turbulence(
    severity: int, times: float, name: str, set_point: float, off: float
) -> None:
    for by, broken in ((0.95, set()), (1.05, {name})):
        shown = _flown({name: set_point - by * times * off})
        assert set(judge(_flight(severity), _truth(), shown).broken) == broken


def test_lack_of_power_and_a_climb_are_no_error() -> None:
    slow = _flown({"airspeed": 90.0})
    assert judge(_flight(), _truth(throttle=1.0), slow).is_clean
    # Full throttle above the set point is no lack of power.
    fast = _flown({"airspeed": 110.0})
    assert set(judge(_flight(), _truth(throttle=1.0), fast).broken) == {"airspeed"}
    # 965 ft/min at most: 1,500 ft take 93 s.
    assert judge(_flight(), _truth(), _flown({"altitude": 1_500.0}, changes_s=(5.0,))).is_clean
    low = _flown({"altitude": 2_900.0}, changes_s=(5.0,))
    assert set(judge(_flight(), _truth(), low).broken) == {"altitude"}


def test_a_step_of_a_sensor_adds_its_half() -> None:
    flight = _flight(steps={"altitude": 100.0})
    assert judge(flight, _truth(), _flown({"altitude": 2_940.0})).is_clean
    assert not judge(flight, _truth(), _flown({"altitude": 2_930.0})).is_clean


def test_alarms_have_channel_reason_and_duration() -> None:
    doubted = "airspeed contradicts the other sensors and is not used"
    events = [
        Event(0.0, "standby -> engaged"),
        Event(5.0, "now: recovering from an upset"),
        Event(10.0, "airspeed of sensor 1 is excluded: it is higher than forces; flying on"),
        Event(10.0, f"now: {doubted}"),
        Event(40.0, f"no longer: {doubted}; now: oscillation: gain is reduced"),
        Event(50.0, "engaged -> failsafe: heading is frozen"),
        Event(55.0, "failsafe -> engaged"),
        Event(60.0, "the elevator does not move the aircraft: climbing by the throttle"),
        Event(90.0, "release sent to the actuators"),
    ]
    frozen = frozenset({"heading is frozen"})
    faults = [(0.0, frozenset[str]()), (50.0, frozen), (53.0, frozenset[str]())]
    found = [
        (it.kind, it.channel, it.begins_s, it.ends_s) for it in alarms_of(events, faults, 90.0)
    ]
    assert found == [
        ("exclusion", "airspeed", 10.0, 40.0),
        ("failsafe", "", 50.0, 55.0),
        ("exclusion", "heading", 50.0, 53.0),
        ("surface", "elevator", 60.0, None),
        ("release", "", 90.0, None),
    ]
    reasons = [alarm.reason for alarm in alarms_of(events, faults, 90.0)]
    assert reasons[0] == "it is higher than forces"
    assert reasons[1] == "heading is frozen"


def test_conditions_with_commas_are_told_from_a_list_of_them() -> None:
    attitude = "attitude contradicts body rates, forces and heading and is not used"
    altitude = "altitude contradicts the other sensors and is not used"
    events = [
        Event(2.0, f"now: {attitude}, {altitude}"),
        Event(4.0, f"now: recovering from an upset; no longer: {attitude}"),
    ]
    found = [(it.channel, it.ends_s) for it in alarms_of(events, [], 20.0)]
    assert found == [("attitude", 4.0), ("altitude", None)]


def test_a_condition_that_is_in_no_table_counts() -> None:
    (alarm,) = alarms_of([Event(3.0, "now: altitude is odd")], [], 20.0)
    assert (alarm.kind, alarm.channel, alarm.lasted_s) == ("exclusion", "altitude", 17.0)


def test_the_command_says_what_flies_a_flight_again(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    figures, results = tmp_path / "healthy.json", tmp_path / "healthy.md"
    asked = ["campaign", "--healthy", "--first", "1", "--flights", "1", "--workers", "1"]
    written = ["--json", str(figures), "--results", str(results), "--least-clean", "0"]
    assert commands.main([*asked, *written]) == 0
    said = capsys.readouterr().out
    assert "flights with an exclusion, failsafe or release" in said
    assert "fcc campaign --healthy" in results.read_text(encoding="utf-8")
    (flown,) = json.loads(figures.read_text(encoding="utf-8"))["flights"]
    assert flown["command"] == "fcc campaign --flight 1 --seed 1 --healthy"
    commands.main(flown["command"].split()[1:])
    assert f"digest {flown['digest']}" in capsys.readouterr().out


def test_a_blocked_tube_is_measured() -> None:
    bounds = usual_bounds("airspeed")
    flights = [draw(number, 7, bounds) for number in range(12)]
    tubes = [flight for flight in flights if flight.fault and flight.fault.lasts_s is None]
    assert [tube.fault.begins_s for tube in tubes if tube.fault] == [4.0, 28.0, 58.0] * 2
    others = [flight.fault for flight in flights if flight not in tubes]
    # Long enough after it is good again to be used again within 60 s.
    assert all(flight.seconds >= 60.0 + 40.0 + 60.0 for flight in flights if flight not in tubes)
    assert all(order.time_s < it.seconds for it in flights for order in it.orders)
    assert all(fault and 20.0 <= (fault.lasts_s or 0.0) <= 40.0 for fault in others)
    flight = _flight(fault=Fault("airspeed wrong for a time", 10.0, 30.0, 20.0))
    flight = replace(flight, biases=flight.biases | {"airspeed_mps": 0.0})
    excluded = Alarm("exclusion", "airspeed", "", 13.0, 52.0, 100.0)
    assert flight.fault is not None
    flown = _flown(alarms=(excluded,))
    found = airspeed.figures(flight, flight.fault, _truth(), flown)
    assert np.isnan(found["excluded_after_s"])
    flown.shown["airspeed"][10 * TRUTH_HZ : 40 * TRUTH_HZ] = 120.0
    found = airspeed.figures(flight, flight.fault, _truth(), flown)
    # More than 10 kt on average of half a second is 0.25 s after the beginning.
    assert found["excluded_after_s"] == pytest.approx(13.0 - 10.25, abs=0.06)
    assert found["taken_back_after_s"] == pytest.approx(12.0)


def test_by_raw_sensors_it_is_the_same_flight() -> None:
    for number in range(8):
        measured = draw(number, 3, BOUNDS)
        raw = draw(number, 3, replace(BOUNDS, raw_sensors="phone"))
        assert (raw.noise, raw.biases, raw.steps, raw.sensor_delay_ticks) == (1.0, {}, {}, 0)
        assert raw.has_receiver == measured.measures_position
        same = ("loading", "airspeed_kt", "weather", "orders", "seconds", "measures_trim")
        assert [getattr(raw, name) for name in same] == [getattr(measured, name) for name in same]
