"""The ground of elevation tiles: read, flown over, and scored."""

from __future__ import annotations

import math
from pathlib import Path

import fcc
import numpy as np
import pytest

from fcc_hil import clearance, plan_flight
from fcc_hil.clearance import TerrainScore
from fcc_hil.flown_plan import of_truth
from fcc_hil.lockstep_rig import LockstepRig
from fcc_hil.plant import Plant, Weather
from fcc_hil.standin import Settings
from fcc_hil.state import Controls, State
from fcc_hil.terrain_tiles import Tiles
from fcc_hil.truth import Truth, row

SIDE = 1_201
RIDGE_M = 700.0


def _write(folder: Path, name: str, rows_m: np.ndarray[tuple[int], np.dtype[np.float64]]) -> Path:
    """Write a tile whose rows, from the north, are level."""
    posts = np.repeat(np.round(rows_m)[:, None], SIDE, axis=1)
    (folder / name).write_bytes(posts.astype(">i2").tobytes())
    return folder


def _ridge(folder: Path) -> Path:
    """Write a ridge of 700 m from west to east at 47.03 degrees, 1 km wide, and 100 m around it."""
    latitude = 48.0 - np.arange(SIDE) / (SIDE - 1.0)
    ridge = 100.0 + 600.0 * np.exp(-(((latitude - 47.03) / 0.005) ** 2))
    south = _write(folder, "N46E008.hgt", np.full(SIDE, 100.0))
    return _write(south, "N47E008.hgt", ridge)


def test_heights_are_those_between_the_posts(tmp_path: Path) -> None:
    """A row of posts is 1/1,200 of a degree; row 600 is the latitude 47.5."""
    rows = np.arange(SIDE, dtype=float)
    rows[900] = -32_768
    tiles = Tiles(_write(tmp_path, "N47W008.hgt", rows))
    assert tiles.elevation_m(47.5, -7.5) == pytest.approx(600.0)
    assert tiles.elevation_m(47.5 + 0.25 / 1_200.0, -7.123) == pytest.approx(599.75)
    assert tiles.elevation_m(47.0, -7.5) == pytest.approx(1_200.0)
    assert tiles.elevation_m(48.0 - 899.5 / 1_200.0, -7.5) is None, "a void"
    assert tiles.elevation_m(46.9, -7.5) is None, "no tile"


def test_what_is_no_tile_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="there are no tiles"):
        Tiles(tmp_path)
    (tmp_path / "N47E008.hgt").write_bytes(b"12")
    tiles = Tiles(tmp_path)
    with pytest.raises(ValueError, match=r"N47E008\.hgt: is no tile of 1 or 3 seconds of arc"):
        tiles.elevation_m(47.5, 8.5)


def _scored(state: State, mode: str) -> TerrainScore:
    flown = of_truth(Truth([row(state, Controls())]))
    return clearance.score(flown, [mode])


def test_the_plant_flies_over_the_tiles_and_touches_them(tmp_path: Path) -> None:
    """At 3,000 ft, 914.4 m; a ridge that is raised to 930 m is flown into."""
    plant = Plant("c172p", latitude_deg=47.03, longitude_deg=8.5, heading_deg=90.0)
    plant.fly_over(Tiles(_ridge(tmp_path)))
    plant.step()
    state = plant.state()
    assert state.height_m == pytest.approx(state.elevation_m - RIDGE_M, abs=1.0)
    over = _scored(state, "plan")
    assert not over.collides
    assert over.lowest_m == pytest.approx(214.0, abs=10.0)
    _write(tmp_path, "N47E008.hgt", np.full(SIDE, 930.0))
    plant.fly_over(Tiles(tmp_path))
    plant.step()
    assert not _scored(plant.state(), "land").collides, "a landing is meant"
    assert _scored(plant.state(), "plan").collides


def test_a_plan_is_flown_over_the_tiles_and_scored(tmp_path: Path) -> None:
    """Home is 3.3 km south of the ridge, the leg at 900 m: 200 m over it."""
    plan = tmp_path / "over.waypoints"
    plan.write_text(
        "QGC WPL 110\n0 0 0 16 0 0 0 0 47.0 8.5 900 1\n1 0 0 16 0 0 0 0 47.06 8.5 900 1\n"
    )
    conditions = plan_flight.PlanConditions(terrain=_ridge(tmp_path), seed=2)
    score, _ = plan_flight.fly(plan, conditions)
    assert score.terrain is not None
    assert not score.terrain.collides
    assert score.terrain.lowest_m == pytest.approx(200.0, abs=10.0)
    assert score.terrain.latitude_deg == pytest.approx(47.03, abs=0.001)
    assert math.isclose(score.waypoints[0].altitude_error_ft, 0.0, abs_tol=30.0)


class _Rising(Tiles):
    """Ground that rises under an aircraft for 45 s, to 12 m above where it was, and ends."""

    def __init__(self, plant: Plant) -> None:
        self._plant, self._from_m = plant, plant.state().elevation_m

    def elevation_m(self, latitude_deg: float, longitude_deg: float) -> float | None:  # noqa: ARG002
        since_s = self._plant.time_s - 40.0
        return self._from_m - 2.0 + min(14.0, 0.6 * since_s) if 0.0 < since_s < 45.0 else 0.0


@pytest.mark.parametrize("seed", [33, 34])
def test_who_touches_the_ground_climbs_off_it_and_does_not_dive_behind_it(seed: int) -> None:
    """It keeps the 100 ft of an instrument pilot (FAA-S-ACS-8) around 3,000 ft."""
    plant = Plant("c172p", seed=seed, weather=Weather(turbulence_severity=1))
    plant.fly_over(_Rising(plant))
    settings = Settings(aircraft="c172p", seed=seed, noise=True)
    rig = LockstepRig(settings, plant, fcc.Machine('[guidance]\nmode = "hold"\n'))
    rig.prepare()
    rig.set_switch(on=True)
    rig.fly_to(130.0)
    assert any("the wheels touch the ground" in event.text for event in rig.events)
    assert not any("recovering" in event.text for event in rig.events)
    altitude_ft = rig.truth().since(40.0)["altitude_ft"]
    assert altitude_ft.min() > 2_900.0
    assert altitude_ft.max() < 3_100.0
