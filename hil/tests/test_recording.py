"""Flights and their recordings: whole, killed, and on disks that fail."""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import random
import resource
import signal
import subprocess
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from daemon_under_test import DaemonUnderTest, wait_until
from recordings import (
    EVENT,
    RECORD,
    assert_all_recorded,
    attachments,
    by_index,
    in_sequence,
    is_in_log_time_order,
    metadata,
    only_recording,
    ticks,
)

MAX_LOST_S = 1.0
KILLS = 10


Words = list[str | Path]
IN_LOCKSTEP: Words = ["--lockstep", "--json", "--quiet"]


RECORDING_LOST = 14


def run(words: Words, exit_code: int = 0, **options: Any) -> dict[str, Any]:
    """Run `fccd` to its end with this exit code; return its JSON."""
    done = subprocess.run(
        [str(word) for word in words], capture_output=True, text=True, check=False, **options
    )
    assert done.returncode == exit_code, done.stderr
    found = json.loads(done.stdout)
    assert isinstance(found, dict)
    return found


def write_config(scratch: Path, rate_hz: int, recording: str = "") -> Path:
    path = scratch / "fccd.toml"
    path.write_text(
        f"[built-in]\nengage_at_s = 1.5\n[loop]\nrate_hz = {rate_hz}\n[recording]\n{recording}\n"
    )
    return path


def test_ten_minutes_are_recorded_tick_by_tick(fccd: Path, tmp_path: Path) -> None:
    config = write_config(tmp_path, 40)
    folder = tmp_path / "recordings"
    outcome = run(
        [fccd, "fly", *IN_LOCKSTEP, "--config", config, "--recordings", folder, "--seconds", "600"]
    )
    flown = outcome["timing"]["ticks"]
    assert flown >= 600 * 40
    assert outcome["recording"]["not_recorded"] == 0

    path = only_recording(folder)
    messages = by_index(path)
    assert ticks(messages) == list(range(1, flown + 1))
    assert is_in_log_time_order(messages)
    assert [seen.data for seen in in_sequence(path)] == [seen.data for seen in messages]
    kinds = [seen.content.kind.WhichOneof("kind") for seen in messages if seen.topic == EVENT]
    engaged, ended = ["state_changed", "mode_changed"], ["state_changed", "released"]
    assert kinds == [*engaged, "stop_requested", *ended, "mode_changed"]
    # A record is a flight's: where the aircraft was told to be, it is.
    last = [seen.content for seen in messages if seen.topic == RECORD][-2]
    flies_at_mps = last.measurements.airspeed_mps.value
    assert abs(flies_at_mps - last.setpoints.airspeed_mps) < 5.0

    about = metadata(path)["fcc.recording"]
    given = config.read_bytes()
    assert attachments(path)["config-as-given.toml"] == given
    assert about["config_sha256"] == hashlib.sha256(given).hexdigest()
    assert about["host"] == os.uname().nodename
    assert os.uname().release in about["kernel"]
    assert metadata(path)["fcc.parameters"]["loop.rate_hz"] == "40.0"

    (listed,) = json.loads(
        subprocess.run([fccd, "list", folder, "--json"], capture_output=True, check=True).stdout
    )
    assert (listed["ticks"], listed["state"], listed["file"]) == (flown, "stopped", "whole")


def kill_in_flight(daemon: DaemonUnderTest) -> int:
    """Kill a daemon; return the last moment that it may have lived, on the loop's clock."""
    daemon.send(signal.SIGKILL)
    killed_ns = time.clock_gettime_ns(time.CLOCK_MONOTONIC)
    wait_until(lambda: not daemon.is_running, "a killed daemon is gone")
    return killed_ns


