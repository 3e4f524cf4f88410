"""The campaign's faults of a quantity, as the raw sensors that it comes from have them."""

from __future__ import annotations

from collections.abc import Callable

import fcc

from ..raw_faults import airspeed_off, lost, repeated
from ..units import KT_TO_MPS
from .draw import Fault

_READINGS = {
    "attitude": ("raw_body_rates", "raw_specific_force"),
    "heading": ("magnetic_field",),
    "altitude": ("static_pressure",),
    "airspeed": ("differential_pressure",),
}
"""Of each quantity the readings that are lost with it: of the attitude the inertial unit's."""


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
