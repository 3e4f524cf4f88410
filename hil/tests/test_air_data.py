"""An airspeed sensor that is wrong: doubted, flown on without, and taken again.

JSBSim's truth; aircraft, gains and limits are the defaults. The seeds were not used while the
monitor was designed (those were 7 and 21 to 23).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import fcc
import numpy as np
import numpy.typing as npt
import pytest

from fcc_hil import airspeed, altitude
from fcc_hil.campaign.draw import Bounds, Fault, draw
from fcc_hil.campaign.flying import fly
from fcc_hil.faulty_sensors import FaultySensors
from fcc_hil.lockstep import as_controls, as_surfaces, measurements
from fcc_hil.noise import SensorNoise
from fcc_hil.plant import Plant, Weather
from fcc_hil.receiver import Receiver, ReceiverReadings, Velocity
from fcc_hil.sensor_faults import Faults
from fcc_hil.state import State
from fcc_hil.units import FT_TO_M, KT_TO_MPS

SEED = 2112
_FAULT_S = 33.0
"""28 s after engaging."""
_PORT_S = 28.0
"""When a static port is blocked."""
_END_S = 75.0
_VS_KT = 47.0
"""Of the c172p, flaps up (Pilot's Operating Handbook, Cessna 172P 1981, section 5)."""
_VNE_KT = 158.0

_TUBE = "it rises and falls with the altitude: the pitot tube may be blocked"
_NO_ALTIMETER = "altitude contradicts the other sensors and is not used"
_TOO_LOW = "it is lower than forces and motion allow"
_TOO_HIGH = "it is higher than forces and motion allow"

Break = Callable[[Faults], object]


@dataclass
class _Flown:
    """Times in s, airspeeds in kt, one row per tick from the engagement on."""

    time_s: npt.NDArray[np.float64]
    true_kt: npt.NDArray[np.float64]
    true_ft: npt.NDArray[np.float64]
    used_ft: npt.NDArray[np.float64]
    sensed_kt: npt.NDArray[np.float64]
    used_kt: npt.NDArray[np.float64]
    is_doubted: npt.NDArray[np.bool_]
    events: list[str]

    def doubts(self) -> list[str]:
        """Return why the airspeed was doubted, in order, by the events."""
        begin, end = "airspeed of sensor 1 is excluded: ", "; flying on without it"
        parts = [text.partition(begin) for text in self.events]
        return [reason.removesuffix(end) for _, _, reason in parts if reason.endswith(end)]


def _fly(
    break_it: Break | None = None,
    climb_ft: float = 0.0,
    end_s: float = _END_S,
    weather: Weather | None = None,
    disturb: Callable[[Plant], None] | None = None,
    *,
    receiver: ReceiverReadings | None = None,
    turn_every_s: float = math.inf,
    seed: int = SEED,
    throttle_is_measured: bool = False,
    fault_s: float = _FAULT_S,
) -> _Flown:
    """Hold heading and altitude from 5 s on; at the fault's time change the altitude.

    With turns, 90 degrees to the right each.
    """
    plant = Plant("c172p", seed=seed, weather=weather or Weather())
    machine = fcc.Machine('[guidance]\nmode = "hold"\n')
    noise, sensors = SensorNoise(seed), FaultySensors()
    faults = Faults(lambda: plant.time_s, sensors.set_faults)
    if break_it is not None:
        break_it(faults)
    commanded = False
    start_m = heading_rad = math.nan
    turns_s = turn_every_s
    rows: list[tuple[float, ...]] = []
    events: list[str] = []
    while plant.time_s < end_s:
        plant.step(3)
        if disturb is not None:
            disturb(plant)
        state = plant.state()
        measured, _ = sensors.read(plant.time_s, noise.apply(state))
        assert measured is not None
        sample = measurements(measured)
        velocity = receiver.read(state) if receiver else None
        if velocity is not None:
            sample.north_mps, sample.east_mps, sample.down_mps = velocity
        if not commanded and plant.time_s >= fault_s:
            machine.command(altitude_m=start_m + climb_ft * FT_TO_M)
            commanded = True
        if plant.time_s >= turns_s:
            heading_rad = (heading_rad + math.pi / 2.0) % math.tau
            machine.command(heading_rad=heading_rad)
            turns_s += turn_every_s
        stand = as_surfaces(plant.controls) if throttle_is_measured else None
        surfaces = machine.step(sample, readback=stand, switch=plant.time_s >= 5.0)
        events += [event.text for event in machine.events()]
        if surfaces is None:
            continue
        if not rows:
            start_m, heading_rad = state.altitude_m, measured.heading_rad
        plant.write(as_controls(surfaces))
        estimate = machine.estimate
        rows.append(
            (
                plant.time_s,
                state.airspeed_mps / KT_TO_MPS,
                measured.airspeed_mps / KT_TO_MPS,
                estimate.airspeed_mps / KT_TO_MPS,
                estimate.airspeed_source != "sensor",
                state.altitude_m / FT_TO_M,
                estimate.altitude_m / FT_TO_M,
            )
        )
    times_s, true_kt, measured_kt, estimated_kt, doubted, true_ft, used_ft = np.array(rows).T
    is_doubted = doubted > 0.5
    return _Flown(times_s, true_kt, true_ft, used_ft, measured_kt, estimated_kt, is_doubted, events)


@pytest.mark.fault(
    "Sensors",
    "airspeed wrong: tube or drain blocked, decay, jump, slow drift",
    "[forces](envelope.md#air-data) contradict it; a blocked tube: height",
    "step: 0.3 s; else 2.5 s; tube: 1 to 2 s (median) after 10 kt of error "
    "([campaign](results/airspeed.md))",
    "event; airspeed by forces and motion",
)
@pytest.mark.parametrize(
    ("break_it", "climb_ft", "reason"),
    [
        pytest.param(lambda f: f.blocked_tube(after=_FAULT_S), 1_500.0, _TUBE, id="tube, climb"),
        pytest.param(lambda f: f.blocked_tube(after=_FAULT_S), -1_500.0, _TUBE, id="tube, descent"),
        pytest.param(
            lambda f: f.drift(airspeed, per_s=-2.0, after=_FAULT_S), 0.0, _TOO_LOW, id="decay"
        ),
        pytest.param(
            lambda f: f.blocked_tube(drain_is_open=True, after=_FAULT_S),
            0.0,
            _TOO_LOW,
            id="open drain",
        ),
        pytest.param(
            lambda f: f.bias(airspeed, by=15.0, after=_FAULT_S), 0.0, _TOO_HIGH, id="jump"
        ),
    ],
)
@pytest.mark.parametrize("throttle_is_measured", [False, True], ids=["commanded", "measured"])
def test_a_wrong_airspeed_is_doubted_and_flown_on_without(
    break_it: Break, climb_ft: float, reason: str, *, throttle_is_measured: bool
) -> None:
    """A throttle that is measured is known before the flight is engaged, too."""
    flown = _fly(break_it, climb_ft, throttle_is_measured=throttle_is_measured)
    assert flown.true_kt.min() > 1.2 * _VS_KT
    assert flown.true_kt.max() < _VNE_KT
    error_kt = np.abs(flown.sensed_kt - flown.true_kt)
    half_a_second = np.convolve(error_kt, np.full(20, 0.05), "same")
    wrong_s = flown.time_s[half_a_second > 10.0][0]
    doubted_s = flown.time_s[flown.is_doubted][0]
    # As long as is permitted of a tube that is blocked soon after engaging.
    assert doubted_s - wrong_s < 10.0
    later = flown.time_s > _FAULT_S + 15.0
    assert np.abs(flown.used_kt - flown.true_kt)[later].max() < 10.0
    assert np.abs(flown.used_ft - flown.true_ft).max() < 50.0, "the altimeter is right"
    assert flown.doubts() == [reason]


@pytest.mark.parametrize("severity", [0, 2, 3])
def test_an_airspeed_that_decays_is_no_blocked_static_port(severity: int) -> None:
    flown = _fly(
        lambda f: f.drift(airspeed, per_s=-2.0, after=_FAULT_S),
        weather=Weather(turbulence_severity=severity),
        seed=3002,
    )
    assert flown.is_doubted.any()
    assert flown.doubts() == [_TOO_LOW]
    assert np.abs(flown.used_ft - flown.true_ft).max() < 50.0


def _block_static(faults: Faults) -> None:
    """Trap the static pressure; the transducers keep their noise."""
    faults.blocked_static(after=_PORT_S)
    faults.noise(altitude("ft"), sigma=2.5, after=_PORT_S)


@pytest.mark.fault(
    "Sensors",
    "altimeter frozen, static port blocked, in climb or descent",
    "[accelerometers and path](envelope.md#altimeter)",
    "12 m, for 1 s",
    "event; altitude by ground velocity, or pitch and lift; with neither: *altitude lost*",
)
@pytest.mark.parametrize("climb_ft", [1_000.0, -1_000.0, 300.0])
@pytest.mark.parametrize("receiver", [None, Receiver()], ids=["alone", "receiver"])
def test_a_static_port_blocked_in_a_climb_or_descent_is_found(
    climb_ft: float, receiver: Receiver | None
) -> None:
    readings = ReceiverReadings(receiver, SEED) if receiver else None
    flown = _fly(_block_static, climb_ft, receiver=readings, end_s=110.0, fault_s=_PORT_S)
    assert flown.true_kt.min() > 1.2 * _VS_KT
    assert flown.true_kt.max() < _VNE_KT
    assert np.abs(flown.used_ft - flown.true_ft).max() < 250.0
    assert any(_NO_ALTIMETER in text for text in flown.events)


def test_a_sensor_that_agrees_again_is_taken_again() -> None:
    flown = _fly(lambda f: f.bias(airspeed, by=15.0, after=_FAULT_S, lasts=10.0), end_s=65.0)
    assert flown.is_doubted[flown.time_s > _FAULT_S + 5.0][0]
    assert not flown.is_doubted[-1]
    assert flown.doubts() == [_TOO_HIGH]


@pytest.mark.parametrize("receiver", [None, Receiver()], ids=["alone", "receiver"])
def test_a_headwind_that_falls_by_20_kt_in_10_s_is_no_fault(receiver: Receiver | None) -> None:
    def shear(plant: Plant) -> None:
        share = min(1.0, max(0.0, (plant.time_s - 30.0) / 10.0))
        plant.fdm["atmosphere/wind-north-fps"] = share * 20.0 * KT_TO_MPS / FT_TO_M

    readings = ReceiverReadings(receiver, SEED) if receiver else None
    flown = _fly(disturb=shear, receiver=readings, turn_every_s=60.0, end_s=180.0)
    assert flown.true_kt.min() < 97.0, "the wind acts"
    assert not flown.is_doubted.any()


_WINDY = Weather(wind_from_deg=240.0, wind_kt=20.0, turbulence_severity=2)


class _WrongReceiver(ReceiverReadings):
    """A receiver that fails after 100 s, or was never right."""

    def __init__(self, changes: Callable[[Velocity], Velocity] | None) -> None:
        super().__init__(Receiver(), SEED)
        self._changes = changes
        self._last: Velocity | None = None

    def read(self, state: State) -> Velocity | None:
        velocity = super().read(state)
        if velocity is None:
            return None
        if self._changes is not None:
            return self._changes(velocity)
        if self._ticks < 4_000 or self._last is None:
            self._last = velocity
        return self._last


@pytest.mark.parametrize(
    "changes",
    [
        pytest.param(None, id="frozen"),
        pytest.param(lambda v: (v[1], v[0], v[2]), id="north is east"),
        pytest.param(lambda v: (-v[0], v[1], v[2]), id="north is south"),
        pytest.param(lambda v: (v[0] / KT_TO_MPS, v[1] / KT_TO_MPS, v[2] / KT_TO_MPS), id="kt"),
    ],
)
def test_a_wrong_velocity_over_the_ground_is_not_held_against_the_airspeed(
    changes: Callable[[Velocity], Velocity] | None,
) -> None:
    receiver = _WrongReceiver(changes)
    flown = _fly(weather=_WINDY, receiver=receiver, turn_every_s=60.0, end_s=330.0)
    assert not flown.is_doubted.any()
    assert np.abs(flown.used_kt - flown.true_kt).max() < 10.0


@pytest.mark.parametrize("severity", [3, 4])
def test_turbulence_is_no_fault(severity: int) -> None:
    flown = _fly(weather=Weather(turbulence_severity=severity))
    assert not flown.is_doubted.any()


@pytest.mark.parametrize(
    ("seed", "number", "fault"),
    [(200024, 211, Fault("engine out", 17.0, None)), (200026, 108, None)],
    ids=["engine out", "turbulence"],
)
def test_a_healthy_airspeed_is_used_and_kept_above_the_stall(
    seed: int, number: int, fault: Fault | None
) -> None:
    """An engine that fails while the throttle moves, and turbulence near the stall.

    Neither excludes the sensor.
    """
    flown, _ = fly(replace(draw(number, seed, Bounds()), receiver=None, fault=fault))
    doubted = any("is excluded: it is lower" in event.text for event in flown.events)
    assert not doubted
    assert flown.verdict.figures["airspeed_over_stall"] > 1.0


def test_a_blocked_tube_behaves_like_an_altimeter() -> None:
    """FAA-H-8083-15B, chapter 5."""
    sensors = FaultySensors()
    Faults(lambda: 0.0, sensors.set_faults).blocked_tube()
    state = Plant("c172p").state()
    at_first, _ = sensors.read(0.0, state)
    assert at_first is not None
    assert at_first.airspeed_mps == pytest.approx(state.airspeed_mps, abs=1e-6)
    higher = replace(state, pressure_pa=state.pressure_pa - 3_490.0)
    climbed, _ = sensors.read(1.0, higher)
    assert climbed is not None
    # Incompressible: q = rho0 V^2 / 2, less than 2 % off at this speed.
    q_pa = 0.5 * 1.225 * state.airspeed_mps**2 + 3_490.0
    assert climbed.airspeed_mps == pytest.approx(math.sqrt(2.0 * q_pa / 1.225), rel=0.02)
