"""How much memory a flight takes, with its recording and live telemetry."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable
from pathlib import Path

from daemon_under_test import start

MOST_RESIDENT_KB = 23 << 10
"""What `docs/timing.md` says."""
PROGRAM_KB = 15_872
"""Of this the program as it ships, 15.5 MB. The rest is data, in whichever build."""
IS_RELEASED = "FCC_RELEASED" in os.environ


def test_a_flight_takes_less_than_23_mb_and_no_page_fault(
    fccd: Path, tmp_path: Path, measured: Callable[[str, object], None]
) -> None:
    """Of all with `make test-release`; of the data with any build, whose program may be larger."""
    config = tmp_path / "fccd.toml"
    config.write_text(f'[built-in]\n[recording]\nfolder = "{tmp_path}/recordings"\n')
    with start(fccd, tmp_path, config) as daemon:
        daemon.wait_for("standby -> engaged")
        for _ in range(3):
            daemon.next_state()
        lines = Path(f"/proc/{daemon.pid}/status").read_text().splitlines()
        status = dict(line.split(":", 1) for line in lines)
        resident_kb, program_kb = (
            int(status[name].removesuffix("kB")) for name in ("VmRSS", "RssFile")
        )
        ending = daemon.end(signal.SIGTERM)
    measured("resident, MB", f"{resident_kb / 1024:.1f}")
    measured("of this the program's file, MB", f"{program_kb / 1024:.1f}")
    assert resident_kb - program_kb < MOST_RESIDENT_KB - PROGRAM_KB
    if IS_RELEASED:
        assert resident_kb < MOST_RESIDENT_KB
    timing = ending.report["timing"]
    # Without locked memory a page is loaded when it is first needed.
    if timing["realtime"]["memory_locked"]:
        assert timing["page_faults"] == 0
