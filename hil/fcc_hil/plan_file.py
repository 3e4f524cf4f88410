"""The items of a flight plan, as far as scoring a flight needs them.

It reads QGC WPL 110 and the simple items of QGroundControl's `.plan`, independently of the reader
under test.
"""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from pathlib import Path

WAYPOINT = 16
LOITERS = (17, 18, 19, 31)
LAND = 21
TAKEOFF = 22

_WPL_COLUMNS = 12
_RELATIVE_FRAMES = (3, 6)


@dataclass(frozen=True)
class Item:
    """One item of a plan."""

    number: int
    """As ground stations show it: home is 0."""
    command: int
    parameters: tuple[float, float, float, float]
    latitude_deg: float
    longitude_deg: float
    altitude_m: float
    """Above mean sea level, if the plan gives it so or above home."""

    @property
    def has_place(self) -> bool:
        """Return whether it is flown to."""
        return self.command in (WAYPOINT, LAND) or self.command in LOITERS

    @property
    def radius_m(self) -> float:
        """Return the radius of a loiter, 0 for the usual one, or that of a waypoint."""
        index = {WAYPOINT: 1, 31: 1}.get(self.command, 2)
        return abs(self.parameters[index])


@dataclass(frozen=True)
class PlanFile:
    """Home and items of a plan."""

    home: Item
    items: tuple[Item, ...]


def read(path: Path) -> PlanFile:
    """Read a plan. Raises OSError, and ValueError for a file that is something else."""
    text = path.read_text(encoding="utf-8")
    try:
        return _read_json(text) if text.lstrip().startswith("{") else _read_wpl(text)
    except (KeyError, IndexError, TypeError, ValueError) as error:
        raise ValueError(f"{path} is no plan that can be scored: {error!r}") from error


def _read_wpl(text: str) -> PlanFile:
    rows = []
    for line in text.splitlines()[1:]:
        columns = line.split()
        if columns and not columns[0].startswith("#"):
            rows.append([float(column) for column in columns[:_WPL_COLUMNS]])
    home_m = rows[0][10]
    items = [
        Item(
            int(row[0]),
            int(row[3]),
            (row[4], row[5], row[6], row[7]),
            row[8],
            row[9],
            row[10] + (home_m if int(row[2]) in _RELATIVE_FRAMES and index else 0.0),
        )
        for index, row in enumerate(rows)
    ]
    return PlanFile(items[0], tuple(items[1:]))


def _read_json(text: str) -> PlanFile:
    mission = json.loads(text)["mission"]
    latitude, longitude, home_m = mission["plannedHomePosition"]
    items = []
    for number, item in enumerate(mission["items"], start=1):
        values = [math.nan if value is None else float(value) for value in item["params"]]
        above_m = home_m if item["frame"] in _RELATIVE_FRAMES else 0.0
        items.append(
            Item(
                number,
                int(item["command"]),
                (values[0], values[1], values[2], values[3]),
                values[4],
                values[5],
                values[6] + above_m,
            )
        )
    return PlanFile(Item(0, WAYPOINT, (0.0,) * 4, latitude, longitude, home_m), tuple(items))
