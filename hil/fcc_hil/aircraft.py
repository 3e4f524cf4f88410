"""JSBSim's aircraft used here, with the speed and the altitude at which they are trimmed.

The speeds leave a margin to climb; retractable gear is up, because half of these do not have the
power to hold the speed with it down.
"""

from __future__ import annotations

from dataclasses import dataclass

from .loading import Loading


@dataclass(frozen=True)
class Aircraft:
    """An aircraft of JSBSim and its trimmed flight condition."""

    name: str
    """JSBSim's name of the model."""
    airspeed_kt: float
    """Calibrated airspeed."""
    altitude_ft: float
    """Above mean sea level."""
    retractable_gear: bool = False
    """Whether to raise the gear before trimming."""
    trims: bool = True
    """Whether JSBSim's trim finds a steady state. If not, the aircraft is flown to it in closed
    loop (see `settle`)."""
    drop_ft: float = 8.0
    """The height from which it is put on its wheels: above its gear, but a light one tips over."""
    loading: Loading | None = None
    """None for that of its file."""


_TABLE = (
    Aircraft("c172p", 100, 3_000),
    Aircraft("c172x", 100, 3_000),
    Aircraft("c172r", 100, 3_000),
    Aircraft("J3Cub", 65, 3_000, drop_ft=4.0),
    Aircraft("rascal110", 45, 1_000, trims=False, drop_ft=0.5),
    Aircraft("OV10", 160, 5_000, retractable_gear=True),
    Aircraft("t6texan2", 200, 8_000, retractable_gear=True),
    Aircraft("T37", 220, 10_000, retractable_gear=True),
    Aircraft("T38", 260, 15_000, retractable_gear=True),
    Aircraft("f16", 260, 15_000, retractable_gear=True),
    Aircraft("737", 260, 15_000, retractable_gear=True),
    Aircraft("A320", 260, 15_000, retractable_gear=True),
    Aircraft("global5000", 260, 15_000, retractable_gear=True),
    Aircraft("c182", 120, 3_000),
    Aircraft("pa28", 85, 3_000),
    Aircraft("c310", 130, 5_000, retractable_gear=True, trims=False),
    Aircraft("pc7", 150, 5_000, retractable_gear=True, trims=False),
)

AIRCRAFT: dict[str, Aircraft] = {aircraft.name: aircraft for aircraft in _TABLE}


def by_name(name: str) -> Aircraft:
    """Return the aircraft of that name, or raise ValueError with the known names."""
    try:
        return AIRCRAFT[name]
    except KeyError:
        known = ", ".join(AIRCRAFT)
        raise ValueError(f"no aircraft '{name}' in the table; choose one of: {known}") from None
