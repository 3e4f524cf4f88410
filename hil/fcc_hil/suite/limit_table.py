"""The limits of each aircraft."""

from __future__ import annotations

from types import MappingProxyType

from ..table import COLUMNS
from .limits import Limits, limits


def _row(*figures: float) -> Limits:
    return limits(**dict(zip(COLUMNS, figures, strict=True)))


SMOOTH = MappingProxyType(
    {
        # Of 40 flights on seeds 4101 to 4140, 39 keep every leg within 0.9 ft of altitude RMS. One
        # leg of the 320 has 0.92, in a flight that is one of those flown here.
        "c172p": _row(16.6, 0.5, 0.4, 10.5, 1.6, 0.95, 1.6, 2.5, 0.05),
        "c172x": _row(16.4, 0.5, 0.4, 10.5, 2.0, 1.4, 2.5, 5.0, 0.05),
        "c172r": _row(17.0, 0.5, 0.4, 10.6, 1.6, 0.9, 1.6, 8.0, 0.05),
        "J3Cub": _row(16.0, 1.0, 0.4, 20.0, 2.0, 1.0, 2.0, 3.0, 0.05),
        "OV10": _row(28.0, 0.5, 0.2, 12.5, 2.5, 1.0, 2.5, 2.5, 0.14),
        "t6texan2": _row(38.0, 0.5, 0.4, 15.0, 2.0, 1.2, 2.0, 2.5, 0.07),
        "T37": _row(43.0, 0.5, 0.8, 20.0, 6.0, 4.0, 6.0, 2.0, 0.10),
        "c310": _row(25.0, 0.5, 0.4, 13.0, 2.0, 1.2, 2.0, 3.5, 0.06),
        "737": _row(53.0, 0.5, 0.2, 16.0, 5.0, 2.2, 5.0, 1.0, 0.20),
        "global5000": _row(51.0, 0.5, 0.2, 13.0, 4.0, 1.7, 4.0, 1.0, 0.18),
    }
)
"""Calm, in wind, and with noise and a delay of 25 ms: the worst leg."""

_LATE = 1.3


def late(smooth: Limits) -> Limits:
    """Return the limits with sensors 100 ms late: nothing is more than 30 % worse."""
    return limits(**{name: _LATE * most for name, most in smooth.items()})


def _rough(unsettled: float, rms_ft: float) -> Limits:
    return limits(unsettled_share=unsettled, mean_altitude_rms_ft=rms_ft, largest_bank_deg=50.0)


ROUGH = MappingProxyType(
    {
        "c172p": (_rough(0.15, 2.3), _rough(0.40, 5.0)),
        "c172x": (_rough(0.15, 2.3), _rough(0.40, 12.0)),
        "c172r": (_rough(0.35, 2.3), _rough(0.50, 4.0)),
        # At 65 kt it does not have the power to fly level in these gusts.
        "J3Cub": (_rough(0.40, 8.0), _rough(0.50, 120.0)),
        "OV10": (_rough(0.25, 5.0), _rough(0.50, 9.0)),
        "t6texan2": (_rough(0.25, 4.5), _rough(0.25, 7.0)),
        "T37": (_rough(0.25, 6.0), _rough(0.50, 12.0)),
        "c310": (_rough(0.25, 4.5), _rough(0.25, 9.0)),
        "737": (_rough(0.25, 4.5), _rough(0.25, 8.0)),
        "global5000": (_rough(0.25, 3.5), _rough(0.25, 7.0)),
    }
)
"""With noise and a delay of 25 ms in turbulence 3 and 4: over all legs."""

TAKEN_OVER = MappingProxyType({"c172p": 1.0, "c172x": 2.0, "OV10": 1.0, "737": 2.0})
"""After engaging in another state than trimmed flight: altitude RMS, ft."""

_EDGES = limits(
    unsettled_share=0.0,
    mean_altitude_rms_ft=2.0,
    largest_bank_deg=40.0,
    largest_load_g=2.0,
    # 2 deg/s, and 2 deg/s of the usual noise, which is independent of it.
    pitch_rate_sd_degps=2.83,
    # All stall at 15 or 16. A level turn at 1.3 Vs and 30 degrees of bank needs 68 % of the lift.
    largest_angle_of_attack_deg=14.0,
)
EDGES = MappingProxyType(dict.fromkeys(("c172p", "c172x", "c172r", "J3Cub"), _EDGES))
"""At the edges of speed and weight, with noise and a delay of 25 ms: reasons, not measurements."""
