"""The score against traces whose figures are known in closed form."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fcc_hil.pattern import Leg
from fcc_hil.score import Samples, Trace, score

RIGHT_AND_UP = Leg(
    start_s=20.0,
    end_s=40.0,
    heading_from_deg=300.0,
    heading_deg=30.0,
    altitude_from_ft=3_000.0,
    altitude_ft=3_150.0,
    airspeed_kt=100.0,
)
LEFT_AND_DOWN = replace(
    RIGHT_AND_UP,
    heading_from_deg=30.0,
    heading_deg=300.0,
    altitude_from_ft=3_150.0,
    altitude_ft=3_000.0,
)


def since_start(leg: Leg, dt_s: float = 0.025) -> Samples:
    return np.arange(0.0, round((leg.end_s - leg.start_s) / dt_s)) * dt_s


def flown(
    leg: Leg,
    heading_error: Samples,
    altitude_error: Samples,
    airspeed_kt: Samples | None = None,
    lateral_g: Samples | None = None,
) -> Trace:
    t = since_start(leg)
    return Trace(
        time_s=leg.start_s + t,
        heading_deg=(leg.heading_deg + heading_error) % 360.0,
        altitude_ft=leg.altitude_ft + altitude_error,
        airspeed_kt=np.full_like(t, leg.airspeed_kt) if airspeed_kt is None else airspeed_kt,
        lateral_g=np.zeros_like(t) if lateral_g is None else lateral_g,
    )


def exponential_rms(start: float, tau: float, begin_s: float, end_s: float) -> float:
    """Return the RMS of start * exp(-t / tau) between two times, by its integral."""
    integral = tau / 2.0 * (math.exp(-2.0 * begin_s / tau) - math.exp(-2.0 * end_s / tau))
    return start * math.sqrt(integral / (end_s - begin_s))


@pytest.mark.parametrize(("leg", "sign"), [(RIGHT_AND_UP, -1.0), (LEFT_AND_DOWN, 1.0)])
def test_first_order_response(leg: Leg, sign: float) -> None:
    t = since_start(leg)
    figures = score(
        flown(leg, sign * 90.0 * np.exp(-t / 4.0), sign * 150.0 * np.exp(-t / 3.0)), [leg]
    )["legs"][0]
    # 90 exp(-t/4) = 2 at 4 ln 45 = 15.227 s, 150 exp(-t/3) = 10 at 3 ln 15 = 8.124 s;
    # the next sample of the 25 ms grid is the answer.
    assert figures["heading_settle_s"] == pytest.approx(15.25)
    assert figures["altitude_settle_s"] == pytest.approx(8.125)
    assert figures["heading_overshoot_deg"] == 0.0
    assert figures["altitude_overshoot_ft"] == 0.0
    assert figures["turn_loss_ft"] == 0.0
    assert figures["heading_rms_deg"] == pytest.approx(
        exponential_rms(90.0, 4.0, 17.0, 20.0), rel=0.01
    )
    assert figures["altitude_rms_ft"] == pytest.approx(
        exponential_rms(150.0, 3.0, 12.0, 20.0), rel=0.01
    )


@pytest.mark.parametrize(("leg", "sign"), [(RIGHT_AND_UP, -1.0), (LEFT_AND_DOWN, 1.0)])
def test_second_order_response_overshoots_by_the_textbook_fraction(leg: Leg, sign: float) -> None:
    # A step response of damping zeta overshoots by exp(-pi zeta / sqrt(1 - zeta^2)):
    # 4.6 % at 0.7, 16.3 % at 0.5.
    t = since_start(leg)

    def error(zeta: float, omega: float) -> Samples:
        damped = omega * math.sqrt(1.0 - zeta * zeta)
        decay: Samples = np.exp(-zeta * omega * t)
        return decay * (np.cos(damped * t) + zeta * omega / damped * np.sin(damped * t))

    figures = score(
        flown(leg, sign * 90.0 * error(0.7, 1.0), sign * 150.0 * error(0.5, 1.0)), [leg]
    )["legs"][0]
    assert figures["heading_overshoot_deg"] == pytest.approx(90.0 * 0.04599, rel=1e-3)
    assert figures["altitude_overshoot_ft"] == pytest.approx(150.0 * 0.16303, rel=1e-3)


def test_ramp_settles_when_it_enters_the_band() -> None:
    # 5 deg/s is 2 deg short at 17.6 s; 10 ft/s is 10 ft short at 14 s.
    t = since_start(RIGHT_AND_UP)
    trace = flown(RIGHT_AND_UP, np.minimum(0.0, -90.0 + 5.0 * t), np.minimum(0, -150.0 + 10.0 * t))
    figures = score(trace, [RIGHT_AND_UP])["legs"][0]
    assert figures["heading_settle_s"] == pytest.approx(17.6, abs=0.03)
    assert figures["altitude_settle_s"] == pytest.approx(14.0, abs=0.03)


def test_leaving_the_band_again_starts_the_wait_again() -> None:
    t = since_start(RIGHT_AND_UP)
    heading = np.where(t < 10.0, -1.0, np.where(t < 12.5, -2.5, 0.5))
    altitude = np.where(t < 19.0, 0.0, 11.0)
    figures = score(flown(RIGHT_AND_UP, heading, altitude), [RIGHT_AND_UP])["legs"][0]
    assert figures["heading_settle_s"] == pytest.approx(12.5)
    assert figures["altitude_settle_s"] is None


def test_height_lost_is_measured_from_the_lower_end_of_the_leg() -> None:
    t = since_start(RIGHT_AND_UP)
    sag = -40.0 * np.exp(-np.square(t - 3.0))
    level = replace(RIGHT_AND_UP, altitude_ft=3_000.0)
    zero = np.zeros_like(t)
    assert score(flown(level, zero, sag), [level])["worst"]["turn_loss_ft"] == pytest.approx(
        40.0, rel=1e-3
    )
    # A climbing leg: 3 s in, it has sagged 40 ft below where it began.
    climb = np.where(t < 6.0, -150.0 + sag, 0.0)
    assert score(flown(RIGHT_AND_UP, zero, climb), [RIGHT_AND_UP])["worst"][
        "turn_loss_ft"
    ] == pytest.approx(40.0, rel=1e-3)
    # A descending leg: what goes below the set point, and that is its overshoot too.
    figures = score(flown(LEFT_AND_DOWN, zero, sag), [LEFT_AND_DOWN])["worst"]
    assert figures["turn_loss_ft"] == pytest.approx(40.0, rel=1e-3)
    assert figures["altitude_overshoot_ft"] == pytest.approx(40.0, rel=1e-3)


def test_turn_the_wrong_way_round_scores_near_180() -> None:
    t = since_start(RIGHT_AND_UP)
    left_270 = -90.0 - 270.0 * t / 20.0
    figures = score(flown(RIGHT_AND_UP, left_270, np.zeros_like(t)), [RIGHT_AND_UP])["worst"]
    assert figures["heading_overshoot_deg"] == pytest.approx(180.0, abs=1.0)


def test_airspeed_and_lateral_figures_are_the_largest_either_way() -> None:
    t = since_start(RIGHT_AND_UP)
    zero = np.zeros_like(t)
    airspeed = 100.0 + 3.0 * np.sin(t) - np.where(np.abs(t - 5.0) < 0.2, 4.5, 0.0)
    trace = flown(RIGHT_AND_UP, zero, zero, airspeed, -0.08 * np.sin(t))
    figures = score(trace, [RIGHT_AND_UP])["worst"]
    assert figures["airspeed_error_kt"] == pytest.approx(7.5, abs=0.05)
    assert figures["lateral_acceleration_g"] == pytest.approx(0.08, rel=1e-3)


def test_worst_is_per_column_and_null_where_any_leg_is() -> None:
    t = since_start(RIGHT_AND_UP)
    second = replace(RIGHT_AND_UP, start_s=40.0, end_s=60.0)
    one = flown(RIGHT_AND_UP, -90.0 * np.exp(-t / 4.0), np.full_like(t, -150.0))
    two = flown(second, -90.0 * np.exp(-t / 2.0), -150.0 * np.exp(-t / 3.0))
    both = Trace(
        *(
            np.concatenate(columns)
            for columns in zip(vars(one).values(), vars(two).values(), strict=True)
        )
    )
    worst = score(both, [RIGHT_AND_UP, second])["worst"]
    assert worst["heading_settle_s"] == pytest.approx(15.25)
    assert worst["altitude_settle_s"] is None
    assert worst["altitude_rms_ft"] == pytest.approx(150.0)


def test_a_flight_that_ended_early_is_refused() -> None:
    t = since_start(RIGHT_AND_UP)
    trace = flown(RIGHT_AND_UP, np.zeros_like(t), np.zeros_like(t))
    beyond = replace(RIGHT_AND_UP, start_s=40.0, end_s=60.0)
    with pytest.raises(ValueError, match=r"from 40\.0 s to 60\.0 s has no samples"):
        score(trace, [RIGHT_AND_UP, beyond])
    with pytest.raises(ValueError, match="ended early"):
        score(trace.between(20.0, 30.0), [RIGHT_AND_UP])


def test_the_case_that_other_implementations_check_against() -> None:
    stored = json.loads((Path(__file__).parent / "data" / "score_case.json").read_text())
    trace = Trace(**{name: np.array(values) for name, values in stored["trace"].items()})
    figures = score(trace, [Leg(**leg) for leg in stored["legs"]])
    found = [dict(leg) for leg in [*figures["legs"], figures["worst"]]]
    expected = [*stored["expected"]["legs"], stored["expected"]["worst"]]
    for leg_found, leg_expected in zip(found, expected, strict=True):
        assert leg_found.keys() == leg_expected.keys()
        for name, value in leg_expected.items():
            if value is None:
                assert leg_found[name] is None, name
            else:
                assert leg_found[name] == pytest.approx(value, rel=1e-9, abs=1e-9), name
