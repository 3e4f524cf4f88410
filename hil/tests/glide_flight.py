"""A flight with JSBSim in lockstep, by raw sensors, whose engine stops above a runway's area."""

from __future__ import annotations

import math
from dataclasses import dataclass

import drawn_plan
import engaged
import numpy as np
from drawn_plan import LATITUDE_DEG, LONGITUDE_DEG, Metres

from fcc_hil.plan_file import LAND, WAYPOINT
from fcc_hil.plant import Plant, Weather
from fcc_hil.rig import FlightError
from fcc_hil.tangent_plane import Plane
from fcc_hil.units import FT_TO_M, KT_TO_MPS

BEFORE_AIM_M, BEHIND_AIM_M, HALF_WIDTH_M = 300.0, 500.0, 15.0
"""The runway, to the north at sea level, from the point that is aimed at: the plan's origin."""
_APPROACH_M = 6_000.0
_FLIES_S = 10.0
"""Engaged, until the engine stops."""
_LONGEST_S = 900.0
_SPEED_MPS = 100.0 * KT_TO_MPS
_GLIDES = "[contingency]\nengine_out_below_rpm = 300\n"


@dataclass(frozen=True)
class Drawn:
    """Where the engine stops, and in which weather."""

    distance_m: float
    """From the aim."""
    bearing_deg: float
    """From there."""
    heading_deg: float
    wind_kt: float
    wind_from_deg: float
    turbulence: int = 2


def draw(seed: int) -> Drawn:
    """Draw from 1 to 4 km away, in any direction, in up to 15 kt from anywhere."""
    drawn = np.random.default_rng(seed)
    bearing_deg, heading_deg, wind_from_deg = drawn.uniform(0.0, 360.0, 3)
    return Drawn(
        distance_m=float(drawn.uniform(1_000.0, 4_000.0)),
        bearing_deg=float(bearing_deg),
        heading_deg=float(heading_deg),
        wind_kt=float(drawn.uniform(0.0, 15.0)),
        wind_from_deg=float(wind_from_deg),
    )


@dataclass(frozen=True)
class GlideScore:
    """How it came down, by the truth."""

    stopped_at_m: tuple[float, float]
    """Where the engine stopped, north and east of the aim."""
    touch_m: tuple[float, float]
    """Where the wheels touched: behind the aim, and to the right of the runway's middle."""
    sink_fpm: float
    bank_deg: float
    slowest_kt: float
    """The lowest airspeed before the flare, from 10 m of height up."""
    stands_m: tuple[float, float]

    @property
    def on_runway(self) -> bool:
        """Return whether it touched and stands on the runway."""
        return all(
            -BEFORE_AIM_M <= along <= BEHIND_AIM_M and abs(across) <= HALF_WIDTH_M
            for along, across in (self.touch_m, self.stands_m)
        )


def _plan(begins_m: Metres, heading_deg: float) -> str:
    far_m = drawn_plan.ahead(begins_m, heading_deg, 20_000.0)
    return drawn_plan.text(
        [
            drawn_plan.Drawn(WAYPOINT, begins_m, 0.0),
            drawn_plan.Drawn(WAYPOINT, far_m, 3_000.0 * FT_TO_M),
            drawn_plan.Drawn(WAYPOINT, (-_APPROACH_M, 0.0), 300.0),
            drawn_plan.Drawn(LAND, (0.0, 0.0), 0.0),
        ]
    )


def fly(seed: int, drawn: Drawn, *, config: str = "") -> GlideScore:
    """Fly until it stands; raises FlightError if it does not glide or come down."""
    heading = math.radians(drawn.heading_deg)
    to = math.radians(drawn.wind_from_deg) + math.pi
    seconds = engaged.ENGAGED_AFTER_S + _FLIES_S
    stops_m = drawn_plan.ahead((0.0, 0.0), drawn.bearing_deg, drawn.distance_m)
    wind_mps = drawn.wind_kt * KT_TO_MPS
    begins_m = (
        stops_m[0] - seconds * (_SPEED_MPS * math.cos(heading) + wind_mps * math.cos(to)),
        stops_m[1] - seconds * (_SPEED_MPS * math.sin(heading) + wind_mps * math.sin(to)),
    )
    latitude_deg, longitude_deg = drawn_plan.place(begins_m)
    plan = _plan(begins_m, drawn.heading_deg)
    machine = engaged.machine(plan, drawn.wind_kt, config=config or _GLIDES)
    plant = Plant(
        "c172p",
        seed=seed,
        weather=Weather(
            wind_from_deg=drawn.wind_from_deg,
            wind_kt=drawn.wind_kt,
            turbulence_severity=drawn.turbulence,
        ),
        heading_deg=drawn.heading_deg,
        latitude_deg=latitude_deg,
        longitude_deg=longitude_deg,
    )
    rig = engaged.engage(plant, machine, seed)
    rig.fly_to(rig.time_s + _FLIES_S)
    plant.fail_engines()
    rows: list[tuple[float, ...]] = []

    def keep() -> bool:
        state = plant.state()
        rows.append(
            (
                state.latitude_rad,
                state.longitude_rad,
                state.height_m,
                state.airspeed_mps,
                state.roll_rad,
                state.down_mps,
                float(state.on_ground),
                math.hypot(state.north_mps, state.east_mps),
            )
        )
        stands = state.on_ground and rows[-1][-1] < 0.2
        return stands or not rig.holds_control

    rig.fly_to(rig.time_s + _LONGEST_S, keep)
    if not rig.holds_control or not plant.state().on_ground:
        raise FlightError(engaged.last_events(rig))
    return _score(np.array(rows))


def fly_drawn(seed: int) -> GlideScore:
    """Fly what a seed draws."""
    return fly(seed, draw(seed))


def _score(rows: np.ndarray[tuple[int, ...], np.dtype[np.float64]]) -> GlideScore:
    latitude, longitude, height, airspeed, roll, down, on_ground, _ = rows.T
    plane = Plane(math.radians(LATITUDE_DEG), math.radians(LONGITUDE_DEG))
    where = plane.of(latitude, longitude)
    touch = int(np.argmax(on_ground > 0.0))
    flown = height[:touch] > 10.0
    return GlideScore(
        stopped_at_m=(float(where[0, 0]), float(where[0, 1])),
        touch_m=(float(where[touch, 0]), float(where[touch, 1])),
        sink_fpm=float(np.max(down[touch - 2 : touch + 1])) * 60.0 / FT_TO_M,
        bank_deg=math.degrees(float(roll[touch])),
        slowest_kt=float(np.min(airspeed[:touch][flown])) / KT_TO_MPS,
        stands_m=(float(where[-1, 0]), float(where[-1, 1])),
    )
