"""Degraded flight: every row of the table in docs/faults.md, against JSBSim's truth.

Lost in the first turn of the pattern, at 30° of bank; back 20 s later.
"""

from __future__ import annotations

from collections.abc import Sequence

import fcc
import numpy as np
import pytest
from degraded_rows import LEVEL_AFTER_S, PITCH_AND_POWER, ROWS, SinceLoss

from fcc_hil.faulty_sensors import Kind, SensorFault
from fcc_hil.lockstep_rig import LockstepRig
from fcc_hil.plant import Plant, Weather
from fcc_hil.quantities import SENSORS
from fcc_hil.standin import Settings
from fcc_hil.units import KT_TO_MPS

SEED = 11
"""Not one of those on which the laws were developed (7)."""
LOST_AT_S = 30.0
LOST_FOR_S = 20.0
MOST_FORCES_SD_MPS = 2.6
"""5 % of 100 kt."""


class Flight:
    """A flight that is engaged, with sensors lost from `LOST_AT_S` on."""

    def __init__(
        self,
        lost: Sequence[str],
        lasts_s: float,
        *,
        aircraft: str = "c172x",
        config: str = "",
        seed: int = SEED,
        severity: int = 0,
        bias_kt: float = 0.0,
    ) -> None:
        plant = Plant(aircraft, seed=seed, weather=Weather(turbulence_severity=severity))
        settings = Settings(port=0, aircraft=aircraft, seed=seed, noise=True)
        self.rig = LockstepRig(settings, plant, fcc.Machine(config))
        self.rig.prepare()
        self.rig.set_switch(on=True)
        self.rig.fly_to(self.rig.time_s + 0.1)
        self.rig.set_switch(on=False)
        self.rig.fly_to(self.rig.time_s + 0.6)
        self.rig.set_switch(on=True)
        self.rig.fly_to(self.rig.time_s + 0.1)
        self.rig.fly_to(self.rig.time_s + 0.6, until=lambda: self.rig.machine.state == "engaged")
        self.began_s = self.rig.time_s
        begins_s = self.began_s + LOST_AT_S
        faults = [
            SensorFault(Kind.LOSS, name, SENSORS[name], begins_s, begins_s + lasts_s)
            for name in lost
        ]
        if bias_kt != 0.0:
            wrong = SENSORS["airspeed"]
            faults.append(
                SensorFault(
                    Kind.BIAS, "airspeed", wrong, begins_s - 5.0, amount=bias_kt * KT_TO_MPS
                )
            )
        self.rig.set_faults(faults)

    def fly_to(self, time_s: float) -> None:
        """Fly to a time since engaging."""
        self.rig.fly_to(self.began_s + time_s)

    def since_loss(self) -> SinceLoss:
        """Return the truth so far."""
        return SinceLoss(self.rig.truth(), self.began_s, self.began_s + LOST_AT_S)

    def between(self, column: str, begin_s: float, end_s: float) -> np.ndarray:
        """Return a column of the truth, by times since the loss."""
        return self.since_loss().between(column, begin_s, end_s)

    def events(self) -> list[tuple[float, str]]:
        """Return the events since the loss, with their times since then."""
        begin_s = self.began_s + LOST_AT_S
        return [
            (event.time_s - begin_s, event.text)
            for event in self.rig.events
            if event.time_s > begin_s
        ]

    def when(self, text: str) -> float:
        """Return when an event came, s since the loss."""
        return next(time_s for time_s, words in self.events() if text in words)


