"""Live telemetry among programs that damage its shared memory: the flight is not affected."""

from __future__ import annotations

import contextlib
import json
import mmap
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import fcc
import numpy as np
import pytest
from daemon_under_test import DaemonUnderTest, wait_until
from other_user import NOBODY, as_user, needs_two_users

SUCCESS = 0
PATIENCE_S = 15.0
ATTACKS = int(os.environ.get("FCCD_ATTACKS", "5"))
"""How often shared memory is damaged; 100 take two minutes: `make test-attacks`."""

_ON_A_QUIET_MACHINE = 100

ENDED = "the process that publishes live telemetry"


@pytest.fixture(autouse=True)
def apart(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Keep what is damaged here from the ground stations of other tests: they watch all daemons."""
    with tempfile.TemporaryDirectory(prefix="fccd-test-", dir="/dev/shm") as folder:
        monkeypatch.setenv("XDG_RUNTIME_DIR", folder)
        yield


@pytest.fixture
def instance(request: pytest.FixtureRequest) -> str:
    """Return a name that no other daemon has."""
    return f"s{os.getpid()}-{abs(hash(request.node.name)) % 10**6}"


def fly(
    fccd: Path,
    scratch: Path,
    instance: str,
    *before: str,
    environment: dict[str, str] | None = None,
) -> DaemonUnderTest:
    path = scratch / "fccd.toml"
    path.write_text(
        '[built-in]\nengage_at_s = 1.5\n[guidance]\nmode = "hold"\n'
        f'[recording]\nfolder = "{scratch}/recordings"\n'
    )
    words: list[str | Path] = [*before, fccd, "fly", "--config", path, "--instance", instance]
    return DaemonUnderTest([*words, "--json", "--seconds", "600"], scratch, environment)


def place_of(instance: str) -> Path:
    """Return the folder of an instance, as the page on telemetry says where it is."""
    user = os.geteuid()
    session = os.environ.get("XDG_RUNTIME_DIR", f"/run/user/{user}")
    folders = [f"{session}/fccd", "/run/fccd", f"/dev/shm/fccd-run-{user}"]
    found = [Path(folder) / f"live-{instance}" for folder in folders]
    return next(place for place in found if (place / "current").exists())


def newest(fccd: Path, instance: str) -> int | None:
    """Return the tick of the newest record that a new watcher gets."""
    done = subprocess.run(
        [fccd, "top", "--instance", instance, "--json"],
        capture_output=True,
        text=True,
        check=False,
        timeout=PATIENCE_S,
    )
    if done.returncode != SUCCESS:
        return None
    return int(json.loads(done.stdout)["tick"]["number"])


def files_of(instance: str) -> list[Path]:
    return [path for path in place_of(instance).rglob("*") if path.is_file()]


def cut_off(instance: str, _: random.Random) -> None:
    for path in files_of(instance):
        with contextlib.suppress(OSError):
            os.truncate(path, 0)


def overwrite(instance: str, dice: random.Random) -> None:
    for path in files_of(instance):
        with contextlib.suppress(OSError):
            path.chmod(0o600)
            with path.open("r+b") as file:
                file.write(dice.randbytes(path.stat().st_size))


def overwrite_through_mappings(instance: str, dice: random.Random) -> None:
    """As a watcher could: neither sizes nor the set of files change."""
    for path in files_of(instance):
        with contextlib.suppress(OSError, ValueError), path.open("r+b") as file:
            if path.stat().st_mode & 0o222:
                with mmap.mmap(file.fileno(), 0) as memory:
                    memory[:] = dice.randbytes(len(memory))


def remove(instance: str, _: random.Random) -> None:
    for path in files_of(instance):
        with contextlib.suppress(OSError):
            path.unlink()


WAYS: list[Callable[[str, random.Random], None]] = [
    cut_off,
    overwrite,
    overwrite_through_mappings,
    remove,
]


def stolen_s() -> float:
    """Return for how long the host of a virtual machine ran something else: steal, proc(5)."""
    of_all = Path("/proc/stat").read_text().splitlines()[0].split()
    return int(of_all[8]) / os.sysconf("SC_CLK_TCK")


@pytest.mark.fault(
    "Around the flight",
    "live telemetry's files damaged by same user; its process killed or hung",
    "SIGBUS, sizes, modes; no sign of life",
    "0.02 to 0.5 s; hung: 1.5 s, 30 s before it publishes",
    "reported; process restarted",
)
def test_whoever_damages_shared_memory_the_flight_goes_on(
    fccd: Path, tmp_path: Path, instance: str
) -> None:
    """All of it is cut off, overwritten or removed: no tick is missed, and all is recorded."""
    dice = random.Random(12)
    took_s: list[float] = []
    stolen_before_s = stolen_s()
    with fly(fccd, tmp_path, instance) as daemon:
        daemon.wait_for("standby -> engaged")
        modes = {path.name: path.stat().st_mode & 0o777 for path in files_of(instance)}
        assert all(mode & 0o077 == 0 for mode in modes.values()), modes
        for number in range(ATTACKS):
            way = WAYS[number % len(WAYS)]
            before = newest(fccd, instance)
            assert before is not None
            way(instance, dice)
            began_s = time.monotonic()
            # One that is newer than the damage, by 0.2 s.
            while (tick := newest(fccd, instance)) is None or tick <= before + 8:
                assert time.monotonic() - began_s < PATIENCE_S, f"{number}, {way.__name__}"
            took_s.append(time.monotonic() - began_s)
            # At other moments of its work; and it lives long enough to count as healthy.
            time.sleep(dice.uniform(0.55, 0.7))
        assert fcc.Commander(instance).disengage() > 0
        ending = daemon.end(signal.SIGTERM)
    print(f"back after {sorted(took_s)[len(took_s) // 2]:.2f} s, at most {max(took_s):.2f} s")
    assert ending.exit_code == SUCCESS
    missed = ending.report["timing"]["missed"]
    host_took_s = stolen_s() - stolen_before_s
    print(f"{missed} ticks missed; the host took {host_took_s:.1f} s of the processors' time")
    # On a busy machine some are missed without any damage.
    if ATTACKS >= _ON_A_QUIET_MACHINE:
        assert missed == 0
        assert max(took_s) < 1.0
    assert ending.report["failsafes"] == 0
    assert ENDED in ending.log
    (recording,) = (tmp_path / "recordings").glob("*.mcap")
    records = fcc.Recording(recording).records
    # Every tick that the loop did not miss.
    assert records["tick"][0] == 1 + records["missed"][0]
    assert (np.diff(records["tick"]) == 1 + records["missed"][1:]).all()
    assert not any(path.name == f"live-{instance}" for path in Path("/dev/shm").rglob("live-*"))


def test_a_watcher_and_a_commander_go_on_with_the_next_publisher(
    fccd: Path, tmp_path: Path, instance: str
) -> None:
    """The one before it hangs, and is ended by the daemon."""
    with fly(fccd, tmp_path, instance) as daemon:
        daemon.wait_for("standby -> engaged")
        watcher, commander = fcc.Watcher(instance), fcc.Commander(instance)
        assert commander.set(heading_rad=1.0) > 0
        seen: list[str] = []

        def has_seen(text: str) -> bool:
            seen.extend(event.text for event in watcher.events())
            return any(text in event for event in seen)

        wait_until(lambda: has_seen("mode: hold"), "the first events")
        before = watcher.latest(timeout_s=PATIENCE_S)
        (publisher,) = daemon.helpers("publisher")
        os.kill(publisher, signal.SIGSTOP)
        assert f"{ENDED} was ended by signal 9" in daemon.wait_for(ENDED)
        wait_until(lambda: has_seen(ENDED), "the event after it")
        after = watcher.latest(timeout_s=PATIENCE_S)
        assert before is not None
        assert after is not None
        assert after["tick"] > before["tick"]
        status = watcher.status(PATIENCE_S)
        # It counts since the loop's start.
        assert status is not None
        assert status["ticks"] >= before["tick"]
        assert commander.set(heading_rad=2.0) > after["tick"]
        # None comes twice, and who joins now gets those from before.
        assert len(seen) == len(set(seen))
        assert "standby -> engaged" in [event.text for event in fcc.Watcher(instance).events()]
        daemon.end(signal.SIGTERM)
        wait_until(lambda: not watcher.is_alive, "its end")


FORKS = """
import os, sys, fcc
watcher, commander = fcc.Watcher(sys.argv[1]), fcc.Commander(sys.argv[1])
assert watcher.latest(10.0) is not None
child = os.fork()
if child == 0:
    for use in (watcher.latest, watcher.events, commander.engage):
        try:
            use()
        except fcc.TelemetryError as error:
            assert "fork" in str(error), error
        else:
            os._exit(2)
    assert not watcher.is_alive
    # As a child does that ends without an exec: all objects are dropped.
    del watcher, commander
    own = fcc.Watcher(sys.argv[1])
    os._exit(0 if own.latest(10.0) is not None else 3)
assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
watcher.latest(0.0)
first = watcher.latest(10.0)
second = watcher.latest(10.0)
assert first is not None and second is not None and second["tick"] > first["tick"]
assert commander.set(heading_rad=1.0) > first["tick"]
"""


def test_fork_leaves_the_watcher_of_the_parent_as_it_is(
    fccd: Path, tmp_path: Path, instance: str
) -> None:
    with fly(fccd, tmp_path, instance) as daemon:
        daemon.wait_for("standby -> engaged")
        done = subprocess.run(
            [sys.executable, "-c", FORKS, instance],
            timeout=60.0,
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stderr
        assert ENDED not in daemon.log
        assert daemon.end(signal.SIGTERM).exit_code == SUCCESS


WATCHES = """
import sys, time, fcc
watcher = fcc.Watcher(sys.argv[1])
print("watching", flush=True)
sys.stdin.readline()
for _ in range(60):
    watcher.records(); watcher.events(); time.sleep(0.01)
try:
    fcc.Watcher(sys.argv[1])
except fcc.TelemetryError as error:
    print(error, flush=True)
sys.stdin.readline()
while watcher.latest(1.0) is None:
    pass
print("continues", flush=True)
"""


@contextlib.contextmanager
def small_memory(folder: Path) -> Iterator[None]:
    """Mount 16 MB at a folder, accessible to this user alone."""
    folder.mkdir(mode=0o700)
    options = "size=16m,mode=0700"
    subprocess.run(["mount", "-t", "tmpfs", "-o", options, "tmpfs", folder], check=True)
    try:
        yield
    finally:
        subprocess.run(["umount", "--lazy", folder], check=True)


def _can_mount() -> bool:
    test = ["unshare", "--mount", "mount", "-t", "tmpfs", "tmpfs", "/mnt"]
    return (
        os.geteuid() == 0 and subprocess.run(test, capture_output=True, check=False).returncode == 0
    )


@pytest.mark.skipif(not _can_mount(), reason="mounting is not permitted here")
def test_a_full_shared_memory_ends_neither_watcher_nor_publisher(
    fccd: Path, tmp_path: Path, instance: str
) -> None:
    run = tmp_path / "run"
    environment = {"RUNTIME_DIRECTORY": str(run)}
    with small_memory(run), fly(fccd, tmp_path, instance, environment=environment) as daemon:
        daemon.wait_for("standby -> engaged")
        assert (run / f"live-{instance}" / "current").exists()
        with subprocess.Popen(
            [sys.executable, "-c", WATCHES, instance],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env={**os.environ, **environment},
        ) as watcher:
            assert watcher.stdin is not None
            assert watcher.stdout is not None
            assert watcher.stdout.readline() == "watching\n"
            filler = run / "filler"
            with contextlib.suppress(OSError), filler.open("wb", buffering=0) as file:
                while True:
                    file.write(bytes(4096))
            daemon.wait_for("live telemetry is paused")
            watcher.stdin.write("\n")
            watcher.stdin.flush()
            assert "KiB may be needed: delete files there" in watcher.stdout.readline()
            filler.unlink()
            daemon.wait_for("live telemetry continues")
            watcher.stdin.write("\n")
            watcher.stdin.flush()
            assert watcher.stdout.readline() == "continues\n"
            watcher.stdin.close()
            assert watcher.wait(PATIENCE_S) == 0
        assert ENDED not in daemon.log
        ending = daemon.end(signal.SIGTERM)
    assert ending.exit_code == SUCCESS


# What another user can take before: the names in folders for all.
TAKES = """
import os, sys
user, instance = sys.argv[1:]
for folder in (f"/dev/shm/fccd-{user}", f"/dev/shm/fccd-run-{user}", "/tmp/iceoryx2"):
    try:
        os.mkdir(folder, 0o777)
        os.chmod(folder, 0o777)
        os.makedirs(f"{folder}/live-{instance}/services")
    except FileExistsError:
        pass
for name in ("global_mgmt", "dynamic", "data"):
    open(f"/dev/shm/fccd-{user}_iox2.{name}", "w").write("x" * 4096)
"""


@needs_two_users
def test_another_user_who_comes_first_prevents_nothing(fccd: Path, instance: str) -> None:
    """It has made the folders and files that any version uses, for a user without a run folder."""
    uid = 65_533 - os.getpid() % 1_000

    bare = {"PATH": os.environ["PATH"]}
    with tempfile.TemporaryDirectory(dir="/var/tmp") as scratch:
        place = Path(scratch)
        program = place / "fccd"
        shutil.copy(fccd, program)
        os.chown(place, uid, uid)
        taken = [sys.executable, "-I", "-c", TAKES, str(uid), instance]
        subprocess.run([*as_user(NOBODY), *taken], check=True, cwd="/", env=bare)
        try:
            path = place / "fccd.toml"
            path.write_text('[built-in]\nengage_at_s = 1.5\n[guidance]\nmode = "hold"\n')
            words = [str(program), "fly", "--config", str(path), "--instance", instance, "--json"]
            done = subprocess.run(
                [*as_user(uid), *words, "--seconds", "0.5"],
                cwd=place,
                env=bare,
                capture_output=True,
                text=True,
                timeout=60.0,
                check=False,
            )
        finally:
            for left in [f"fccd-run-{uid}", f"fccd-{uid}"]:
                shutil.rmtree(f"/dev/shm/{left}", ignore_errors=True)
            for file in Path("/dev/shm").glob(f"fccd-{uid}_iox2.*"):
                file.unlink()
    assert done.returncode == SUCCESS, done.stderr
    refused = f"/dev/shm/fccd-run-{uid} is not used: it belongs to user {NOBODY}"
    assert refused in done.stderr
    report = json.loads(done.stdout)
    assert report["failsafes"] == 0
    assert any("standby -> engaged" in event["text"] for event in report["events"])
