"""The aircraft of the campaign, and where each stalls.

The stalling angle is the one of the greatest lift in the model's own file, and the stalling speed
follows from that lift: Vs = sqrt(2 W / (rho S CL)), as calibrated airspeed at the standard density
of the sea level. The handbooks agree: 51 kt for the 172P at 2,400 lb (here 53), 51 kt for the 172R
at 2,450 lb (53), 33 kt for the J-3 at 1,220 lb (35).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..configurations import configuration, value_of
from ..loading import Loading
from ..units import FT_TO_M, KT_TO_MPS

_SEA_LEVEL_DENSITY_SLUGFT3 = 0.0023769
"""Of the standard atmosphere (ISO 2533)."""

SLOWEST = 1.3
"""The lowest speed ordered, as a multiple of the stalling speed: that of an approach."""
_FLOOR_MARGIN_KT = 4.0
"""Above the lowest permitted speed, because measurements have errors."""


@dataclass(frozen=True)
class Limits:
    """An aircraft's limits, weights and speeds."""

    name: str
    stall_deg: float
    """The angle of attack of the greatest lift."""
    lift: float
    """The lift coefficient there, flaps up, without the propeller's wash."""
    wing_sqft: float
    bare_lb: float
    """Empty, with a pilot of 170 lb."""
    most_lb: float
    """The greatest take-off weight."""
    tanks_lb: float
    """The fuel that fits in the tanks."""
    fast_kt: float
    """The greatest speed at which the model still has power to climb at its greatest weight."""

    @property
    def floor_kt(self) -> float:
        """The lowest airspeed that its configuration permits."""
        return self._configured("min_airspeed_kt")

    @property
    def slowest_order_kt(self) -> float:
        """The lowest airspeed that may be commanded."""
        return self.floor_kt + self._configured("airspeed_margin_kt")

    @property
    def fastest_order_kt(self) -> float:
        """The highest airspeed that may be commanded."""
        return self._configured("max_airspeed_kt") - self._configured("airspeed_margin_kt")

    @property
    def never_exceed_kt(self) -> float:
        """The never-exceed speed, Vne."""
        return self._configured("never_exceed_airspeed_kt")

    @property
    def most_climb_fpm(self) -> float:
        """The largest climb rate that its configuration permits."""
        return self._configured("max_climb_fpm")

    @property
    def most_sink_fpm(self) -> float:
        """The largest rate of descent that its configuration permits."""
        return self._configured("max_sink_fpm")

    @property
    def stall_setting_kt(self) -> float:
        """The stalling speed for the configuration: whole, at the greatest weight."""
        return max(
            self._configured("stall_airspeed_kt"), float(math.ceil(self.stall_kt(self.most_lb)))
        )

    def loading(self, weight: str) -> Loading:
        """Return "light", one person and little fuel, or "heavy", the greatest weight.

        Raises ValueError for another name.
        """
        fuel_lb = 0.1 * self.tanks_lb
        weights_lb = {"light": self.bare_lb + fuel_lb + 10.0, "heavy": self.most_lb}
        if weight not in weights_lb:
            raise ValueError(f"weight '{weight}': choose one of {', '.join(weights_lb)}")
        return Loading(weights_lb[weight], fuel_lb)

    def slow_kt(self, weight_lb: float) -> float:
        """Return 1.3 Vs, or 4 kt above the lowest permitted airspeed if that is more."""
        return max(SLOWEST * self.stall_kt(weight_lb), self.floor_kt + _FLOOR_MARGIN_KT)

    def _configured(self, name: str) -> float:
        # Here, because the commands that fly the daemon do without the module.
        import fcc  # noqa: PLC0415

        key = f"autopilot.envelope.{name}"
        return value_of(configuration(self.name), key, float(fcc.Config()[key]))

    def stall_kt(self, weight_lb: float) -> float:
        """Return the stalling speed in straight flight, calibrated."""
        pressure_psf = weight_lb / (self.wing_sqft * self.lift)
        fps = math.sqrt(2.0 * pressure_psf / _SEA_LEVEL_DENSITY_SLUGFT3)
        return fps * FT_TO_M / KT_TO_MPS


# The Cessnas' lift (CLwbh, of the c182 CLo + CLalpha) is greatest at 0.28 rad. The c172x has a
# second lift that grows with the angle and never stalls; without it, its stalling speed is that of
# the others. The J3Cub's Lift_alpha is greatest at 0.22 to 0.26 rad, by Reynolds number.
# Weights: type certificates 3A12 (172P, 172R), 3A13 (182P), A-691 (J3C); the c172x at the weight of
# its file.
AIRCRAFT = {
    limits.name: limits
    for limits in (
        Limits("c172p", 16.0, 1.47, 174.0, 1_670.0, 2_400.0, 370.0, 115.0),
        Limits("c172x", 16.0, 1.47, 174.0, 1_624.0, 2_480.0, 260.0, 112.0),
        Limits("c172r", 16.0, 1.47, 174.0, 1_790.0, 2_450.0, 336.0, 115.0),
        Limits("J3Cub", 15.0, 1.68, 178.5, 935.0, 1_220.0, 75.0, 75.0),
        Limits("c182", 16.0, 1.466, 174.0, 1_870.0, 2_950.0, 600.0, 125.0),
    )
}