@pytest.mark.fault(
    "Degraded flight",
    "altitude lost, replaced by the receiver's ground velocity, else by level flight",
    "level; without receiver wings level, pitch, power",
    "`failsafe.degraded_s`",
    "end",
)
@pytest.mark.fault(
    "Degraded flight",
    "airspeed lost otherwise",
    "wings level, pitch by altitude, level-flight power",
    "`failsafe.degraded_s`",
    "end",
)
@pytest.mark.fault(
    "Degraded flight",
    "acceleration lost, not replaced",
    "wings level, airspeed, pitch by altitude",
    "`failsafe.degraded_s`",
    "end",
)
@pytest.mark.parametrize("name", ROWS)
def test_what_is_left_is_held_and_then_the_pattern_is_flown_on(name: str) -> None:
    lost, limits = ROWS[name]
    flight = Flight(lost, LOST_FOR_S)
    flight.fly_to(LOST_AT_S + LOST_FOR_S + 11.0)
    assert flight.when("engaged -> failsafe") == pytest.approx(0.25, abs=0.06)
    assert flight.when("now: flying on without a lost quantity") < 0.4
    flight.since_loss().assert_held(limits, LOST_FOR_S)
    if name in PITCH_AND_POWER:
        assert np.ptp(flight.between("throttle", LEVEL_AFTER_S, LOST_FOR_S)) < 0.01
    # Good for 2 s: the same leg, its heading and its altitude.
    assert flight.when("failsafe cleared") == pytest.approx(LOST_FOR_S + 2.0, abs=0.1)
    assert flight.when("failsafe -> engaged") == pytest.approx(LOST_FOR_S + 2.0, abs=0.1)
    assert not [text for _, text in flight.events() if text.startswith("mode: ")]
    captured = flight.rig.truth().captured_at(flight.began_s)
    end = (LOST_FOR_S + 9.0, LOST_FOR_S + 11.0)
    turned_deg = flight.between("heading_deg", *end) - captured.heading_deg
    assert np.max(np.abs((turned_deg - 90.0 + 180.0) % 360.0 - 180.0)) < 3.0
    climbed_ft = flight.between("altitude_ft", *end) - captured.altitude_ft
    assert np.max(np.abs(climbed_ft - 150.0)) < 20.0


@pytest.mark.fault(
    "Degraded flight",
    "airspeed lost, replaced by that [of forces](envelope.md#air-data): standard deviation "
    "below 5 % of the reference airspeed; attitude, acceleration, altitude known",
    "level",
    "`failsafe.degraded_s`",
    "end",
)
@pytest.mark.parametrize("aircraft", ["c172p", "c172x"])
def test_a_lost_airspeed_is_replaced_by_forces(aircraft: str) -> None:
    flight = Flight(["airspeed"], LOST_FOR_S, aircraft=aircraft)
    for time_s in np.arange(1.0, LOST_FOR_S, 0.5):
        flight.fly_to(LOST_AT_S + float(time_s))
        estimate = flight.rig.machine.estimate
        assert estimate.airspeed_source == "forces"
        assert estimate.airspeed_uncertainty_mps < MOST_FORCES_SD_MPS


def test_a_lost_airspeed_is_replaced_by_forces_in_turbulence() -> None:
    """By pitch and power alone the same flight differs by 22 kt."""
    flight = Flight(["airspeed"], LOST_FOR_S, aircraft="c172r", seed=22, severity=3)
    flight.fly_to(LOST_AT_S + LOST_FOR_S)
    airspeed_kt = flight.between("airspeed_kt", LEVEL_AFTER_S, LOST_FOR_S)
    assert np.max(np.abs(airspeed_kt - 100.0)) < 14.0
    assert flight.since_loss().climbed_ft(LOST_FOR_S) < 40.0


def test_a_doubted_airspeed_counts_as_lost_when_another_quantity_is() -> None:
    flight = Flight(["heading"], LOST_FOR_S, aircraft="c172p", bias_kt=15.0)
    flight.fly_to(LOST_AT_S)
    assert flight.rig.machine.estimate.airspeed_source == "forces"
    flight.fly_to(LOST_AT_S + LOST_FOR_S)
    assert flight.rig.machine.state == "failsafe"
    airspeed_kt = flight.between("airspeed_kt", LEVEL_AFTER_S, LOST_FOR_S)
    assert np.max(np.abs(airspeed_kt - 100.0)) < 7.0


def test_half_a_second_without_any_sensor_is_flown_through() -> None:
    flight = Flight(list(SENSORS), 0.5)
    flight.fly_to(LOST_AT_S + 12.0)
    assert flight.when("failsafe -> engaged") == pytest.approx(2.5, abs=0.1)
    assert np.max(np.abs(flight.between("roll_deg", 0.0, 12.0))) < 35.0
    assert flight.since_loss().climbed_ft(12.0) < 50.0
    assert not [text for _, text in flight.events() if text.startswith("mode: ")]


