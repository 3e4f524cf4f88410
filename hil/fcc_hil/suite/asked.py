"""The limits of each aircraft, as a table of their own."""

from __future__ import annotations

from types import MappingProxyType

from .limits import Limits, limits

_COLUMNS = (
    "heading_settle_s",
    "heading_overshoot_deg",
    "heading_rms_deg",
    "altitude_settle_s",
    "altitude_overshoot_ft",
    "altitude_rms_ft",
    "turn_loss_ft",
    "airspeed_error_kt",
    "lateral_acceleration_g",
)


def _row(*figures: float) -> Limits:
    return limits(**dict(zip(_COLUMNS, figures, strict=True)))


SMOOTH = MappingProxyType(
    {
        "c172p": _row(16.6, 0.5, 0.4, 10.5, 1.6, 0.9, 1.6, 2.5, 0.05),
        "c172x": _row(16.4, 0.5, 0.4, 10.5, 1.6, 1.4, 2.5, 5.0, 0.05),
        "c172r": _row(17.5, 1.0, 0.8, 12.0, 3.0, 1.5, 3.0, 5.0, 0.05),
        "J3Cub": _row(15.0, 1.0, 0.8, 19.0, 3.0, 2.0, 3.0, 6.0, 0.05),
        "OV10": _row(32.0, 1.5, 0.8, 16.0, 4.0, 2.0, 4.0, 5.0, 0.05),
        "t6texan2": _row(40.0, 1.5, 0.8, 16.0, 4.0, 2.0, 4.0, 5.0, 0.05),
        "T37": _row(45.0, 1.5, 0.8, 16.0, 4.0, 2.0, 4.0, 5.0, 0.05),
        "c310": _row(27.0, 1.5, 0.8, 16.0, 4.0, 2.0, 4.0, 5.0, 0.05),
        "737": _row(60.0, 1.5, 0.8, 25.0, 6.0, 3.0, 6.0, 6.0, 0.05),
        "global5000": _row(60.0, 1.5, 0.8, 25.0, 6.0, 3.0, 6.0, 6.0, 0.05),
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
        "c172p": (_rough(0.15, 2.3), _rough(0.4, 6.0)),
        "c172x": (_rough(0.15, 2.3), _rough(0.4, 8.0)),
        "c172r": (_rough(0.25, 3.0), _rough(0.5, 8.0)),
        "J3Cub": (_rough(0.5, 6.0), _rough(1.0, 30.0)),
        "OV10": (_rough(0.25, 4.0), _rough(0.5, 8.0)),
        "t6texan2": (_rough(0.25, 4.0), _rough(0.5, 8.0)),
        "T37": (_rough(0.25, 4.0), _rough(0.5, 8.0)),
        "c310": (_rough(0.25, 4.0), _rough(0.5, 8.0)),
        "737": (_rough(0.25, 4.0), _rough(0.5, 8.0)),
        "global5000": (_rough(0.25, 4.0), _rough(0.5, 8.0)),
    }
)
"""With noise and a delay of 25 ms in turbulence 3 and 4: over all legs."""

TAKEN_OVER = MappingProxyType({"c172p": 1.0, "c172x": 1.0, "OV10": 2.0, "737": 3.0})
"""After taking over in another state than trimmed flight: altitude RMS, ft."""
