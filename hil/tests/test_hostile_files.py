"""Files that another user or a careless one gives to the daemon."""

from __future__ import annotations

import json
import os
import shutil
import signal
import stat
import subprocess
import tempfile
from pathlib import Path

import pytest
from daemon_under_test import DaemonUnderTest, engage, wait_until, write_config
from other_user import NOBODY, as_user, needs_two_users

from fcc_hil.process import StandInProcess
from fcc_hil.standin import Settings

ROOT = Path(__file__).parents[2]
SUCCESS = 0
USAGE = 2
OLD = "2020-01-01T00-00-00.000Z-built-in-01.mcap"


@needs_two_users
def test_what_another_user_places_is_neither_followed_nor_deleted(
    fccd: Path, tmp_path: Path
) -> None:
    victim = tmp_path / "victim"
    victim.write_bytes(b"x" * 2_000_000)
    folder = tmp_path / "shared"
    folder.mkdir()
    folder.chmod(0o777)
    link = folder / OLD
    link.symlink_to(victim)
    pipe = folder / OLD.replace("2020", "2021")
    os.mkfifo(pipe)
    for placed in (link, pipe):
        os.chown(placed, NOBODY, NOBODY, follow_symlinks=False)
    config = tmp_path / "c.toml"
    config.write_text(f"[built-in]\n[recording]\nfolder = '{folder}'\nkeep_total_mb = 1\n")
    words = ["fly", "--config", str(config), "--lockstep", "--seconds", "20", "--json"]
    ended = subprocess.run([fccd, *words], capture_output=True, text=True, timeout=30, check=False)
    assert ended.returncode == SUCCESS, ended.stderr
    assert json.loads(ended.stdout)["timing"]["ticks"] > 20 * 40
    assert "deleted" not in ended.stderr
    assert victim.stat().st_size == 2_000_000
    assert link.is_symlink()
    assert pipe.is_fifo()


@needs_two_users
def test_what_is_written_is_no_file_of_another_user(fccd: Path) -> None:
    """Who could change it afterwards."""
    # Others reach no folder of pytest.
    with tempfile.TemporaryDirectory() as name:
        shared = Path(name)
        shared.chmod(0o777)
        theirs = shared / "theirs.plan"
        theirs.write_text("")
        theirs.chmod(0o666)
        os.chown(theirs, NOBODY - 1, NOBODY - 1)
        program = shutil.copy(fccd, shared / "fccd")
        plan = shutil.copy(ROOT / "config/plans/circuit.waypoints", shared)
        words: list[str | Path] = [*as_user(NOBODY), program, "plan", "convert", plan, theirs]
        ended = subprocess.run(words, capture_output=True, text=True, timeout=30, check=False)
        assert ended.returncode != SUCCESS
        assert f"a file of another user ({NOBODY - 1})" in ended.stderr
        assert theirs.read_text() == ""


def test_without_a_umask_others_may_write_nothing(fccd: Path, tmp_path: Path) -> None:
    recordings = tmp_path / "new" / "recordings"
    with StandInProcess(Settings(port=0)) as simulator:
        config = write_config(tmp_path, simulator.port)
        words: list[str | Path] = ["sh", "-c", 'umask 0; exec "$@"', "sh", fccd, "run"]
        words += ["--config", config, "--recordings", recordings, "--json"]
        with DaemonUnderTest(words, tmp_path) as daemon:
            engage(simulator, daemon)
            wait_until(lambda: list(recordings.glob("*.flight")) != [], "the flight's state")
            modes = {
                path.suffix: stat.S_IMODE(path.stat().st_mode)
                for path in recordings.iterdir()
                # Renamed at once.
                if path.suffix != ".new"
            }
            assert daemon.end(signal.SIGTERM).exit_code == SUCCESS
    # The last is that of `.order`.
    assert modes == {".flight": 0o600, ".lock": 0o600, ".mcap": 0o644, "": 0o644}
    for folder in (recordings, recordings.parent):
        assert stat.S_IMODE(folder.stat().st_mode) == 0o755


@pytest.mark.parametrize(
    "text",
    [
        "[built-in]\n" + "".join(f"k{n} = 1\n" for n in range(10_000)),
        "=\n" * 100_000,
        "[x-plane]\n" + '[[sensor]]\nkind = "x-plane"\nlocal_port = 5\n' * 10_000,
        "a = " + "[" * 400_000,
        '"' + "k" * 900_000 + '" = 1\n',
    ],
    ids=["keys", "syntax", "sensors", "depth", "length"],
)
def test_a_configuration_of_errors_is_refused(fccd: Path, tmp_path: Path, text: str) -> None:
    """Each took from 4 s to more than a minute, or printed a megabyte."""
    config = tmp_path / "c.toml"
    config.write_text(text)
    ended = subprocess.run(
        [fccd, "check", config], capture_output=True, text=True, timeout=20, check=False
    )
    assert ended.returncode == USAGE
    assert len(ended.stderr) < 200_000
    assert ended.stderr.startswith(f"{config}:")
