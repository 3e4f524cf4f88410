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
import tempfile
import time
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
from other_user import NOBODY, as_user, needs_two_users
from test_service_unit import allowed_calls

from fcc_hil.process import StandInProcess
from fcc_hil.standin import Settings

SUCCESS = 0
FAILURE = 1
USAGE = 2


@pytest.fixture
def scratch() -> Iterator[Path]:
    """Give a folder that other users can enter; those of pytest are closed to them."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        folder.chmod(0o755)
        yield folder


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


COMMANDS = """
import socket, sys
def connected():
    s = socket.socket(socket.AF_UNIX)
    s.settimeout(5)
    s.connect(sys.argv[1])
    return s
def said(text):
    s = connected()
    try:
        s.sendall(text)
    except BrokenPipeError:
        pass
    return s.recv(600).decode().strip()
silent = [connected() for _ in range(int(sys.argv[2]))]
for text in sys.argv[3:]:
    print(said(text.encode().decode("unicode_escape").encode("latin-1")))
"""
STRANGER = 54321


def commanding(user: int, socket: Path, *texts: str, silent: int = 0) -> list[str]:
    """Return what the daemon answers to a user's lines, beside silent connections."""
    words = [*as_user(user), sys.executable]
    done = subprocess.run(
        [*words, "-I", "-c", COMMANDS, socket, str(silent), *texts],
        capture_output=True,
        text=True,
        check=False,
        cwd="/",
    )
    return done.stdout.splitlines() or [done.stderr]


def one_of_them(user: int, script: str, socket: Path) -> str:
    """Return what a program of a user prints."""
    words = [*as_user(user), sys.executable]
    done = subprocess.run(
        [*words, "-I", "-c", script, socket], capture_output=True, text=True, check=True, cwd="/"
    )
    return done.stdout


# Opens as many connections as it may, at most `most`, and says how many.
CONNECTS = """
import socket, sys
kept = []
for _ in range(most):
    s = socket.socket(socket.AF_UNIX)
    s.setblocking(False)
    try:
        s.connect(sys.argv[1])
    except BlockingIOError:
        break
    kept.append(s)
print(len(kept), flush=True)
"""
# Reads what each of its connections is answered.
CROWD = f"""
most = 600
{CONNECTS}
for s in kept:
    s.settimeout(5)
    print(s.recv(600).decode().strip())
"""
# Fills the queue of a daemon that is stopped, until its input ends.
FILLS = f"""
import resource
most = resource.getrlimit(resource.RLIMIT_NOFILE)[1]
resource.setrlimit(resource.RLIMIT_NOFILE, (most, most))
{CONNECTS}
sys.stdin.read()
"""
HOLDS_PLACES = """
import socket, sys
kept = []
for _ in range(3):
    s = socket.socket(socket.AF_UNIX)
    s.settimeout(5)
    s.connect(sys.argv[1])
    kept.append(s)
print(kept[2].recv(600).decode().strip())
print(kept[0].recv(600).decode().strip())
"""
GIVES_UP = """
import socket, sys
s = socket.socket(socket.AF_UNIX)
s.settimeout(5)
s.connect(sys.argv[1])
s.sendall(b"stop\\n")
"""


@contextlib.contextmanager
def commanded_by_nobody(
    fccd: Path, scratch: Path, name: str
) -> Iterator[tuple[StandInProcess, DaemonUnderTest, Path]]:
    """Run a daemon of root's that the user nobody may command; give the command socket, too."""
    instance = f"{name}-{os.getpid()}"
    others = (
        f'[telemetry]\ninstance = "{instance}"\n[rights]\nuser = "root"\ncommanders = ["nobody"]\n'
    )
    with StandInProcess(Settings(port=0)) as simulator:
        config = write_config(scratch, simulator.port, others=others)
        with DaemonUnderTest([fccd, "run", "--config", config, "--json"], scratch) as daemon:
            yield simulator, daemon, Path("/dev/shm/fccd-commands-0") / instance


