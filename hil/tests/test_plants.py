"""Other plants than an aircraft, under the same loop: a pendulum in Python, a room in Rust."""

from __future__ import annotations

import math
import subprocess
from pathlib import Path
from typing import Any

import pendulum
import pytest
from recordings import RECORD, by_index, metadata, only_recording

PERIOD_S = 0.01
GRAVITY_PER_LENGTH_PER_S2 = 9.81 / 0.5
INERTIA_KGM2 = 0.05
TICKS = 800


class Plant:
    """A pendulum of 0.2 kg at 0.5 m, upright at 0."""

    def __init__(self, angle_rad: float) -> None:
        """Begin at rest."""
        self.angle_rad = angle_rad
        self.rate_radps = 0.0

    def step(self, torque_nm: float) -> None:
        """Integrate one period in 10 steps (semi-implicit Euler)."""
        dt_s = PERIOD_S / 10
        for _ in range(10):
            gravity = GRAVITY_PER_LENGTH_PER_S2 * math.sin(self.angle_rad)
            self.rate_radps += dt_s * (gravity + torque_nm / INERTIA_KGM2)
            self.angle_rad += dt_s * self.rate_radps

    def measured(self) -> Any:
        return pendulum.Measured(angle_rad=self.angle_rad, rate_radps=self.rate_radps)


def balance(loop: Any, plant: Plant, ticks: int) -> None:
    for _ in range(ticks):
        motor = loop.step(plant.measured())
        plant.step(motor.torque_nm if motor else 0.0)


def test_a_pendulum_in_python_is_balanced_recorded_and_replayed(tmp_path: Path) -> None:
    loop, plant = pendulum.Machine(PERIOD_S), Plant(0.05)
    assert loop.step() is None
    loop.engage()
    balance(loop, plant, TICKS // 2)
    assert loop.state == "engaged"
    assert plant.angle_rad == pytest.approx(0.0, abs=1e-3)
    loop.command(0.1)
    balance(loop, plant, TICKS // 2)
    assert plant.angle_rad == pytest.approx(0.1, abs=1e-3)
    # At rest the motor bears the pendulum.
    rows = loop.records()
    gravity_nm = INERTIA_KGM2 * GRAVITY_PER_LENGTH_PER_S2 * math.sin(0.1)
    assert rows["commanded_torque_nm"][-1] == pytest.approx(-gravity_nm, abs=0.01)
    assert [event.text for event in loop.events()][-2:] == [
        "standby -> engaged",
        "command: a command to the controller",
    ]

    (file,) = loop.record_to(tmp_path, aircraft="pendulum", ending="enough")
    messages = [seen.content for seen in by_index(file) if seen.topic == RECORD]
    assert [message.tick.number for message in messages] == list(range(1, TICKS + 2))
    for message, row in zip(messages[1:], rows[1:], strict=True):
        assert message.measurements.angle_rad.value == row["angle_rad"]
        assert message.measurements.rate_radps.value == row["rate_radps"]
        assert message.outputs.torque_nm == row["commanded_torque_nm"]
    assert metadata(file)["fcc.recording"]["plant"] == "pendulum"

    again = pendulum.Machine.replay(file)
    assert again["ticks"] == TICKS + 1
    assert again["identical"] is True
    assert again["unflown"] is None


def test_a_pendulum_that_is_not_measured_falls() -> None:
    loop, plant = pendulum.Machine(PERIOD_S), Plant(0.05)
    loop.step(plant.measured())
    loop.engage()
    balance(loop, plant, 100)
    assert loop.state == "engaged"
    for _ in range(6):
        loop.step(pendulum.Measured(rate_radps=0.0))
    assert loop.state == "failsafe"
    assert loop.faults == ["the angle is missing or too old"]


def test_a_thermostats_recording_is_read_by_another_program(fccd: Path, tmp_path: Path) -> None:
    """The values are those of the room's differential equation."""
    thermostat = fccd.with_name("thermostat")
    subprocess.run([thermostat, "--record", tmp_path], check=True, capture_output=True)
    file = only_recording(tmp_path)
    records = [seen.content for seen in by_index(file) if seen.topic == RECORD]
    numbers = [record.tick.number for record in records]
    assert numbers == list(range(1, len(numbers) + 1))
    assert len(numbers) + sum(record.tick.missed for record in records) >= 8 * 40
    room_c, power = 12.0, 0.0
    for record in records:
        # 2 °C outside, 2 kW, 0.02 K/W, a time constant of 7,200 s; 2,000 times faster.
        steady_c = 2.0 + 0.02 * 2_000.0 * power
        room_c = steady_c + (room_c - steady_c) * math.exp(-record.tick.dt_s * 2_000.0 / 7_200.0)
        assert record.measurements.room_c.value == pytest.approx(room_c, abs=1e-9)
        room_c, power = record.measurements.room_c.value, record.outputs.power
    assert room_c == pytest.approx(20.0, abs=0.05)
