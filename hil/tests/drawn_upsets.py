"""Upsets that are drawn: aircraft, attitude, rates, airspeed and controls, by seed and number.

JSBSim's truth is set to the upset. Navigation settles while the controls are held where they were
drawn, so that all readings belong to one motion; then the autopilot is engaged.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import count

import numpy as np
from upset_flights import ROUGH, Flight, load_of

from fcc_hil.aircraft import by_name
from fcc_hil.campaign.aircraft import AIRCRAFT
from fcc_hil.configurations import configuration, with_values
from fcc_hil.state import Controls, State
from fcc_hil.units import KT_TO_MPS, STANDARD_GRAVITY_MPS2

LIMIT_LOAD = 3.8
LIMIT_NEGATIVE_LOAD = -1.52
"""14 CFR 23.337, normal category, before 2017."""
_BEGIN_FT = 6_000.0
_HELD_S = 1.1
"""Navigation settles for 1 s before the autopilot may engage."""
_ENGAGED_BY_S = 5.0
_LOADS_GIVEN_BACK = (-1.0, 3.0)
"""Within the limits as far as the servos may still drive the load."""


@dataclass(frozen=True)
class Upset:
    """An upset, and the aircraft."""

    aircraft: str
    weight: str
    roll_deg: float
    pitch_deg: float
    rates_degps: tuple[float, ...]
    """Roll, pitch and yaw."""
    airspeed_kt: float
    angle_of_attack_deg: float
    sideslip_deg: float
    controls: Controls
    """Held until the autopilot has engaged."""

    @property
    def never_exceed_kt(self) -> float:
        """Of the Cessnas the lowest, 172P handbook section 2; J-3: 122 mph, certificate A-691."""
        return 106.0 if self.aircraft == "J3Cub" else 158.0

    @property
    def stall_kt(self) -> float:
        """The stalling speed at 1 g."""
        limits = AIRCRAFT[self.aircraft]
        return limits.stall_kt(limits.loading(self.weight).weight_lb)

    def is_recoverable(self, state: State) -> bool:
        """Return whether a point mass without drag stays below the speed never to exceed.

        After 0.5 s it rolls level at 60 degrees a second and 0 g, then pulls 2 g to the horizon, or
        what the wing can at its airspeed.
        """
        speed = state.true_airspeed_mps
        true_per_shown = speed / state.airspeed_mps
        most = self.never_exceed_kt * KT_TO_MPS * true_per_shown
        stall = self.stall_kt * KT_TO_MPS * true_per_shown
        path = math.asin(max(-1.0, min(1.0, -state.down_mps / speed)))
        left_s, step_s = 0.5 + abs(math.degrees(state.roll_rad)) / 60.0, 0.02
        while speed < most and (left_s > 0.0 or path < 0.0):
            load = 0.0 if left_s > 0.0 else min(2.0, (speed / stall) ** 2)
            path += step_s * STANDARD_GRAVITY_MPS2 * (load - math.cos(path)) / speed
            speed = max(5.0, speed - step_s * STANDARD_GRAVITY_MPS2 * math.sin(path))
            left_s -= step_s
        return speed < most


def draw(random: np.random.Generator) -> Upset:
    """Draw an upset; full deflections up to 1.95 Vs, where the wing reaches 3.8 g, less above."""

    def up_to(most: float) -> float:
        return float(random.uniform(-most, most))

    attitude = Upset(
        aircraft=str(random.choice(list(AIRCRAFT))),
        weight=str(random.choice(["light", "heavy"])),
        roll_deg=up_to(180.0),
        pitch_deg=up_to(75.0),
        rates_degps=tuple(up_to(most) for most in (120.0, 30.0, 40.0)),
        airspeed_kt=0.0,
        angle_of_attack_deg=0.0,
        sideslip_deg=0.0,
        controls=Controls(),
    )
    airspeed_kt = float(random.uniform(0.7 * attitude.stall_kt, attitude.never_exceed_kt))
    lift = (airspeed_kt / attitude.stall_kt) ** 2
    full = min(1.0, LIMIT_LOAD / lift)
    return replace(
        attitude,
        airspeed_kt=airspeed_kt,
        # On a line of lift from -2.7 degrees to 16.
        angle_of_attack_deg=-2.7 + 18.7 * float(random.uniform(0.0, min(2.5, lift))) / lift,
        sideslip_deg=up_to(8.0 * full),
        controls=Controls(up_to(full), up_to(full), up_to(full), float(random.uniform())),
    )


def begin(seed: int, number: int) -> tuple[Upset, Flight]:
    """Return the first drawn upset that can be recovered, and a flight that has engaged in it."""
    random = np.random.default_rng((seed, number))
    for attempt in count():
        upset = draw(random)
        flight = _engaged(upset, seed + 1_000 * number + attempt)
        state = flight.plant.state()
        least, most = _LOADS_GIVEN_BACK
        if (
            flight.machine.holds_control
            and least < load_of(state) < most
            and upset.is_recoverable(state)
        ):
            return upset, flight
    raise AssertionError


def _engaged(upset: Upset, seed: int) -> Flight:
    limits = AIRCRAFT[upset.aircraft]
    aircraft = replace(by_name(upset.aircraft), loading=limits.loading(upset.weight))
    values: dict[str, float | str] = {
        "guidance.mode": "timed-pattern",
        "guidance.hold_s": 600.0,
        "engage.permit_upset": True,
        "autopilot.envelope.stall_airspeed_kt": limits.stall_setting_kt,
    }
    config = with_values(configuration(upset.aircraft), values)
    flight = Flight(replace(ROUGH, aircraft=aircraft, seed=seed, config=config))
    fdm = flight.plant.fdm
    fdm["ic/h-sl-ft"] = _BEGIN_FT
    fdm["ic/phi-deg"] = upset.roll_deg
    fdm["ic/theta-deg"] = upset.pitch_deg
    fdm["ic/vc-kts"] = upset.airspeed_kt
    fps = fdm["ic/vt-fps"]
    alpha, beta = math.radians(upset.angle_of_attack_deg), math.radians(upset.sideslip_deg)
    fdm["ic/u-fps"] = fps * math.cos(alpha) * math.cos(beta)
    fdm["ic/v-fps"] = fps * math.sin(beta)
    fdm["ic/w-fps"] = fps * math.sin(alpha) * math.cos(beta)
    for axis, rate in zip("pqr", upset.rates_degps, strict=True):
        fdm[f"ic/{axis}-rad_sec"] = math.radians(rate)
    fdm.run_ic()
    flight.flown = upset.controls
    for tick in count():
        if flight.machine.holds_control or flight.plant.time_s > _ENGAGED_BY_S:
            return flight
        # Again, if it was refused: two readings of each position.
        flight.switch = flight.plant.time_s > _HELD_S and tick % 4 > 1
        flight.tick(upset.controls)
    raise AssertionError
