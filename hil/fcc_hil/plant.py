"""JSBSim as the plant: set up, trimmed, stepped in lockstep, in the project's units and signs.

    plant = Plant("c172p", seed=1)
    while plant.time_s < 60.0:
        state = plant.state()
        plant.write(controls_from(state))
        plant.step(3)                       # 3 steps of 1/120 s: a 40 Hz loop

Everything is seeded: the same calls give the same bits on one machine.
"""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import jsbsim

from .aircraft import Aircraft, by_name
from .electrical import Battery
from .settle import SettlingPilot
from .state import Controls, State
from .terrain_tiles import Tiles
from .units import (
    FT_TO_M,
    KT_TO_MPS,
    PSF_TO_PA,
    RANKINE_TO_KELVIN,
    SEA_LEVEL_PRESSURE_PA,
    wrap_heading_rad,
)
from .wind_on_wheels import WindOnWheels

STEPS_PER_SECOND = 120
"""JSBSim's own rate, Hz: three steps to a tick of a 40 Hz loop."""

STEP_S = 1.0 / STEPS_PER_SECOND

_ELEVATOR_TRIM = "fcs/pitch-trim-cmd-norm"
"""Positive lowers the nose."""

_MODELS = Path(__file__).with_name("models")
"""Aircraft that JSBSim lacks."""

_ENGINE_RPM = "propulsion/engine/engine-rpm"

_SETTLING_S = 60.0
_SETTLING_MEAN_S = 5.0
_STANDING_S = 5.0
_MILSPEC_TURBULENCE = 3.0
_TURBULENCE_WIND_FPS = {1: 15.0, 2: 20.0, 3: 25.0, 4: 50.0, 5: 75.0, 6: 90.0, 7: 100.0}

# JSBSim prints a banner and explains a failed trim on standard output; the caller gets the failure
# as a value.
jsbsim.set_logger(jsbsim.DefaultLogger(jsbsim.LogLevel.FATAL))


@dataclass(frozen=True)
class Weather:
    """The weather."""

    wind_from_deg: float = 0.0
    """Where the steady wind comes from, true."""
    wind_kt: float = 0.0
    turbulence_severity: int = 0
    """0 calm; else the index of probability of exceedance of MIL-F-8785C, 3 light, 4 moderate."""
    turbulence_wind_fps: float | None = None
    """Wind at 20 ft that sets the gusts' strength; by default 25 for severity 3, 50 for 4."""
    off_standard_k: float = 0.0
    """By how much the air is warmer than the standard atmosphere, at every altitude."""


class TrimError(RuntimeError):
    """The aircraft could neither be trimmed nor flown to a steady state."""


