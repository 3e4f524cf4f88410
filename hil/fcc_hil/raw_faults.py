"""Raw readings that fail: what a driver, a cable or a tube does to them."""

from __future__ import annotations

import math
from collections.abc import Callable

import fcc

from .raw_sensors import READINGS
from .units import calibrated_airspeed_mps, impact_pressure_pa

Fault = Callable[[fcc.Measurements], None]
"""Falsifies the readings of a tick; NaN where nothing new has arrived."""


def lost(*readings: str) -> Fault:
    """Lose these readings."""

    def fault(values: fcc.Measurements) -> None:
        for name in (value for reading in readings for value in READINGS[reading]):
            setattr(values, name, math.nan)

    return fault


def repeated(reading: str) -> Fault:
    """Repeat what arrived first."""
    kept: list[float] = []

    def fault(values: fcc.Measurements) -> None:
        given = [getattr(values, name) for name in READINGS[reading]]
        if not kept and all(math.isfinite(value) for value in given):
            kept.extend(given)
        for name, value in zip(READINGS[reading], kept, strict=False):
            setattr(values, name, value)

    return fault


def airspeed_off(by_mps: float) -> Fault:
    """Show the pressure of another calibrated airspeed, 0 at least."""

    def fault(values: fcc.Measurements) -> None:
        given_pa = values.differential_pressure_pa
        if math.isfinite(given_pa):
            shown_mps = calibrated_airspeed_mps(max(0.0, given_pa)) + by_mps
            values.differential_pressure_pa = impact_pressure_pa(max(0.0, shown_mps))

    return fault
