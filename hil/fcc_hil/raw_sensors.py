"""The raw sensors of a phone or a board on an aircraft of JSBSim.

The same model as in the built-in aircraft, from the module `fcc`: this is its truth.
"""

from __future__ import annotations

import fcc

from .plant import Plant
from .quantities import SENSORS
from .units import impact_pressure_pa

FIELD_UT = (21.1, 0.0, 45.3)
"""The earth's magnetic field: 50 uT, 65 degrees down, without variation. Of middle latitudes, and
everywhere the same here."""

DELAYS_S = {
    "phone": {
        "accelerometer": 0.0174,
        "gyroscope": 0.0174,
        "magnetometer": 0.024,
        "static_pressure": 0.044,
        "differential_pressure": 0.034,
        "gnss": 0.12,
    },
    "board": {
        "accelerometer": 0.0022,
        "gyroscope": 0.0022,
        "magnetometer": 0.0108,
        "static_pressure": 0.0208,
        "differential_pressure": 0.0108,
        "gnss": 0.12,
    },
}
DELAYS_S["board-rtk"] = DELAYS_S["board"]
"""What a user would know of the delays: the mean, jitter included."""


READINGS = {
    "raw_body_rates": ("raw_roll_rate_radps", "raw_pitch_rate_radps", "raw_yaw_rate_radps"),
    "raw_specific_force": tuple(f"raw_specific_force_{axis}_mps2" for axis in "xyz"),
    "magnetic_field": tuple(f"magnetic_field_{axis}_ut" for axis in "xyz"),
    "static_pressure": ("static_pressure_pa",),
    "differential_pressure": ("differential_pressure_pa",),
    "air_temperature": ("air_temperature_k",),
    "gnss": (
        "gnss_latitude_rad",
        "gnss_longitude_rad",
        "gnss_position_altitude_m",
        "gnss_north_mps",
        "gnss_east_mps",
        "gnss_down_mps",
    ),
    "range": ("range_m",),
}
"""The raw readings, each with its values among the measurements."""

_OF_STATE = (
    *("time_s", *SENSORS["attitude"], *SENSORS["heading"]),
    *(*SENSORS["body_rates"], *SENSORS["specific_force"]),
    *("latitude_rad", "longitude_rad", "north_mps", "east_mps", "down_mps", "height_m"),
)
"""What the truth has of the aircraft's state, by the same names."""


class RawSensors:
    """The raw sensors of one aircraft, and everything that they have read."""

    def __init__(self, plant: Plant, sensors: str, *, seed: int = 1) -> None:
        """Switch them on; `sensors` is phone or board."""
        self._plant = plant
        self._sensors = fcc.RawSensors(sensors, self._truth(), seed=seed, field_ut=FIELD_UT)
        self._delays_s = DELAYS_S[sensors]
        self.readings: dict[str, list[tuple[float, ...]]] = {name: [] for name in READINGS}
        """Of each reading when it arrived, in s, and its values in the order of READINGS."""

    def step(self) -> None:
        """Take the samples up to the plant's present time; call it after each of its steps."""
        self._sensors.step(self._truth())

    def read(self, into: fcc.Measurements) -> dict[str, float]:
        """Write what arrived since the last time into measurements.

        Return how long ago each reading was taken, in s, as far as its delay is known.
        """
        ages_s = {}
        for name, arrived_s in self._sensors.read(into).items():
            values = (getattr(into, value) for value in READINGS[name])
            self.readings[name].append((arrived_s, *values))
            waited_s = max(0.0, self._plant.time_s - arrived_s)
            ages_s[name] = waited_s + self._delays_s.get(name, 0.0)
        return ages_s

    def _truth(self) -> fcc.RawTruth:
        state = self._plant.state()
        return fcc.RawTruth(
            static_pressure_pa=state.pressure_pa,
            differential_pressure_pa=impact_pressure_pa(state.airspeed_mps),
            air_temperature_k=state.temperature_k,
            position_altitude_m=state.elevation_m,
            throttle=min(1.0, max(0.0, self._plant.controls.throttle)),
            **{name: getattr(state, name) for name in _OF_STATE},
        )
