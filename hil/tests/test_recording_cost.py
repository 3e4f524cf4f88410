"""What a recording costs: processor time of its thread, and bytes of a tick."""

from __future__ import annotations

import os
import signal
import subprocess
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from daemon_under_test import start

SECONDS = float(os.environ.get("FCC_RECORDING_SECONDS", "0"))
"""In real time, in `make bench`: a busy machine's processor time means little."""
TICKS = 24_000
Measured = Callable[[str, object], None]
each = pytest.mark.parametrize(
    ("compression", "rate_hz"),
    [(name, rate_hz) for name in ("none", "lz4", "zstd") for rate_hz in (40, 1000)],
)


def _config(folder: Path, compression: str, rate_hz: int) -> Path:
    config = folder / "fccd.toml"
    config.write_text(
        f"[built-in]\n[loop]\nrate_hz = {rate_hz}\n[recording]\n"
        f'folder = "{folder}/recordings"\ncompression = "{compression}"\n'
    )
    return config


@each
def test_a_tick_takes_less_than_1500_bytes(
    compression: str, rate_hz: int, fccd: Path, tmp_path: Path, measured: Measured
) -> None:
    words: list[str | Path] = [fccd, "fly", "--lockstep", "--quiet", "--config"]
    words += [_config(tmp_path, compression, rate_hz), "--seconds", f"{TICKS / rate_hz:g}"]
    subprocess.run(words, check=True, capture_output=True)
    (file,) = (tmp_path / "recordings").glob("*.mcap")
    of_tick = file.stat().st_size / TICKS
    measured(f"{compression}, {rate_hz} Hz", f"{of_tick:.0f}")
    assert of_tick < 1_500


def _cpu_s(pid: int) -> float:
    for task in Path(f"/proc/{pid}/task").iterdir():
        if (task / "comm").read_text().strip() == "fcc-recorder":
            return int((task / "schedstat").read_text().split()[0]) / 1e9
    raise ProcessLookupError("there is no recorder")


@pytest.mark.skipif(not SECONDS, reason="measured by make bench")
@each
def test_processor_time(
    compression: str, rate_hz: int, fccd: Path, tmp_path: Path, measured: Measured
) -> None:
    with start(fccd, tmp_path, _config(tmp_path, compression, rate_hz)) as daemon:
        daemon.wait_for("standby -> engaged")
        before_s, began_s = _cpu_s(daemon.pid), time.monotonic()
        time.sleep(SECONDS)
        share = (_cpu_s(daemon.pid) - before_s) / (time.monotonic() - began_s)
        daemon.end(signal.SIGTERM)
    measured(f"{compression}, {rate_hz} Hz, %", f"{100.0 * share:.2f}")
