"""Puts the drawn fault of a flight in, in whatever it is flown by."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import fcc

from ..raw_faults import airspeed_off, lost, repeated
from ..sensor_faults import Faults
from ..units import KT_TO_MPS
from .draw import TUBE, WRONG, Fault

ENGINE_OUT = "engine out"

_READINGS = {
    "attitude": ("raw_body_rates", "raw_specific_force"),
    "heading": ("magnetic_field",),
    "altitude": ("static_pressure",),
    "airspeed": ("differential_pressure",),
}
"""Of each quantity the readings that are lost with it: of the attitude the inertial unit's."""


def put_in(fault: Fault, faults: Faults, *, by_raw: bool) -> None:
    """Put a fault of sensors in; the engine is failed in flight, one raw sensor by `RawFaults`."""
    when: dict[str, Any] = {"after": fault.begins_s, "lasts": fault.lasts_s}
    sensor = fault.what.split()[0]
    if fault.what == "samples lost":
        faults.loss("everything", share=fault.amount, **when)
    elif sensor == "everything":
        faults.loss(sensor, **when)
    elif by_raw or fault.what == ENGINE_OUT:
        return
    elif fault.what.endswith("frozen"):
        faults.freeze(sensor, **when)
    elif fault.what.endswith("biased") or fault.what == WRONG:
        faults.bias(sensor, by=fault.amount, **when)
    elif fault.what == TUBE:
        faults.blocked_tube(**when)
    else:
        faults.loss(sensor, **when)


class RawFaults:
    """Puts the fault of a flight into its raw readings, while it lasts."""

    def __init__(self, fault: Fault | None, since_engaged_s: Callable[[], float]) -> None:
        """Nothing happens without a fault, or with one that is not of a single sensor."""
        self._fault = fault
        self._since_engaged_s = since_engaged_s
        self._falsify = None if fault is None else _falsifier(fault)

    def __call__(self, values: fcc.Measurements, _: float) -> None:
        """Falsify the readings of a tick."""
        fault, since_s = self._fault, self._since_engaged_s()
        if fault is None or self._falsify is None or since_s < fault.begins_s:
            return
        if fault.lasts_s is None or since_s < fault.begins_s + fault.lasts_s:
            self._falsify(values)


def _falsifier(fault: Fault) -> Callable[[fcc.Measurements], None] | None:
    quantity = fault.what.split()[0]
    if fault.what == "airspeed frozen":
        return repeated("differential_pressure")
    if fault.what == "airspeed biased":
        return airspeed_off(fault.amount * KT_TO_MPS)
    return lost(*_READINGS[quantity]) if quantity in _READINGS else None
