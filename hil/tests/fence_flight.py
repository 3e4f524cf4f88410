"""A flight with JSBSim in lockstep, by raw sensors, straight on against a round fence."""

from __future__ import annotations

from dataclasses import dataclass

import engaged
import numpy as np

from fcc_hil.plant import Plant, Weather
from fcc_hil.rig import FlightError
from fcc_hil.tangent_plane import Plane

RADIUS_M = 4_000.0
LATITUDE_DEG, LONGITUDE_DEG = 47.0, 8.0
_ALTITUDE_M = 914.4
_TURNED = "the fence is near"
_AFTER_S = 240.0
"""For so long after it has turned away it is followed on its way home."""
_LONGEST_S = 180.0
_FENCED = """QGC WPL 110
0 0 0 16 0 0 0 0 {latitude} {longitude} {altitude} 1
1 0 0 17 0 0 1000 0 {latitude} {longitude} {altitude} 1
2 0 0 5003 {radius} 0 0 0 {latitude} {longitude} 0 1
"""


@dataclass(frozen=True)
class FenceScore:
    """How a fence was kept, by the truth."""

    nearest_m: float
    """How far inside of it the aircraft stayed; negative if it crossed it."""
    bank_max_deg: float
    home_m: float
    """How far from home it was in the end."""


def fly(
    seed: int, *, course_deg: float, wind_from_deg: float, wind_kt: float, turbulence: int
) -> FenceScore:
    """Fly from the centre against the fence; raises FlightError if it does not turn away."""
    plan = _FENCED.format(
        latitude=LATITUDE_DEG, longitude=LONGITUDE_DEG, altitude=_ALTITUDE_M, radius=RADIUS_M
    )
    machine = engaged.machine(plan, wind_kt, mode="hold")
    plant = Plant(
        "c172p",
        seed=seed,
        weather=Weather(
            wind_from_deg=wind_from_deg, wind_kt=wind_kt, turbulence_severity=turbulence
        ),
        heading_deg=course_deg,
        latitude_deg=LATITUDE_DEG,
        longitude_deg=LONGITUDE_DEG,
    )
    rig = engaged.engage(plant, machine, seed)
    rows: list[tuple[float, float, float]] = []
    begun_s = rig.time_s
    turned_s: float | None = None

    def keep() -> bool:
        nonlocal turned_s
        state = plant.state()
        rows.append((state.latitude_rad, state.longitude_rad, state.roll_rad))
        if turned_s is None and any(event.text.startswith(_TURNED) for event in rig.events):
            turned_s = rig.time_s
        is_late = turned_s is None and rig.time_s > begun_s + _LONGEST_S
        is_home = turned_s is not None and rig.time_s > turned_s + _AFTER_S
        return is_late or is_home or not rig.holds_control

    rig.fly_to(rig.time_s + _LONGEST_S + _AFTER_S, keep)
    if turned_s is None or not rig.holds_control:
        raise FlightError(engaged.last_events(rig))
    latitude, longitude, roll = np.array(rows).T
    north_east = Plane(np.radians(LATITUDE_DEG), np.radians(LONGITUDE_DEG)).of(latitude, longitude)
    away_m = np.hypot(*north_east.T)
    return FenceScore(
        nearest_m=float(RADIUS_M - away_m.max()),
        bank_max_deg=float(np.degrees(np.abs(roll)).max()),
        home_m=float(away_m[-1]),
    )
