"""A picture of a flown plan: ground track over the plan, and the height profile."""

from __future__ import annotations

from pathlib import Path

import matplotlib as mpl
import numpy as np

from . import plan_file, replacement
from .flown_plan import FlownPlan
from .tangent_plane import Array
from .units import FT_TO_M

mpl.use("Agg")
import matplotlib.pyplot as plt


def plot(path: Path, plan: Path, flown: FlownPlan) -> None:
    """Draw the flight over its plan."""
    read = plan_file.read(plan)
    places = [item for item in read.items if item.has_place]
    figure, (ground, height) = plt.subplots(
        2, 1, figsize=(9, 10), height_ratios=(3, 1), layout="constrained"
    )
    first_deg = places[0].longitude_deg
    planned_deg = _beside(first_deg, np.array([item.longitude_deg for item in places]))
    flown_deg = _beside(first_deg, np.degrees(flown.longitude_rad))
    ground.plot(
        planned_deg,
        [item.latitude_deg for item in places],
        "o--",
        color="0.6",
        label="plan",
    )
    for item, place_deg in zip(places, planned_deg, strict=True):
        ground.annotate(str(item.number), (place_deg, item.latitude_deg))
    ground.plot(flown_deg, np.degrees(flown.latitude_rad), label="flown (truth)")
    ground.set_aspect(1.0 / np.cos(np.mean(flown.latitude_rad)))
    ground.set_xlabel("longitude, deg")
    ground.set_ylabel("latitude, deg")
    ground.legend()
    height.plot(flown.time_s, flown.altitude_demand_m / FT_TO_M, "--", color="0.6", label="demand")
    height.plot(flown.time_s, flown.elevation_m / FT_TO_M, label="flown (truth)")
    height.set_xlabel("s")
    height.set_ylabel("ft above sea level")
    height.legend()
    path.parent.mkdir(parents=True, exist_ok=True)
    replacement.draw(path, figure, dpi=120)
    plt.close(figure)


def _beside(first_deg: float, longitude_deg: Array) -> Array:
    """Return longitudes without the jump at 180 degrees."""
    return first_deg + (longitude_deg - first_deg + 180.0) % 360.0 - 180.0