@pytest.mark.fault(
    "Around the flight",
    "recording deleted, renamed, truncated",
    "place, length",
    "next write, 0.7 s",
    "reported; next part; exit 14",
)
def test_a_recording_deleted_in_flight_is_reported_and_continued(
    fccd: Path, tmp_path: Path
) -> None:
    folder = tmp_path / "recordings"
    words = [fccd, "fly", "--json", "--config", write_config(tmp_path, 40), "--seconds", "3"]
    with subprocess.Popen(
        [*map(str, words), "--recordings", folder],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as flight:
        wait_until(
            lambda: any(path.stat().st_size for path in folder.glob("*.mcap")), "it is recorded"
        )
        time.sleep(MAX_LOST_S)
        only_recording(folder).unlink()
        out, said = flight.communicate()
    assert flight.returncode == RECORDING_LOST
    assert "was deleted or renamed in flight" in said
    recording = json.loads(out)["recording"]
    assert recording["files"] == [str(only_recording(folder))]
    kept = ticks(in_sequence(only_recording(folder)))
    assert len(kept) == recording["ticks"]
    # The messages that are lost are the ticks before, and events.
    assert recording["not_recorded"] >= kept[0] - 1 > 0


def test_a_killed_flight_loses_a_second_at_most(fccd: Path, tmp_path: Path) -> None:
    chance = random.Random(20_261_120)
    config = write_config(tmp_path, 40)
    flights: list[tuple[float, Path, DaemonUnderTest]] = []
    with contextlib.ExitStack() as stack:
        for number in range(KILLS):
            folder = tmp_path / str(number)
            folder.mkdir()
            words: Words = [fccd, "fly", "--config", config, "--recordings", folder, "--quiet"]
            daemon = stack.enter_context(DaemonUnderTest(words, folder))
            daemon.wait_for("recording to")
            flights.append((chance.uniform(1.5, 5.0), folder, daemon))
        began_s = time.monotonic()
        killed = []
        for after_s, folder, daemon in sorted(flights, key=lambda flight: flight[0]):
            time.sleep(max(0.0, began_s + after_s - time.monotonic()))
            killed.append((folder, kill_in_flight(daemon)))

    for folder, killed_ns in killed:
        path = only_recording(folder)
        before = in_sequence(path)
        flown = [seen.content for seen in before if seen.topic == RECORD]
        assert_all_recorded(flown)
        lost_s = (killed_ns - flown[-1].tick.woke_ns) * 1e-9
        assert lost_s <= MAX_LOST_S

        recovered = run([fccd, "recover", path, "--json"])
        assert recovered["ticks"] == len(flown)
        assert not recovered["was_whole"]
        after = by_index(path)
        assert [seen.data for seen in after] == [seen.data for seen in before]
        assert run([fccd, "recover", path, "--json"])["was_whole"]


Limit = Callable[[], None]


@contextlib.contextmanager
def a_small_disk(folder: Path) -> Iterator[tuple[Path, Limit | None]]:
    """Give a file system of 2 MB, if we may mount one."""
    disk = folder / "disk"
    disk.mkdir()
    mounted = subprocess.run(
        ["mount", "-t", "tmpfs", "-o", "size=2m", "none", disk], capture_output=True, check=False
    )
    if mounted.returncode != 0:
        pytest.skip("only root may mount a small disk")
    try:
        yield disk, None
    finally:
        subprocess.run(["umount", disk], check=True)


@contextlib.contextmanager
def a_small_limit(folder: Path) -> Iterator[tuple[Path, Limit | None]]:
    """Give a folder in which no file may grow beyond 2 MB."""
    limit = 2_000_000
    yield folder, lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))


@pytest.mark.parametrize("small", [a_small_disk, a_small_limit])
def test_a_full_disk_ends_the_recording_and_not_the_flight(
    fccd: Path,
    tmp_path: Path,
    small: Callable[[Path], contextlib.AbstractContextManager[tuple[Path, Limit | None]]],
) -> None:
    # A minute and a half of flight, the disk is full after less than a half.
    config = write_config(tmp_path, 40, 'compression = "none"')
    with small(tmp_path) as (folder, limit):
        words: Words = [fccd, "fly", *IN_LOCKSTEP, "--config", config, "--recordings", folder]
        outcome = run([*words, "--seconds", "100"], RECORDING_LOST, preexec_fn=limit)
        flown = outcome["timing"]["ticks"]
        assert flown >= 100 * 40
        recording = outcome["recording"]
        assert "recording stopped" in " ".join(event["text"] for event in outcome["events"])
        assert "all earlier ones are recorded" in recording["stopped"]
        assert 0 < recording["ticks"] < flown
        path = only_recording(folder)
        numbers = ticks(in_sequence(path))
        assert numbers == list(range(1, recording["ticks"] + 1))


def test_a_read_only_folder_is_reported_and_the_flight_continues(
    fccd: Path, tmp_path: Path
) -> None:
    with a_small_disk(tmp_path) as (disk, _):
        subprocess.run(["mount", "-o", "remount,ro", disk], check=True)
        words: Words = [fccd, "fly", *IN_LOCKSTEP, "--recordings", disk, "--seconds", "10"]
        outcome = run(words, RECORDING_LOST)
    assert "Read-only file system" in outcome["recording"]["stopped"]
    assert outcome["timing"]["ticks"] >= 400


def test_recording_can_be_disabled(fccd: Path, tmp_path: Path) -> None:
    words: Words = [fccd, "fly", *IN_LOCKSTEP, "--seconds", "1"]
    assert run([*words, "--no-recording"], cwd=tmp_path)["recording"] is None
    assert list(tmp_path.iterdir()) == []
    run(words, cwd=tmp_path)
    assert only_recording(tmp_path / "recordings")
