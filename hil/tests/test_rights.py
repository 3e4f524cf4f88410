"""With whose rights a flight runs, and what the service's unit denies."""

from __future__ import annotations

import contextlib
import ctypes.util
import json
import os
import re
import signal
import stat
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from daemon_under_test import (
    DaemonUnderTest,
    assert_released,
    engage,
    wait_until,
    write_config,
)
from other_user import NOBODY, needs_two_users
from test_service_unit import allowed_calls

from fcc_hil.process import StandInProcess
from fcc_hil.standin import Settings

SUCCESS = 0
FAILURE = 1
USAGE = 2


def status(pid: int, key: str) -> list[str]:
    """Return the words of a line of proc(5)'s status."""
    found = re.search(rf"^{key}:\s*(.*)$", Path(f"/proc/{pid}/status").read_text(), re.MULTILINE)
    assert found is not None
    return found[1].split()


@needs_two_users
def test_started_as_root_it_flies_as_the_user(fccd: Path, scratch: Path) -> None:
    # Not in every container.
    raises = ["prlimit", "--rtprio=99", "--memlock=unlimited", "true"]
    may_raise_limits = subprocess.run(raises, capture_output=True, check=False).returncode == 0
    with StandInProcess(Settings(port=0)) as simulator:
        strict = str(may_raise_limits).lower()
        rights = f'[rights]\nuser = "nobody"\n[realtime]\nstrict = {strict}\n'
        config = write_config(scratch, simulator.port, others=rights)
        words: list[str | Path] = [fccd, "run", "--config", config, "--json"]
        with DaemonUnderTest(words, scratch) as daemon:
            daemon.wait_for("was started as root, continues as user nobody (rights.user)")
            engage(simulator, daemon)
            for pid in (daemon.pid, *daemon.children()):
                assert status(pid, "Uid") == [str(NOBODY)] * 4
                assert status(pid, "Gid") == [str(NOBODY)] * 4
                for capabilities in ("CapInh", "CapPrm", "CapEff", "CapAmb"):
                    assert int(status(pid, capabilities)[0], 16) == 0
            if may_raise_limits:
                policies = {os.sched_getscheduler(int(task)) for task in tasks(daemon.pid)}
                assert os.SCHED_FIFO in policies
            ending = daemon.end(signal.SIGTERM)
        assert_released(simulator)
    assert ending.exit_code == SUCCESS, ending.log
    (recording,) = (scratch / "recordings").glob("*.mcap")
    assert recording.stat().st_uid == NOBODY


@needs_two_users
@pytest.mark.parametrize("folder", ["mine", "link", "link/new"])
def test_root_creates_no_folder_where_the_user_could_have_put_a_link(
    fccd: Path, scratch: Path, folder: str
) -> None:
    """The user creates it itself; where it may not, nothing is created."""
    home, roots = scratch / "home", scratch / "roots"
    home.mkdir()
    (home / "mine").mkdir()
    roots.mkdir(mode=0o755)
    (home / "link").symlink_to(roots)
    for path in (home, home / "mine"):
        os.chown(path, NOBODY, NOBODY)
    recordings = home / folder / "recordings"
    with flown_as_nobody(fccd, scratch, recordings) as daemon:
        if folder == "mine":
            wait_until(lambda: list(recordings.glob("*.mcap")) != [], "it records")
            # Root creates it with mode 0750.
            assert stat.S_IMODE(recordings.stat().st_mode) == 0o755
        else:
            daemon.wait_for("Permission denied (os error 13). Choose a writable folder")
    assert list(roots.iterdir()) == []


@needs_two_users
def test_root_creates_the_folder_where_only_root_can(fccd: Path, scratch: Path) -> None:
    recordings = scratch / "new" / "recordings"
    with flown_as_nobody(fccd, scratch, recordings):
        wait_until(lambda: list(recordings.glob("*.mcap")) != [], "it records")
    assert recordings.parent.stat().st_uid == 0
    assert recordings.stat().st_uid == NOBODY
    assert stat.S_IMODE(recordings.stat().st_mode) == 0o750


