"""Other plants than an aircraft, under the same loop: a pendulum in Python, a room in Rust."""

from __future__ import annotations

import contextlib
import json
import math
import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import fcc
import numpy as np
import pendulum
import pytest
from daemon_under_test import wait_until
from recordings import EVENT, RECORD, assert_all_recorded, by_index, metadata, only_recording

PERIOD_S = 0.01
GRAVITY_PER_LENGTH_PER_S2 = 9.81 / 0.5
INERTIA_KGM2 = 0.05
TICKS = 800
FAILURE = 1
USAGE = 2


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

    again = pendulum.replay(file)
    assert again["ticks"] == TICKS + 1
    assert again["identical"] is True
    assert again["unflown"] is None

    # By the columns in the file, with and without an aircraft in the module.
    for module in (pendulum, fcc):
        recording = module.Recording(file)
        assert recording.records.dtype == rows.dtype
        assert recording.records.tobytes() == rows.tobytes()
        assert [event.text for event in recording.events] == [
            seen.content.text for seen in by_index(file) if seen.topic == EVENT
        ]
        assert recording.columns["commanded_torque_nm"]["range"] == (-2.0, 2.0)
        assert recording.columns["rate_radps"]["unit"] == "rad/s"
        assert recording.columns["state"]["codes"][1] == "engaged"
        assert recording.to_pandas()["angle_rad"].iloc[-1] == rows["angle_rad"][-1]
    assert not hasattr(pendulum.Recording, "config")


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


@dataclass(frozen=True)
class Heated:
    """A run of the thermostat."""

    file: Path
    live: list[list[Any]]
    """Rows that modules of Python saw meanwhile."""
    top: subprocess.CompletedProcess[str]
    """`fccd top`, meanwhile."""


WATCHES = """
import json, sys, pendulum
row = pendulum.Watcher(sys.argv[1]).latest(5.0)
pendulum.Commander(sys.argv[1]).set(room_c=20.0)
print(json.dumps(row.tolist()))
"""
"""In a process of its own: only one module of a process can use the shared memory."""


@pytest.fixture(scope="module")
def heated(fccd: Path, tmp_path_factory: pytest.TempPathFactory) -> Heated:
    """Heat a room for eight seconds, recorded, watched and commanded."""
    folder = tmp_path_factory.mktemp("runs")
    instance = f"room{os.getpid()}"

    def run(*words: str | Path) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [*words, instance], capture_output=True, text=True, check=False, timeout=60.0
        )

    words: list[str | Path] = [fccd.with_name("thermostat"), "--instance", instance]
    words += ["--live", "--record", folder]
    with subprocess.Popen(words, stdout=subprocess.DEVNULL) as heating:
        watchers: list[fcc.Watcher] = []

        def is_watched() -> bool:
            with contextlib.suppress(fcc.TelemetryError):
                watchers.append(fcc.Watcher(instance))
            return bool(watchers)

        wait_until(is_watched, "the room is watched")
        watcher, commander = watchers[0], fcc.Commander(instance)

        def newest() -> np.void:
            row = watcher.latest(5.0)
            assert row is not None
            return row

        assert watcher.info["plant"] == "room"
        assert watcher.columns["room_c"]["unit"] == "°C"
        assert watcher.columns["commanded_power"]["meaning"].startswith("Power of the heater")
        assert 2.0 < newest()["room_c"] < 21.0
        assert "standby -> engaged" in [event.text for event in watcher.events()]
        tick = commander.set(room_c=20.5)
        while newest()["tick"] < tick:
            pass
        row = newest()
        assert row["desired_room_c"] == 20.5
        with pytest.raises(fcc.CommandError, match="room is 40 °C: choose 5 to 30 °C"):
            commander.set(room_c=40.0)
        with pytest.raises(fcc.CommandError, match="no set point 'heading_rad': choose of room_c"):
            commander.set(heading_rad=1.0)
        other = run(sys.executable, "-c", WATCHES)
        assert other.returncode == 0, other.stderr
        top = run(fccd, "top", "--json", "--instance")
        assert heating.wait(60.0) == 0
    return Heated(only_recording(folder), [list(row.tolist()), json.loads(other.stdout)], top)


def test_a_thermostats_recording_is_read_by_another_program(heated: Heated) -> None:
    """The values are those of the room's differential equation."""
    file = heated.file
    records = [seen.content for seen in by_index(file) if seen.topic == RECORD]
    assert_all_recorded(records)
    assert len(records) + sum(record.tick.missed for record in records) >= 8 * 40
    room_c, power = 12.0, 0.0
    for record in records:
        # 2 °C outside, 2 kW, 0.02 K/W, a time constant of 7,200 s; 2,000 times faster.
        steady_c = 2.0 + 0.02 * 2_000.0 * power
        room_c = steady_c + (room_c - steady_c) * math.exp(-record.tick.dt_s * 2_000.0 / 7_200.0)
        assert record.measurements.room_c.value == pytest.approx(room_c, abs=1e-9)
        room_c, power = record.measurements.room_c.value, record.outputs.power
    assert room_c == pytest.approx(20.0, abs=0.05)

    # The same numbers by the columns in the file.
    rows = fcc.Recording(file).records
    assert rows["room_c"].tolist() == [record.measurements.room_c.value for record in records]
    assert rows["commanded_power"].tolist() == [record.outputs.power for record in records]


def test_a_thermostat_is_watched_by_modules_without_its_types(heated: Heated) -> None:
    """What was seen live is what was recorded."""
    rows = pendulum.Recording(heated.file).records
    for seen in heated.live:
        (recorded,) = rows[rows["tick"] == seen[0]]
        assert list(recorded.tolist()) == seen
    assert heated.top.returncode == FAILURE
    assert "is a loop of another plant, room: watch it with" in heated.top.stderr


def test_fccd_names_another_plant(fccd: Path, heated: Heated, tmp_path: Path) -> None:
    loop = pendulum.Machine(PERIOD_S)
    loop.command(0.1)
    balance(loop, Plant(0.05), 10)
    (other,) = loop.record_to(tmp_path, aircraft="pendulum")

    def fccd_of(*words: str | Path) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [fccd, *words], capture_output=True, text=True, check=False, timeout=60.0
        )

    for file, plant in ((heated.file, "thermostat"), (other, "pendulum")):
        named = f"is a recording of another plant, {plant}, by {plant} 0.1.0: open it with that"
        for command in ("report", "replay"):
            refused = fccd_of(command, file)
            assert (refused.returncode, refused.stdout) == (USAGE, "")
            assert named in refused.stderr
        for refuse in (fcc.report, fcc.replay):
            with pytest.raises(fcc.RecordingError, match=named):
                refuse(file)
        assert fccd_of("recover", file).returncode == 0
        listed = fccd_of("list", file.parent)
        assert (listed.returncode, listed.stderr) == (0, "")
        assert plant in listed.stdout
    with pytest.raises(pendulum.RecordingError, match="of another plant, thermostat, by"):
        pendulum.replay(heated.file)
