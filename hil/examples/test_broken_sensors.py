"""Sensors that fail, are biased or lose samples, in turbulence."""

import pytest

from fcc_hil import airspeed, altitude, bank, heading, pitch
from fcc_hil.flight import Flight
from fcc_hil.sensor_faults import Faults

pytestmark = [
    pytest.mark.aircraft("c172p", wind=(270, 10), turbulence=3, seed=7, noise=True),
    pytest.mark.autopilot(mode="hold"),
]


@pytest.mark.parametrize(
    "sensor", ["attitude", "heading", "body_rates", "specific_force", "airspeed", "altitude"]
)
def test_after_the_loss_of_any_sensor_the_wings_are_levelled_and_the_controls_released(
    flight: Flight, faults: Faults, sensor: str
) -> None:
    """NaN is rejected: the last valid value becomes too old."""
    flight.engages(by=3)
    flight.flies(5)
    gone = faults.nan(sensor)
    flight.falls_into_failsafe(by=0.5, after=gone)
    flight.releases(by=6, after=gone)
    flight.never(abs(bank) > 20)


def test_a_biased_altimeter_is_followed(flight: Flight, faults: Faults) -> None:
    """It reads 10 m too high, so the aircraft descends 10 m."""
    flight.engages(by=3)
    faults.bias(altitude("m"), by=10)
    wrong_m = flight.captured.altitude_ft * 0.3048 - 10
    flight.settles(altitude("m"), at=wrong_m, within=2, by=40)
    flight.never(pitch < -15)
    flight.never("failsafe")


@pytest.mark.parametrize("fault", ["loss", "duplicate", "reorder"])
def test_lost_duplicated_or_reordered_samples_have_no_effect(
    flight: Flight, faults: Faults, fault: str
) -> None:
    """A fifth of the samples of heading and airspeed is lost, duplicated or reordered."""
    flight.engages(by=3)
    getattr(faults, fault)(heading, share=0.2)
    getattr(faults, fault)(airspeed, share=0.2)
    flight.stays(heading, within=5, to=30)
    flight.never("failsafe")


def test_a_short_silence_of_the_simulator_has_no_effect(flight: Flight, faults: Faults) -> None:
    """It is waited for; a single sensor that is silent for half a second is a failsafe."""
    flight.engages(by=3)
    faults.loss("everything", after=1, lasts=0.5)
    flight.flies(3)
    flight.never("failsafe")
    single = faults.loss("body_rates", lasts=0.5)
    flight.falls_into_failsafe(by=0.4, after=single)