@contextlib.contextmanager
def flown_as_nobody(fccd: Path, scratch: Path, recordings: Path) -> Iterator[DaemonUnderTest]:
    with StandInProcess(Settings(port=0)) as simulator:
        config = write_config(scratch, simulator.port, others='[rights]\nuser = "nobody"')
        words: list[str | Path] = [fccd, "run", "--config", config, "--recordings", recordings]
        with DaemonUnderTest([*words, "--json"], scratch) as daemon:
            daemon.wait_for("was started as root, continues as user nobody (rights.user)")
            yield daemon
            daemon.end(signal.SIGTERM)


def tasks(pid: int) -> list[str]:
    """Return the numbers of a process's threads."""
    return [task.name for task in Path(f"/proc/{pid}/task").iterdir()]


@needs_two_users
def test_a_user_who_does_not_exist_is_refused(fccd: Path, scratch: Path) -> None:
    config = write_config(scratch, 49_000, others='[rights]\nuser = "no-such-user"\n')
    ended = subprocess.run(
        [fccd, "run", "--config", config], capture_output=True, text=True, check=False
    )
    assert ended.returncode == USAGE
    assert 'rights.user is "no-such-user": there is no such user' in ended.stderr


# Applies a filter as systemd does, by libseccomp: EPERM for every call that is not named. Then
# it runs a program, or tries what the arguments name.
FILTER = """
import ctypes, errno, json, os, sys
calls = json.load(open(sys.argv[1]))
lib = ctypes.CDLL(sys.argv[2])
libc = ctypes.CDLL(None, use_errno=True)
lib.seccomp_init.restype = ctypes.c_void_p
context = ctypes.c_void_p(lib.seccomp_init(0x00050000 | errno.EPERM))
numbers = {}
for name in calls["allowed"]:
    number = lib.seccomp_syscall_resolve_name(name.encode())
    if number >= 0:
        assert lib.seccomp_rule_add(context, 0x7FFF0000, ctypes.c_int(number), 0) == 0, name
for name in calls["tried"]:
    numbers[name] = lib.seccomp_syscall_resolve_name(name.encode())
tried = {}
def attempt():
    # With arguments that change nothing where a call is permitted.
    for name, number in numbers.items():
        ctypes.set_errno(0)
        result = libc.syscall(ctypes.c_long(number), *[ctypes.c_long(-1)] * 5)
        tried.setdefault(name, []).append(errno.errorcode.get(ctypes.get_errno(), str(result)))
attempt()
assert lib.seccomp_load(context) == 0
attempt()
if sys.argv[3:]:
    os.execv(sys.argv[3], sys.argv[3:])
print(json.dumps(tried))
"""

FORBIDDEN = (
    "mount",
    "umount2",
    "pivot_root",
    "init_module",
    "finit_module",
    "delete_module",
    "bpf",
    "perf_event_open",
    "ptrace",
    "add_key",
    "keyctl",
    "chroot",
    "swapoff",
    "clock_settime",
    "kexec_file_load",
)
"""With invalid arguments; reboot(2), setuid(2) and the like would act, and are not tried.

Namespaces are denied by the unit's RestrictNamespaces.
"""


def test_the_units_filter_forbids_what_it_should_and_a_flight_needs_none_of_it(
    fccd: Path, tmp_path: Path
) -> None:
    library = ctypes.util.find_library("seccomp")
    if library is None:
        pytest.skip("there is no libseccomp, with which systemd applies the filter")
    allowed = allowed_calls()
    assert not {"reboot", "setuid", "setresuid", "setgid", "chown", "fchownat"} & allowed
    calls = tmp_path / "calls.json"
    # Python itself needs no more than a flight does.
    calls.write_text(json.dumps({"allowed": sorted(allowed), "tried": FORBIDDEN}))
    words: list[str | Path] = [sys.executable, "-I", "-c", FILTER, calls, library]
    done = subprocess.run(words, capture_output=True, text=True, check=True, cwd="/")
    for name, (before, after) in json.loads(done.stdout).items():
        assert after == "EPERM", name
        if os.geteuid() == 0:
            assert before != "0", name
    with StandInProcess(Settings(port=0)) as simulator:
        config = write_config(tmp_path, simulator.port)
        flies = [*words, fccd, "run", "--config", config, "--json"]
        with DaemonUnderTest(flies, tmp_path) as daemon:
            engage(simulator, daemon)
            assert status(daemon.pid, "Seccomp") == ["2"]
            ending = daemon.end(signal.SIGTERM)
        assert_released(simulator)
    assert ending.exit_code == SUCCESS, ending.log
