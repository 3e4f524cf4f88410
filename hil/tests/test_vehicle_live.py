"""The built-in multicopter in real time: watched and commanded by the programs of the aeroplane."""

from __future__ import annotations

import json
import os
import subprocess
from pathlib import Path
from typing import Any

import fcc
import pytest
from daemon_under_test import DaemonUnderTest

SUCCESS = 0


def test_a_multicopter_is_watched_and_commanded(fccd: Path, tmp_path: Path) -> None:
    instance = f"multicopter-{os.getpid()}"
    path = tmp_path / "multicopter.toml"
    path.write_text(
        'vehicle = "multicopter"\n[built-in]\nwind_mps = 0.0\ngusts = "none"\n'
        '[[plan]]\nkind = "take-off"\nheight_m = 4.0\n'
        '[[plan]]\nkind = "hover"\nseconds = 3000.0\n[[plan]]\nkind = "land"\n'
        f'[recording]\nfolder = "{tmp_path}/recordings"\n'
    )

    def top() -> Any:
        shown = subprocess.check_output([fccd, "top", "--json", "--instance", instance])
        return json.loads(shown)

    words: list[str | Path] = [fccd, "fly", "--config", path, "--instance", instance, "--json"]
    with DaemonUnderTest(words, tmp_path) as daemon:
        daemon.wait_for("mode: hover, was take-off")
        shown = top()
        assert shown["plant"] == "multicopter"
        assert shown["rate_hz"] == 400.0
        assert shown["tick"]["state"] == "engaged"
        watcher = fcc.Watcher(instance)
        latest = watcher.latest(5.0)
        assert latest is not None
        assert latest["estimated_height_m"] == pytest.approx(4.0, abs=0.6)
        commander = fcc.Commander(instance)
        # By the names of its own set points, and not by those of an aeroplane.
        assert commander.set(go_to_north_m=5.0, go_to_east_m=-3.0, go_to_height_m=6.0) > 0
        with pytest.raises(fcc.CommandError, match="go_to_height_m"):
            commander.set(go_to_north_m=5.0)
        with pytest.raises(fcc.CommandError, match="airspeed"):
            commander.set(airspeed_mps=30.0)
        daemon.wait_for("mode: hover, was go-to")
        latest = watcher.latest(5.0)
        assert latest is not None
        place = [latest[f"estimated_{name}_m"] for name in ("north", "east", "height")]
        assert place == pytest.approx([5.0, -3.0, 6.0], abs=0.6)
        by_command: list[str | Path] = [fccd, "command", "--instance", instance, "plan", "land"]
        assert subprocess.run(by_command, check=False).returncode == SUCCESS
        ending = daemon.end(within_s=60.0)
    assert ending.exit_code == SUCCESS
    assert ending.report["ending"] == "it has landed"