@pytest.mark.parametrize("period_s", [0.3, 0.5])
def test_body_rates_that_come_and_go_are_left_out(period_s: float) -> None:
    """With each return flown, the pitch rate's standard deviation is 58 deg/s."""
    flight = Flight([], 0.0, aircraft="c172p")
    begins_s = flight.began_s + LOST_AT_S
    slow = SensorFault(
        Kind.SLOW,
        "body_rates",
        SENSORS["body_rates"],
        begins_s,
        begins_s + LOST_FOR_S,
        amount=period_s,
    )
    flight.rig.set_faults([slow])
    flight.fly_to(LOST_AT_S + LOST_FOR_S + 3.0)
    assert np.std(flight.between("pitch_rate_degps", LEVEL_AFTER_S, LOST_FOR_S)) < 2.0
    assert len(flight.events()) < 15
    assert flight.when("failsafe -> engaged") == pytest.approx(LOST_FOR_S + 2.0, abs=period_s)


def test_without_attitude_and_rates_control_is_given_back() -> None:
    flight = Flight(["attitude", "body_rates"], 60.0)
    flight.fly_to(LOST_AT_S + 6.0)
    # 250 ms, and failsafe.hold_s.
    assert flight.when("failsafe -> standby") == pytest.approx(5.25, abs=0.1)
    # The bank of the turn stays: the aircraft does not roll on.
    assert np.max(np.abs(flight.between("roll_deg", 0.0, 5.0))) < 40.0


@pytest.mark.fault(
    "Degraded flight",
    "attitude and acceleration lost, replaced by the integrated gyroscope",
    "wings level, pitch, power",
    "30 s",
    "end",
)
@pytest.mark.parametrize(
    ("lost", "degraded_s", "sound_s"),
    [
        (["heading"], 10.0, 10.0),
        # The integrated gyroscope alone is sound for 30 s.
        (["attitude", "specific_force"], 600.0, 30.0),
    ],
)
def test_degraded_flight_ends_after_its_time(
    lost: list[str], degraded_s: float, sound_s: float
) -> None:
    config = f"[failsafe]\ndegraded_s = {degraded_s}\nhold_s = 2.0\n"
    flight = Flight(lost, 60.0, config=config)
    flight.fly_to(LOST_AT_S + sound_s + 4.0)
    assert flight.when("failsafe -> standby") == pytest.approx(sound_s + 2.25, abs=0.15)


def test_without_a_pilot_it_glides_in_a_gentle_turn() -> None:
    """A Cessna 172P glides best at 65 kt (its handbook, section 3)."""
    config = '[failsafe]\nend = "glide"\ndegraded_s = 5.0\nhold_s = 1.0\n'
    flight = Flight(["heading"], 60.0, aircraft="c172p", config=config)
    flight.fly_to(LOST_AT_S + 55.0)
    assert flight.when("gliding in a gentle turn") == pytest.approx(6.25, abs=0.15)
    assert flight.rig.holds_control
    settled = (40.0, 55.0)
    assert np.max(np.abs(flight.between("airspeed_kt", *settled) - 65.0)) < 5.0
    assert np.max(np.abs(flight.between("roll_deg", *settled) - 15.0)) < 2.0
    assert np.max(flight.between("throttle", *settled)) == 0.0


@pytest.mark.parametrize("also", ["specific_force", "altitude"])
@pytest.mark.parametrize("aircraft", ["c172p", "c172r"])
def test_a_glide_without_airspeed_is_no_dive(aircraft: str, also: str) -> None:
    """By a constant pitch: within 20 kt of 65, sinking less than twice as fast as there.

    The handbook of the 172P gives 1.5 nautical miles for 1,000 ft: 722 ft/min at 65 kt.
    """
    config = '[failsafe]\nend = "glide"\ndegraded_s = 5.0\nhold_s = 1.0\n'
    flight = Flight(["airspeed", also], 100.0, aircraft=aircraft, config=config)
    flight.fly_to(LOST_AT_S + 65.0)
    settled = (45.0, 65.0)
    assert np.max(np.abs(flight.between("airspeed_kt", *settled) - 65.0)) < 20.0
    altitude_ft = flight.between("altitude_ft", *settled)
    sinks_fpm = (altitude_ft[0] - altitude_ft[-1]) / (settled[1] - settled[0]) * 60.0
    assert 0.0 < sinks_fpm < 2.0 * 722.0
