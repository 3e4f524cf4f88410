"""What a recording costs: processor time of its thread, and bytes of a tick."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from daemon_under_test import start

SECONDS = float(os.environ.get("FCC_RECORDING_SECONDS", "2"))
"""Longer in `make bench`, which measures it."""


def _cpu_s(pid: int) -> float:
    for task in Path(f"/proc/{pid}/task").iterdir():
        if (task / "comm").read_text().strip() == "fcc-recorder":
            return int((task / "schedstat").read_text().split()[0]) / 1e9
    raise ProcessLookupError("there is no recorder")


@pytest.mark.parametrize("rate_hz", [40, 1000])
@pytest.mark.parametrize("compression", ["none", "lz4", "zstd"])
def test_a_tick_takes_less_than_2_kb(
    compression: str,
    rate_hz: int,
    fccd: Path,
    tmp_path: Path,
    measured: Callable[[str, object], None],
) -> None:
    config = tmp_path / "fccd.toml"
    config.write_text(
        f"[built-in]\n[loop]\nrate_hz = {rate_hz}\n[recording]\n"
        f'folder = "{tmp_path}/recordings"\ncompression = "{compression}"\n'
    )
    with start(fccd, tmp_path, config) as daemon:
        daemon.wait_for("standby -> engaged")
        before_s, began_s = _cpu_s(daemon.pid), time.monotonic()
        time.sleep(SECONDS)
        share = (_cpu_s(daemon.pid) - before_s) / (time.monotonic() - began_s)
        ending = daemon.end(signal.SIGTERM)
    (file,) = (tmp_path / "recordings").glob("*.mcap")
    of_tick = file.stat().st_size / ending.report["timing"]["ticks"]
    measured(f"{compression}, {rate_hz} Hz: processor time, %", f"{100.0 * share:.2f}")
    measured(f"{compression}, {rate_hz} Hz: bytes of a tick", f"{of_tick:.0f}")
    assert of_tick < 2_000
