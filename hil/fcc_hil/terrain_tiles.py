"""Elevation tiles of SRTM (`.hgt`), for the ground that JSBSim flies over.

Read independently of `fcc-terrain`, from the same files: what the autopilot takes for the ground is
scored against this.
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import numpy.typing as npt

from .units import FT_TO_M, wrap_degrees

_SIDES = (3_601, 1_201)
"""Posts of a side: 1 and 3 seconds of arc."""
_VOID = -32_768


class Tiles:
    """The tiles of a folder, each read when it is first flown over."""

    def __init__(self, folder: Path) -> None:
        """Raise ValueError for a folder without a tile."""
        self._files = {file.name[:7].upper(): file for file in sorted(folder.glob("*.hgt"))}
        if not self._files:
            raise ValueError(f"{folder}: there are no tiles, such as N47E008.hgt")
        self._read: dict[str, npt.NDArray[np.int16] | None] = {}

    def elevation_m(self, latitude_deg: float, longitude_deg: float) -> float | None:
        """Return the height above mean sea level; None where no tile knows it.

        Bilinear between the four posts around. Raises ValueError for a tile that is none.
        """
        longitude_deg = wrap_degrees(longitude_deg)
        south, west = math.floor(latitude_deg), math.floor(longitude_deg)
        tile = self._tile(south, west)
        if tile is None:
            return None
        most = tile.shape[0] - 1
        row, column = (south + 1.0 - latitude_deg) * most, (longitude_deg - west) * most
        top, left = min(int(row), most - 1), min(int(column), most - 1)
        posts = tile[top : top + 2, left : left + 2]
        if (posts == _VOID).any():
            return None
        down, right = row - top, column - left
        return float(np.array([1.0 - down, down]) @ posts @ np.array([1.0 - right, right]))

    def runway_ft(self, latitude_deg: float, longitude_deg: float, otherwise_ft: float) -> float:
        """Return the elevation of a runway there, which is that of the ground if it is known."""
        known_m = self.elevation_m(latitude_deg, longitude_deg)
        return otherwise_ft if known_m is None else known_m / FT_TO_M

    def _tile(self, south: int, west: int) -> npt.NDArray[np.int16] | None:
        name = f"{'NS'[south < 0]}{abs(south):02}{'EW'[west < 0]}{abs(west):03}"
        if name not in self._read:
            file = self._files.get(name)
            self._read[name] = None if file is None else _posts(file)
        return self._read[name]


def _posts(file: Path) -> npt.NDArray[np.int16]:
    """Return the posts, rows from the north."""
    posts = np.frombuffer(file.read_bytes(), ">i2")
    for side in _SIDES:
        if len(posts) == side * side:
            return posts.astype(np.int16).reshape(side, side)
    raise ValueError(f"{file}: is no tile of 1 or 3 seconds of arc: fetch it again")
