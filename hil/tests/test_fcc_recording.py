"""Recordings in numpy, against what PyPI's `mcap` reads of the same file."""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import fcc
import numpy as np
import pytest
from recordings import EVENT, RECORD, by_index, only_recording

SECONDS = 200
"""Long enough for several chunks, of which a cut file still has the first."""


@pytest.fixture(scope="module")
def recording(fccd: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the recording of a flight in lockstep."""
    folder = tmp_path_factory.mktemp("recordings")
    subprocess.run(
        [fccd, "fly", "--lockstep", "--quiet", "--seconds", str(SECONDS), "--recordings", folder],
        check=True,
        capture_output=True,
    )
    return only_recording(folder)


def test_every_number_agrees_with_another_reader(recording: Path) -> None:
    messages = by_index(recording)
    expected = [message.content for message in messages if message.topic == RECORD]
    found = fcc.Recording(recording)
    records = found.records
    assert records.dtype == fcc.RECORD
    assert len(found) == len(records) == len(expected) > SECONDS * 40
    columns: dict[str, Callable[[Any], Any]] = {
        "tick": lambda r: r.tick.number,
        "woke_ns": lambda r: r.tick.woke_ns,
        "total_time_ns": lambda r: r.stages.total_ns,
        "pitch_rad": lambda r: r.measurements.attitude.value.pitch_rad,
        "commanded_elevator": lambda r: r.outputs.elevator,
        "desired_altitude_m": lambda r: r.setpoints.altitude_m,
    }
    for column, of in columns.items():
        assert records[column].tolist() == [of(record) for record in expected], column
    texts = [message.content.text for message in messages if message.topic == EVENT]
    assert [event.text for event in found.events] == texts
    assert found.cut is None
    assert found.is_whole


def test_columns_are_views_of_one_memory(recording: Path) -> None:
    found = fcc.Recording(recording)
    assert found.records is found.records
    assert np.shares_memory(found.records["airspeed_mps"], found.records)
    assert found.records.itemsize == fcc.RECORD.itemsize


def test_the_metadata_of_the_flight(recording: Path) -> None:
    found = fcc.Recording(str(recording))
    assert found.about["rate_hz"] == 40.0
    assert found.about["sensors"] == ["built-in aircraft"]
    assert found.config["guidance.mode"] == "timed-pattern"
    account = found.account()
    assert account["ticks"] == len(found)
    assert account["state"] == "stopped"
    assert found.bytes == recording.stat().st_size
    listed = fcc.list_recordings(recording.parent)
    assert [entry["ticks"] for entry in listed] == [len(found)]


def test_a_table_of_pandas(recording: Path) -> None:
    frame = fcc.Recording(recording).to_pandas()
    assert len(frame) == len(fcc.Recording(recording))
    assert frame.index[-1] == pytest.approx((len(frame) - 1) * 0.025)
    # The built-in aircraft has no angle-of-attack vane switched off: what came is a number.
    assert frame["airspeed_mps"].between(40.0, 60.0).all()
    never = fcc.Recording(recording).records["velocity_taken_ns"] == np.iinfo(np.int64).min
    assert frame["north_mps"].isna().to_numpy().tolist() == never.tolist()


def test_a_replay_is_identical(recording: Path) -> None:
    again = fcc.replay(recording)
    assert again["identical"] is True
    assert again["ticks"] == len(fcc.Recording(recording))
    other = fcc.Config().replace({"autopilot.envelope.max_bank_deg": 20.0})
    deviating = fcc.replay([recording], other)
    assert deviating["identical"] is None
    assert deviating["deviation"]


def test_a_report(recording: Path, tmp_path: Path) -> None:
    page, tables = tmp_path / "report.html", tmp_path / "tables"
    report = fcc.report(recording, html=page, csv=tables)
    assert report["failsafes"] == 0
    assert page.read_text().startswith("<!DOCTYPE html>")
    lines = (tables / "records.csv").read_text().splitlines()
    assert len(lines) == 1 + len(fcc.Recording(recording))
    # The columns of the table and of the array have one name.
    assert set(fcc.RECORD.names or ()) <= set(lines[0].split(","))


def test_an_unfinished_file_is_read_and_recovered(recording: Path, tmp_path: Path) -> None:
    cut = tmp_path / "cut.mcap"
    whole = recording.read_bytes()
    cut.write_bytes(whole[: len(whole) * 2 // 3])
    found = fcc.Recording(cut)
    assert not found.is_whole
    assert 0 < len(found) < len(fcc.Recording(recording))
    assert found.cut
    assert fcc.recover(cut)["was_whole"] is False
    assert fcc.Recording(cut).is_whole
    assert len(fcc.Recording(cut)) == len(found)


@pytest.mark.fault(
    "Around the flight",
    "bytes of recording changed",
    "chunk checksums",
    "on reading",
    "skipped, reported; exit 13, `replay` 8",
)
def test_a_damaged_byte_is_located_and_the_rest_is_read(recording: Path, tmp_path: Path) -> None:
    damaged = tmp_path / "damaged.mcap"
    content = bytearray(recording.read_bytes())
    middle = len(content) // 2
    content[middle] ^= 0x40
    damaged.write_bytes(content)
    found = fcc.Recording(damaged)
    (damage,) = found.damages
    assert damage["from_byte"] <= middle < damage["to_byte"]
    ticks = found.records["tick"]
    missing = np.arange(damage["first_tick"], damage["last_tick"] + 1)
    assert len(missing) == damage["ticks"] > 0
    assert not np.isin(missing, ticks).any()
    assert len(found) + len(missing) == len(fcc.Recording(recording))
    assert not fcc.Recording(recording).damages
