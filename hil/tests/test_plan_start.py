"""Where a flight with a plan begins."""

from __future__ import annotations

from pathlib import Path

import pytest

from fcc_hil import plan_file, plan_start
from fcc_hil.settings import Settings


@pytest.mark.parametrize(
    ("home", "first", "bearing_deg"),
    [
        # By Napier's rules of a right spherical triangle: tan 1 degree = sin 0.5 x tan a, ...
        ((0.0, 179.5), (0.5, -179.5), 63.4),
        ((0.0, -179.5), (0.5, 179.5), 296.6),
        # ... and along a parallel half of the convergence of the meridians, 0.2 x sin 60 degrees.
        ((60.0, 179.9), (60.0, -179.9), 89.9),
        ((-60.0, -179.9), (-60.0, 179.9), 269.9),
        ((60.0, 8.0), (60.0, 8.2), 89.9),
    ],
)
def test_the_aircraft_begins_towards_the_first_place(
    tmp_path: Path, home: tuple[float, float], first: tuple[float, float], bearing_deg: float
) -> None:
    """Also across 180 degrees of longitude; the ellipsoid is within 0.2 degrees of the sphere."""
    plan = tmp_path / "leg.waypoints"
    plan.write_text(
        "QGC WPL 110\n"
        f"0 1 0 16 0 0 0 0 {home[0]} {home[1]} 900 1\n"
        f"1 0 0 16 0 0 0 0 {first[0]} {first[1]} 900 1\n"
    )
    begins = plan_start.settings(plan_file.read(plan), Settings())
    assert begins.heading_deg == pytest.approx(bearing_deg, abs=0.2)
