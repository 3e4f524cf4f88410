"""The wind of a simulated aircraft that begins, and ends, on its wheels."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from .units import FT_TO_M, KT_TO_MPS

if TYPE_CHECKING:
    import jsbsim

    from .plant import Weather

_LEAST_AHEAD_MPS = 1.0
_ROLLS_MPS = 5.0


class WindOnWheels:
    """Steady wind that is not exactly from the side while the aircraft stands or is slow.

    With no air from ahead JSBSim's angle of attack may be any, and with it the pitching moment: in
    8 kt exactly from the side the c172p turns over on its wheels.
    """

    def __init__(self, fdm: jsbsim.FGFDMExec, weather: Weather) -> None:
        """Let it blow on an aircraft that stands."""
        self._fdm = fdm
        self._weather = weather
        self._is_slow = True
        self._blow(self._not_abeam_deg())

    def follow(self) -> None:
        """Set it anew when the aircraft begins to roll, and when it is about to stand."""
        is_slow = self._ground_speed_mps() < _ROLLS_MPS
        if is_slow == self._is_slow or self._wind_fps() != self._blown_fps:
            return
        self._is_slow = is_slow
        self._blow(self._not_abeam_deg() if is_slow else self._weather.wind_from_deg)

    def _ground_speed_mps(self) -> float:
        fdm = self._fdm
        return math.hypot(fdm["velocities/v-north-fps"], fdm["velocities/v-east-fps"]) * FT_TO_M

    def _wind_fps(self) -> tuple[float, float]:
        fdm = self._fdm
        return fdm["atmosphere/wind-north-fps"], fdm["atmosphere/wind-east-fps"]

    def _blow(self, from_deg: float) -> None:
        to_rad = math.radians(from_deg) + math.pi
        fps = self._weather.wind_kt * KT_TO_MPS / FT_TO_M
        self._fdm["atmosphere/wind-north-fps"] = fps * math.cos(to_rad)
        self._fdm["atmosphere/wind-east-fps"] = fps * math.sin(to_rad)
        self._blown_fps = self._wind_fps()

    def _not_abeam_deg(self) -> float:
        weather = self._weather
        heading_deg = math.degrees(self._fdm["attitude/psi-rad"])
        off_deg = math.remainder(weather.wind_from_deg - heading_deg, 360.0)
        ahead_mps = weather.wind_kt * KT_TO_MPS * math.cos(math.radians(off_deg))
        if abs(ahead_mps) >= _LEAST_AHEAD_MPS:
            return weather.wind_from_deg
        share = min(1.0, _LEAST_AHEAD_MPS / max(weather.wind_kt * KT_TO_MPS, _LEAST_AHEAD_MPS))
        return heading_deg + math.copysign(math.degrees(math.acos(share)), off_deg)
