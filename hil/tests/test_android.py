"""The app's classes and native library, in a Java process: they fly JSBSim as the daemon does.

Only in `make test-android`, which builds them and sets FCC_ANDROID to the program that has the
command line of `fccd run`.
"""

from __future__ import annotations

import json
import os
import subprocess
from pathlib import Path

import pytest
from daemon_under_test import write_config
from test_daemon_flights import free_port

from fcc_hil.daemon import command
from fcc_hil.fly import Plan, fly
from fcc_hil.pattern import TimedPattern
from fcc_hil.settings import Settings

PROGRAM = os.environ.get("FCC_ANDROID")
pytestmark = pytest.mark.skipif(PROGRAM is None, reason="make test-android builds it")


def test_the_pattern_is_flown_in_a_java_process_and_replayed_to_the_last_bit(
    fccd: Path, tmp_path: Path
) -> None:
    assert PROGRAM is not None
    port = free_port()
    pattern = TimedPattern(hold_s=5.0)
    config = write_config(
        tmp_path, port, guidance=f'mode = "timed-pattern"\nhold_s = {pattern.hold_s}'
    )
    recordings = tmp_path / "recordings"
    words = [*command(Path(PROGRAM), config), "--recordings", str(recordings)]
    flown = fly(Plan(words, Settings(port=port), legs=2, pattern=pattern), print)
    # The daemon's own limits; a busy machine makes the loop miss some ticks.
    assert [failure for failure in flown.failures if "missed" not in failure] == []
    assert flown.report is not None
    assert flown.report["released"]
    assert flown.report["recording"]["not_recorded"] == 0
    (recording,) = recordings.glob("*.mcap")
    replayed = subprocess.run(
        [fccd, "replay", "--json", recording], check=True, capture_output=True, text=True
    )
    result = json.loads(replayed.stdout)
    assert result["ticks"] == flown.report["timing"]["ticks"]
    assert result["identity"]["outputs"] > 0
    assert result["identity"]["differing"] == 0