@needs_two_users
def test_commanders_do_not_delay_each_other_and_old_commands_are_dropped(
    fccd: Path, scratch: Path
) -> None:
    with commanded_by_nobody(fccd, scratch, "crowd") as (_, daemon, socket):
        daemon.wait_until_ready()
        daemon.send(signal.SIGSTOP)
        one_of_them(NOBODY, GIVES_UP, socket)
        daemon.send(signal.SIGCONT)
        dropped = f"a command of user {NOBODY} was not carried out, for its sender has given up"
        assert dropped in daemon.wait_for("was not carried out")
        # A user has two places, and a place is free again when no line comes.
        third, first = one_of_them(NOBODY, HOLDS_PLACES, socket).splitlines()
        assert third == f"refused 2 programs of user {NOBODY} wait for an answer already: " + (
            "send it again"
        )
        assert first == "refused it did not come in time"
        count, *answers = one_of_them(STRANGER, CROWD, socket).splitlines()
        assert len(answers) == int(count) > 100
        assert all("may not command this fccd" in answer for answer in answers)
        (engaged,) = commanding(NOBODY, socket, "set altimeter_setting_pa=101325\\n")
        assert engaged.startswith("carried-out ")
        ending = daemon.end(signal.SIGTERM)
    assert ending.exit_code == SUCCESS, ending.log


@needs_two_users
def test_who_commands_a_daemon_that_is_stopped_is_told_so(fccd: Path, scratch: Path) -> None:
    """Its queue has room at first; then another user has filled it."""
    with commanded_by_nobody(fccd, scratch, "stopped") as (_, daemon, socket):
        daemon.wait_until_ready()
        daemon.send(signal.SIGSTOP)
        words: list[str | Path] = [*as_user(NOBODY), fccd, "command", "disengage"]
        words += ["--instance", socket.name, "--of", "root"]

        def sends() -> subprocess.Popen[str]:
            return subprocess.Popen(words, stderr=subprocess.PIPE, text=True, cwd="/")

        with sends() as first:
            # It waits in the queue.
            time.sleep(1.0)
            fills: list[str | Path] = [*as_user(STRANGER), sys.executable, "-I", "-c", FILLS]
            fills.append(socket)
            with subprocess.Popen(
                fills, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, cwd="/"
            ) as crowd:
                assert crowd.stdin is not None
                assert crowd.stdout is not None
                assert int(crowd.stdout.readline()) > 100
                with sends() as second:
                    _, said = second.communicate(timeout=60.0)
                assert second.returncode == FAILURE
                assert "fccd did not accept the connection within 5 s: it is stopped" in said
                crowd.stdin.close()
            _, said = first.communicate(timeout=60.0)
            assert first.returncode == FAILURE
            assert "fccd did not answer within 15 s" in said
        daemon.send(signal.SIGCONT)
        daemon.wait_for("was not carried out, for its sender has given up")
        assert daemon.end(signal.SIGTERM).exit_code == SUCCESS


@needs_two_users
def test_only_those_who_are_named_may_command(fccd: Path, scratch: Path) -> None:
    with commanded_by_nobody(fccd, scratch, "rights") as (simulator, daemon, socket):
        engage(simulator, daemon)
        assert stat.S_IMODE(socket.parent.stat().st_mode) == 0o711
        (refused,) = commanding(STRANGER, socket, "disengage\\n")
        assert refused.startswith(f"refused user {STRANGER} may not command this fccd")
        heading, unknown, bad, outside, long, binary = commanding(
            NOBODY,
            socket,
            "set heading_rad=1.5\\n",
            "set no_such=1\\n",
            "dance\\n",
            "set altitude_m=1e308\\n",
            "x" * 600,
            "\\xff\\n",
            silent=1,
        )
        assert heading.startswith("carried-out ")
        assert "there is no set point 'no_such'" in unknown
        assert "there is no such command" in bad
        assert "altitude is" in outside
        assert (long, binary) == ("refused it is too long", "refused it is not a text")
        # Silent ones of a user who is not permitted take no place.
        commanding(STRANGER, socket, silent=40)
        words: list[str | Path] = [
            fccd,
            "command",
            "disengage",
            "--instance",
            socket.name,
            "--of",
            "root",
        ]
        user = as_user(NOBODY)
        done = subprocess.run([*user, *words], capture_output=True, text=True, check=False)
        assert done.returncode == SUCCESS, done.stderr
        daemon.wait_for("engaged -> standby")
        assert_released(simulator)
        ending = daemon.end(signal.SIGTERM)
    assert ending.exit_code == SUCCESS, ending.log
    assert not socket.exists()
