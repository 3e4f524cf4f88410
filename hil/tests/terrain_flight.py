"""A flight with JSBSim in lockstep, by raw sensors, against a ridge that its tiles show."""

from __future__ import annotations

import math
import tempfile
from dataclasses import dataclass
from pathlib import Path

import drawn_plan
import numpy as np
from drawn_plan import Drawn

from fcc_hil import plan_flight
from fcc_hil.lockstep_rig import LockstepRig
from fcc_hil.plan_flight import PlanConditions
from fcc_hil.plant import Weather
from fcc_hil.tangent_plane import Array, away_m
from fcc_hil.units import FT_TO_M

GROUND_M = 400.0
_RIDGE_DEG, _WIDTH_DEG = 47.06, 0.008
"""From west to east: its latitude, 6.7 km north of home, and its width."""
_FAR_M = 14_000.0
"""From home to the commanded place behind the ridge."""
_ARRIVES_M = 1_000.0
_SECONDS = 420.0
_CIRCLE_M = 1_000.0
_POSTS = 1_201
"""SRTM of 3 seconds of arc."""
_LOITER = 17


@dataclass(frozen=True)
class TerrainScore:
    """How a ridge was met, by the truth."""

    nearest_m: float
    """The least height over the ground."""
    arrives: bool
    """Whether it came to the place behind the ridge."""
    told: tuple[str, ...]
    """The events about terrain."""


def ground_m(latitude_deg: Array | float, ridge_m: float) -> Array:
    """Return the elevation of the ground."""
    off = (np.asarray(latitude_deg) - _RIDGE_DEG) / _WIDTH_DEG
    return np.asarray(GROUND_M + ridge_m * np.exp(-(off**2)))


def _write_tiles(folder: Path, ridge_m: float) -> None:
    for south in (46, 47):
        latitude = south + 1.0 - np.arange(_POSTS) / (_POSTS - 1.0)
        posts = np.repeat(ground_m(latitude, ridge_m)[:, None], _POSTS, axis=1)
        for west in (7, 8):
            (folder / f"N{south}E00{west}.hgt").write_bytes(posts.astype(">i2").tobytes())


def fly(
    seed: int, ridge_m: float, wind_from_deg: float, wind_kt: float, off_standard_k: float = 0.0
) -> TerrainScore:
    """Command a place behind a ridge of this height over the ground, at 3,000 ft.

    In air that is colder than the standard atmosphere the aircraft is lower than that.
    """
    altitude_m = 3_000.0 * FT_TO_M
    far_deg = drawn_plan.place((_FAR_M, 0.0))
    plan = drawn_plan.text(
        [
            Drawn(16, (0.0, 0.0), GROUND_M),
            Drawn(_LOITER, (0.0, 0.0), altitude_m, (0.0, 0.0, _CIRCLE_M, 0.0)),
        ]
    )
    begun_s = math.inf
    nearest_m, arrives = math.inf, False
    told: dict[str, None] = {}

    def watch(rig: LockstepRig) -> bool:
        nonlocal begun_s, nearest_m, arrives
        if not math.isfinite(begun_s):
            begun_s = rig.time_s
            rig.machine.command(
                go_to_latitude_rad=math.radians(far_deg[0]),
                go_to_longitude_rad=math.radians(far_deg[1]),
                go_to_altitude_m=altitude_m,
            )
        state = rig.plant.state()
        latitude_deg = math.degrees(state.latitude_rad)
        nearest_m = min(nearest_m, state.elevation_m - float(ground_m(latitude_deg, ridge_m)))
        at_deg = np.array([latitude_deg]), np.degrees(np.array([state.longitude_rad]))
        arrives = arrives or float(away_m(*far_deg, at_deg)[0]) < _ARRIVES_M
        told.update({event.text: None for event in rig.events if "terrain" in event.text})
        return rig.time_s > begun_s + _SECONDS or nearest_m < 0.0

    with tempfile.TemporaryDirectory() as folder:
        _write_tiles(Path(folder), ridge_m)
        file = Path(folder, "ridge.waypoints")
        file.write_text(plan, encoding="utf-8")
        weather = Weather(
            wind_from_deg=wind_from_deg,
            wind_kt=wind_kt,
            turbulence_severity=2,
            off_standard_k=off_standard_k,
        )
        config = f'[terrain]\nfolder = "{folder}"\n'
        conditions = PlanConditions(weather=weather, seed=seed, config=config)
        plan_flight.fly(file, conditions, watch=watch)
    return TerrainScore(nearest_m=nearest_m, arrives=arrives, told=tuple(told))
