"""A stand-in with a phone aboard, under the fuselage, its screen down and its top to the nose.

What its raw sensors give goes to the library of `android/tests/fake-libandroid`, in Android's
axes and units and on Android's clock; its positions go to the app. They are those of
`raw_sensors`, calibrated on the ground before.
"""

from __future__ import annotations

import json
import math
import socket
import time

import fcc

from .raw_calibration import calibrate
from .raw_sensors import FIELD_UT, READINGS, RawSensors
from .settings import Settings
from .standin import StandIn

PACKAGE = "fcc.android"

MOUNTING = "left-forward-down"
"""Where the phone's x, y and z point in the aircraft."""

_TYPES = {"raw_specific_force": 35, "raw_body_rates": 16, "magnetic_field": 14}
"""The uncalibrated kinds, by Android's numbers (`android/sensor.h`)."""
_PRESSURE = 6
_PA_PER_HPA = 100.0


class PhonedStandIn(StandIn):
    """A stand-in with a phone."""

    def __init__(self, settings: Settings) -> None:
        """Set both up; raise OSError if a port cannot be opened."""
        super().__init__(settings)
        if settings.phone is None:
            raise ValueError("there is no phone: set Settings.phone")
        self._sensors_at, self._positions_at = (("127.0.0.1", port) for port in settings.phone)
        self._calibration = calibrate("phone", settings.seed, FIELD_UT)
        self._raw = RawSensors(self.plant, "phone", seed=settings.seed)
        self._stamps_ns: dict[str, int] = {}
        """The last of each reading."""
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)

    def close(self) -> None:
        """Close the ports."""
        self._socket.close()
        super().close()

    def fly(self) -> None:
        """Fly a frame, and send what the phone's sensors gave in it."""
        super().fly()
        self._raw.step()
        measured = fcc.Measurements()
        ages_s = self._raw.read(measured)
        self._calibration.apply(measured)
        now_ns = time.clock_gettime_ns(time.CLOCK_BOOTTIME)
        lines = []
        for name, age_s in ages_s.items():
            # Frames are closer together after a late one, and a phone's stamps never go back.
            stamp_ns = max(now_ns - round(age_s * 1e9), self._stamps_ns.get(name, 0) + 1)
            self._stamps_ns[name] = stamp_ns
            given = [getattr(measured, value) for value in READINGS[name]]
            if name in _TYPES:
                x, y, z = given
                # Forward is the phone's y, right is against its x.
                lines.append(_event(_TYPES[name], stamp_ns, [-y, x, z]))
            elif name == "static_pressure":
                lines.append(_event(_PRESSURE, stamp_ns, [given[0] / _PA_PER_HPA]))
            elif name == "gnss":
                self._send_position(stamp_ns, given)
        if lines:
            self._socket.sendto("\n".join(lines).encode(), self._sensors_at)

    def _send_position(self, stamp_ns: int, given: list[float]) -> None:
        latitude_rad, longitude_rad, altitude_m, north_mps, east_mps, _ = given
        position = {
            "elapsed_realtime_ns": stamp_ns,
            "latitude_deg": math.degrees(latitude_rad),
            "longitude_deg": math.degrees(longitude_rad),
            "altitude_m": altitude_m,
            "speed_mps": math.hypot(north_mps, east_mps),
            "bearing_deg": math.degrees(math.atan2(east_mps, north_mps)) % 360.0,
        }
        self._socket.sendto(json.dumps(position).encode(), self._positions_at)


def _event(of_type: int, stamp_ns: int, values: list[float]) -> str:
    event = {"stamp_ns": stamp_ns, "values": values}
    return json.dumps({"package": PACKAGE, "type": of_type, "event": event})
