"""The timed pattern's set points at the times that the thesis names."""

from __future__ import annotations

import pytest

from fcc_hil.pattern import SetPoints, TimedPattern

CAPTURED = SetPoints(heading_deg=350.0, altitude_ft=3_000.0, airspeed_kt=100.0)


@pytest.mark.parametrize(
    ("since_engaged_s", "heading_deg", "altitude_ft"),
    [
        (0.0, 350.0, 3_000.0),
        (19.99, 350.0, 3_000.0),
        (20.0, 80.0, 3_150.0),
        (39.99, 80.0, 3_150.0),
        (40.0, 170.0, 3_000.0),
        (60.0, 260.0, 3_150.0),
        (80.0, 350.0, 3_000.0),
        (179.9, 350.0, 3_000.0),
    ],
)
def test_set_points(since_engaged_s: float, heading_deg: float, altitude_ft: float) -> None:
    aim = TimedPattern().set_points(since_engaged_s, CAPTURED)
    assert (aim.heading_deg, aim.altitude_ft) == pytest.approx((heading_deg, altitude_ft))
    assert aim.airspeed_kt == 100.0


def test_legs_join_where_the_set_points_change() -> None:
    pattern = TimedPattern()
    legs = pattern.legs(8, 3.0, CAPTURED)
    assert [leg.start_s for leg in legs] == [23.0 + 20.0 * i for i in range(8)]
    for leg in legs:
        before = pattern.set_points(leg.start_s - 3.0 - 1e-6, CAPTURED)
        during = pattern.set_points(leg.start_s - 3.0, CAPTURED)
        assert (leg.heading_from_deg, leg.altitude_from_ft) == pytest.approx(
            (before.heading_deg, before.altitude_ft)
        )
        assert (leg.heading_deg, leg.altitude_ft) == pytest.approx(
            (during.heading_deg, during.altitude_ft)
        )
    assert legs[-1].end_s == 3.0 + pattern.duration_s(8)