class Plant:
    """One aircraft in flight."""

    _wind: WindOnWheels | None = None
    """That of an aircraft that began on its wheels."""
    _terrain: Tiles | None = None

    def __init__(
        self,
        aircraft: str | Aircraft,
        *,
        seed: int = 1,
        heading_deg: float = 0.0,
        weather: Weather | None = None,
        latitude_deg: float = 0.0,
        longitude_deg: float = 0.0,
        qnh_pa: float = SEA_LEVEL_PRESSURE_PA,
        runway_elevation_ft: float | None = None,
    ) -> None:
        """Load and trim `aircraft`; it then flies straight and level, controls centred.

        With the elevation of a runway it stands there, its engines idling and its brakes set.
        Raises ValueError for a name that is not in the table, and TrimError.
        """
        self.aircraft = by_name(aircraft) if isinstance(aircraft, str) else aircraft
        self.seed = seed
        self.battery = Battery()
        weather = weather or Weather()
        self.fdm = fdm = jsbsim.FGFDMExec(None)
        fdm.set_debug_level(0)
        if (_MODELS / self.aircraft.name).is_dir():
            fdm.set_aircraft_path(str(_MODELS))
        if not fdm.load_model(self.aircraft.name):
            raise ValueError(f"JSBSim has no aircraft '{self.aircraft.name}'")
        self._silence_output()
        fdm.set_dt(STEP_S)
        fdm["simulation/randomseed"] = seed
        if self.aircraft.loading is not None:
            self.aircraft.loading.apply(fdm)
        fdm["ic/terrain-elevation-ft"] = runway_elevation_ft or 0.0
        fdm["ic/lat-geod-deg"] = latitude_deg
        fdm["ic/long-gc-deg"] = longitude_deg
        self._set_air(qnh_pa, weather.off_standard_k)
        flies = runway_elevation_ft is None
        if flies:
            fdm["ic/h-sl-ft"] = self.aircraft.altitude_ft
        else:
            fdm["ic/h-agl-ft"] = self.aircraft.drop_ft
        fdm["ic/vc-kts"] = self.aircraft.airspeed_kt if flies else 0.0
        fdm["ic/gamma-deg"] = 0.0
        fdm["ic/psi-true-deg"] = heading_deg
        if weather.wind_kt != 0.0 and flies:
            self._set_wind(weather, heading_deg)
        if self.aircraft.retractable_gear and flies:
            fdm["gear/gear-cmd-norm"] = 0.0
            fdm["gear/gear-pos-norm"] = 0.0
        fdm.run_ic()

        self._controls = Controls()
        self.engines: int = fdm.get_propulsion().get_num_engines()
        self._throttles = [f"fcs/throttle-cmd-norm[{i}]" for i in range(self.engines)]
        self._has_pistons = fdm.get_property_manager().hasNode(_ENGINE_RPM)
        self._start_engines()
        self.trimmed_by_jsbsim = flies and self.aircraft.trims and self._trim()
        if not flies:
            self._stand(weather)
        elif not self.trimmed_by_jsbsim:
            self._fly_to_steady_state(heading_deg)
        self.trim = Controls(throttle=float(fdm[self._throttles[0]]))
        """The controls that hold the trimmed flight: surfaces centred, throttle as trimmed."""
        self._controls = Controls(
            throttle=self.trim.throttle, elevator_trim=-float(fdm[_ELEVATOR_TRIM])
        )
        self._set_turbulence(weather)
        self.steps = 0
        """Steps of 1/120 s since the set-up was done."""

    @property
    def time_s(self) -> float:
        """Simulated time since the set-up was done."""
        return self.steps / STEPS_PER_SECOND

    @property
    def controls(self) -> Controls:
        """The controls last written."""
        return self._controls

    def _set_air(self, qnh_pa: float, off_standard_k: float) -> None:
        """Set what differs from the standard: even setting what it is changes the turbulence."""
        if qnh_pa != SEA_LEVEL_PRESSURE_PA:
            self.set_qnh(qnh_pa)
        if off_standard_k != 0.0:
            self.fdm["atmosphere/delta-T"] = off_standard_k / RANKINE_TO_KELVIN

    def set_qnh(self, pressure_pa: float) -> None:
        """Set the pressure at sea level."""
        self.fdm["atmosphere/P-sl-psf"] = pressure_pa / PSF_TO_PA

    def set_gust(self, *, north_mps: float, east_mps: float, down_mps: float) -> None:
        """Set the velocity of a gust over the ground, which adds to wind and turbulence."""
        self.fdm["atmosphere/gust-north-fps"] = north_mps / FT_TO_M
        self.fdm["atmosphere/gust-east-fps"] = east_mps / FT_TO_M
        self.fdm["atmosphere/gust-down-fps"] = down_mps / FT_TO_M

    def fly_over(self, terrain: Tiles) -> None:
        """Let the ground be that of tiles from now on; as it was where they do not know it."""
        self._terrain = terrain

    def fail_engines(self) -> None:
        """Switch the ignition off: a windmilling propeller, no power."""
        self.fdm["propulsion/magneto_cmd"] = 0

    def write(self, controls: Controls, throttles: Sequence[float] | None = None) -> None:
        """Command the controls; values beyond their range are clipped.

        `throttles`, one for each engine, replace the common throttle.
        """
        clipped = replace(
            controls,
            elevator=min(1.0, max(-1.0, controls.elevator)),
            aileron=min(1.0, max(-1.0, controls.aileron)),
            rudder=min(1.0, max(-1.0, controls.rudder)),
            throttle=min(1.0, max(0.0, controls.throttle)),
            elevator_trim=self._controls.elevator_trim,
        )
        fdm = self.fdm
        for path, value in (
            ("fcs/flap-cmd-norm", controls.flaps),
            # Without effect on a gear that is not retractable.
            ("gear/gear-cmd-norm", controls.gear),
            ("fcs/left-brake-cmd-norm", controls.left_brake),
            ("fcs/right-brake-cmd-norm", controls.right_brake),
            ("fcs/center-brake-cmd-norm", None if controls.left_brake is None else 0.0),
        ):
            if value is not None:
                fdm[path] = min(1.0, max(0.0, value))
        # The nose wheel of most aircraft here follows the pedals.
        steered = controls.rudder if controls.nose_wheel is None else controls.nose_wheel
        fdm["fcs/steer-cmd-norm"] = min(1.0, max(-1.0, steered))
        if controls.elevator_trim is not None:
            clipped.elevator_trim = min(1.0, max(-1.0, controls.elevator_trim))
            fdm[_ELEVATOR_TRIM] = -clipped.elevator_trim
        # JSBSim: a positive elevator lowers the nose, a positive rudder yaws left.
        fdm["fcs/elevator-cmd-norm"] = -clipped.elevator
        fdm["fcs/aileron-cmd-norm"] = clipped.aileron
        fdm["fcs/rudder-cmd-norm"] = -clipped.rudder
        for index, path in enumerate(self._throttles):
            throttle = clipped.throttle if throttles is None else throttles[index]
            fdm[path] = min(1.0, max(0.0, throttle))
        self._controls = clipped

    def step(self, steps: int = 1) -> None:
        """Advance by `steps` of 1/120 s with the present controls."""
        run = self.fdm.run
        if self._wind is not None:
            self._wind.follow()
        for _ in range(steps):
            if self._terrain is not None:
                self._follow_ground(self._terrain)
            run()
        self.steps += steps
        # What turbines drive is not modelled: their generators feed.
        speed_radps = self._engine_speed_radps() if self._has_pistons else math.inf
        self.battery.step(steps * STEP_S, speed_radps)

    def state(self) -> State:
        """Return the true state now."""
        f = self.fdm
        return State(
            time_s=self.steps / STEPS_PER_SECOND,
            pitch_rad=f["attitude/theta-rad"],
            roll_rad=f["attitude/phi-rad"],
            heading_rad=wrap_heading_rad(f["attitude/psi-rad"]),
            roll_rate_radps=f["velocities/p-rad_sec"],
            pitch_rate_radps=f["velocities/q-rad_sec"],
            yaw_rate_radps=f["velocities/r-rad_sec"],
            specific_force_x_mps2=f["accelerations/a-pilot-x-ft_sec2"] * FT_TO_M,
            specific_force_y_mps2=f["accelerations/a-pilot-y-ft_sec2"] * FT_TO_M,
            specific_force_z_mps2=f["accelerations/a-pilot-z-ft_sec2"] * FT_TO_M,
            airspeed_mps=f["velocities/vc-kts"] * KT_TO_MPS,
            true_airspeed_mps=f["velocities/vt-fps"] * FT_TO_M,
            mach=f["velocities/mach"],
            altitude_m=f["atmosphere/pressure-altitude"] * FT_TO_M,
            pressure_pa=f["atmosphere/P-psf"] * PSF_TO_PA,
            temperature_k=f["atmosphere/T-R"] * RANKINE_TO_KELVIN,
            angle_of_attack_rad=f["aero/alpha-rad"],
            sideslip_rad=f["aero/beta-rad"],
            latitude_rad=f["position/lat-geod-rad"],
            longitude_rad=f["position/long-gc-rad"],
            elevation_m=f["position/h-sl-ft"] * FT_TO_M,
            height_m=f["position/h-agl-ft"] * FT_TO_M,
            north_mps=f["velocities/v-north-fps"] * FT_TO_M,
            east_mps=f["velocities/v-east-fps"] * FT_TO_M,
            down_mps=f["velocities/v-down-fps"] * FT_TO_M,
            wind_north_mps=f["atmosphere/total-wind-north-fps"] * FT_TO_M,
            wind_east_mps=f["atmosphere/total-wind-east-fps"] * FT_TO_M,
            wind_down_mps=f["atmosphere/total-wind-down-fps"] * FT_TO_M,
            on_ground=f["gear/wow"] != 0.0,
            engine_speed_radps=self._engine_speed_radps(),
            battery_voltage_v=self.battery.voltage_v,
        )

    def _follow_ground(self, terrain: Tiles) -> None:
        """Set the elevation of the ground below."""
        fdm = self.fdm
        place = fdm["position/lat-geod-deg"], fdm["position/long-gc-deg"]
        elevation_m = terrain.elevation_m(*place)
        if elevation_m is not None:
            fdm["position/terrain-elevation-asl-ft"] = elevation_m / FT_TO_M

    def _engine_speed_radps(self) -> float:
        """Return the speed of a piston engine; 0 of another."""
        return float(self.fdm[_ENGINE_RPM]) * math.tau / 60.0 if self._has_pistons else 0.0

    def _silence_output(self) -> None:
        """Keep the model from writing its log files, which JSBSim opens even when disabled."""
        index = 0
        while self.fdm.get_output_filename(index):
            self.fdm.set_output_filename(index, os.devnull)
            index += 1
        self.fdm.disable_output()

    def _set_wind(self, weather: Weather, heading_deg: float) -> None:
        """Set steady wind so that the aircraft starts at its airspeed with no sideslip.

        JSBSim 1.3.3 confuses the wind with an airspeed that is set together with it, so the
        velocity over the ground is set directly and the wind last. Its wind direction is where the
        wind blows to.
        """
        fdm = self.fdm
        air_fps = fdm["ic/vt-fps"]
        wind_fps = weather.wind_kt * KT_TO_MPS / FT_TO_M
        heading_rad = math.radians(heading_deg)
        to_rad = math.radians(weather.wind_from_deg) + math.pi
        fdm["ic/vn-fps"] = air_fps * math.cos(heading_rad) + wind_fps * math.cos(to_rad)
        fdm["ic/ve-fps"] = air_fps * math.sin(heading_rad) + wind_fps * math.sin(to_rad)
        fdm["ic/vd-fps"] = 0.0
        fdm["ic/psi-true-deg"] = heading_deg
        fdm["ic/vw-mag-fps"] = wind_fps
        fdm["ic/vw-dir-deg"] = math.degrees(to_rad) % 360.0

    def _start_engines(self) -> None:
        fdm = self.fdm
        fdm["propulsion/magneto_cmd"] = 3
        fdm["propulsion/set-running"] = -1
        for i in range(self.engines):
            fdm[f"fcs/mixture-cmd-norm[{i}]"] = 1.0

    def _stand(self, weather: Weather) -> None:
        """Let the aircraft settle on its wheels, in the wind."""
        fdm = self.fdm
        for brake in ("left", "right", "center"):
            fdm[f"fcs/{brake}-brake-cmd-norm"] = 1.0
        for path in self._throttles:
            fdm[path] = 0.0
        self._wind = WindOnWheels(fdm, weather)
        for _ in range(round(_STANDING_S * STEPS_PER_SECOND)):
            fdm.run()

    def _trim(self) -> bool:
        fdm = self.fdm
        try:
            fdm["simulation/do_simple_trim"] = 1
        except jsbsim.TrimFailureError:
            return False
        # The trim leaves the elevator in its trim property, but aileron and rudder in their
        # commands, which the first write would overwrite.
        self._move_to_trim("aileron", "roll")
        self._move_to_trim("rudder", "yaw")
        return True

    def _move_to_trim(self, surface: str, axis: str) -> None:
        command, trim = f"fcs/{surface}-cmd-norm", f"fcs/{axis}-trim-cmd-norm"
        self.fdm[trim] = self.fdm[trim] + self.fdm[command]
        self.fdm[command] = 0.0

    def _fly_to_steady_state(self, heading_deg: float) -> None:
        """Fly for a minute in closed loop, then keep the mean controls as the trim."""
        fdm = self.fdm
        self.steps = 0
        pilot = SettlingPilot(
            airspeed_mps=self.aircraft.airspeed_kt * KT_TO_MPS,
            altitude_m=self.aircraft.altitude_ft * FT_TO_M,
            heading_rad=math.radians(heading_deg),
        )
        fdm["propulsion/starter_cmd"] = 1
        mean = Controls()
        samples = 0
        while self.time_s < _SETTLING_S:
            state = self.state()
            controls = pilot.step(state, 3 * STEP_S)
            self.write(controls)
            self.step(3)
            if not math.isfinite(state.pitch_rad):
                raise TrimError(
                    f"{self.aircraft.name}: JSBSim's state is no longer finite while settling; "
                    "choose another speed or altitude in the aircraft table"
                )
            if self.time_s > _SETTLING_S - _SETTLING_MEAN_S:
                samples += 1
                mean.elevator += (controls.elevator - mean.elevator) / samples
                mean.aileron += (controls.aileron - mean.aileron) / samples
                mean.throttle += (controls.throttle - mean.throttle) / samples
        state = self.state()
        if abs(math.degrees(state.roll_rad)) > 5.0 or abs(state.down_mps) > 2.0:
            raise TrimError(
                f"{self.aircraft.name}: no steady flight after {_SETTLING_S:.0f} s "
                f"(roll {math.degrees(state.roll_rad):.1f} deg, climb {-state.down_mps:.1f} m/s); "
                "choose another speed or altitude in the aircraft table"
            )
        self.write(mean)
        self._move_to_trim("elevator", "pitch")
        self._move_to_trim("aileron", "roll")

    def _set_turbulence(self, weather: Weather) -> None:
        severity = weather.turbulence_severity
        if severity == 0:
            return
        if severity not in _TURBULENCE_WIND_FPS:
            raise ValueError(f"turbulence severity {severity}: choose 0 (calm) to 7")
        wind_fps = weather.turbulence_wind_fps
        fdm = self.fdm
        fdm["atmosphere/turb-type"] = _MILSPEC_TURBULENCE
        fdm["atmosphere/turbulence/milspec/windspeed_at_20ft_AGL-fps"] = (
            _TURBULENCE_WIND_FPS[severity] if wind_fps is None else wind_fps
        )
        fdm["atmosphere/turbulence/milspec/severity"] = severity
