"""The battery of the stand-in: it falls without its alternator, as fast as it has capacity."""

from __future__ import annotations

from pathlib import Path

import pytest
from standin_bench import Bench

from fcc_hil import battery
from fcc_hil.electrical import Battery
from fcc_hil.flight import Flight
from fcc_hil.plant import Plant
from fcc_hil.sensor_faults import Faults

TWELVE_LEGS = Path(__file__).parents[2] / "config/plans/twelve-legs.waypoints"

CRUISE_RADPS = 240.0
VOLTAGE = "sim/cockpit2/electrical/battery_voltage_actual_volts[0]"
FAILURE = "sim/operation/failures/rel_genera0"


def test_it_is_empty_after_its_capacity() -> None:
    """12.75 Ah at 15 A are 51 minutes; of 24 V, and 28 V of the alternator."""
    battery = Battery()
    battery.step(60.0, CRUISE_RADPS)
    assert (battery.voltage_v, battery.charge) == (28.0, 1.0)
    battery.alternator_fails = True
    battery.step(30.6 * 50.0, CRUISE_RADPS)
    assert battery.charge == pytest.approx(0.5)
    assert 24.0 < battery.voltage_v < 26.0
    battery.step(30.6 * 50.0 + 1.0, CRUISE_RADPS)
    assert (battery.voltage_v, battery.charge) == (0.0, 0.0)
    battery.alternator_fails = False
    battery.step(1_800.0, CRUISE_RADPS)
    assert battery.charge == pytest.approx(0.5)


def test_the_engine_drives_the_alternator() -> None:
    plant = Plant("c172p")
    plant.step(120)
    assert plant.state().battery_voltage_v == 28.0
    plant.battery.step(1.0, 0.0)
    assert 24.0 < plant.battery.voltage_v < 26.0


def test_a_client_reads_the_voltage_and_a_failed_generator_lowers_it() -> None:
    bench = Bench()
    try:
        bench.client.subscribe(1, VOLTAGE)
        assert bench.frames(5)[1] == 28.0
        bench.client.write(FAILURE, 6.0)
        first = bench.frames(5)[1]
        assert 24.0 < first < 26.0
        bench.simulator.plant.battery.capacity_ah = 0.1
        assert bench.frames(300)[1] < first - 0.2
        bench.client.write(FAILURE, 0.0)
        assert bench.frames(5)[1] == 28.0
    finally:
        bench.close()


@pytest.mark.autopilot(
    mode="plan",
    plan=TWELVE_LEGS,
    config="[contingency]\nbattery_voltage_v = 24.5\nbattery_low_after_s = 2\n",
)
def test_a_voltage_that_drifts_is_acted_on(flight: Flight, faults: Faults) -> None:
    """From 28 V by 0.5 V in a second: low after 7 s, and for 2 s then."""
    flight.engages(by=3)
    fault = faults.drift(battery, per_s=-0.5)
    flight.flies(12)
    (told,) = [event for event in flight.rig.events if "the battery is low" in event.text]
    assert told.text == "the battery is low: returning"
    assert told.time_s - fault.begins_s == pytest.approx(9.0, abs=0.1)
