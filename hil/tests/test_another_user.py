"""Another user of the machine tries everything that it has a name for, in flight."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

from daemon_under_test import (
    DaemonUnderTest,
    assert_released,
    engage,
    flight,
    wait_until,
    write_config,
)
from other_user import NOBODY, as_user, needs_two_users

from fcc_hil.process import StandInProcess
from fcc_hil.standin import Settings

SUCCESS = 0

pytestmark = needs_two_users

# Prints each attempt that was not refused, and how many there were.
TRIES = """
import ctypes, json, os, resource, socket, sys
given = json.load(sys.stdin)
permitted, tried = [], 0

def tries(what, act):
    global tried
    tried += 1
    try:
        act()
    except OSError:
        return
    permitted.append(what)

libc = ctypes.CDLL(None, use_errno=True)

def call(*arguments):
    if libc.syscall(*arguments) < 0:
        raise OSError(ctypes.get_errno(), "")

def trace(pid):
    if libc.ptrace(PTRACE_ATTACH, pid, 0, 0) != 0:
        raise OSError(ctypes.get_errno(), "")

def writes(path):
    with open(path, "wb", buffering=0) as file:
        file.write(b"1")

def memory(pid):
    with open(f"/proc/{pid}/mem", "r+b") as file:
        file.seek(4096)
        file.write(b"x")

PTRACE_ATTACH = 16
PIDFD_GETFD = 438
for pid in given["processes"]:
    for number in (0, 9, 15, 19, 18, 1):
        tries(f"signal {number} to {pid}", lambda: os.kill(pid, number))
    tries(f"signal to the group of {pid}", lambda: os.killpg(pid, 9))
    tries(f"trace {pid}", lambda: trace(pid))
    for name in ("mem", "environ", "maps", "auxv", "syscall", "stack", "io"):
        tries(f"read {name} of {pid}", lambda: open(f"/proc/{pid}/{name}", "rb").read(1))
    for name in ("fd", "map_files"):
        tries(f"list {name} of {pid}", lambda: os.listdir(f"/proc/{pid}/{name}"))
    tries(f"write memory of {pid}", lambda: memory(pid))
    for name in ("cwd", "exe", "root"):
        tries(f"follow {name} of {pid}", lambda: os.readlink(f"/proc/{pid}/{name}"))
    for name in ("oom_score_adj", "comm", "timerslack_ns", "clear_refs", "coredump_filter"):
        tries(f"write {name} of {pid}", lambda: writes(f"/proc/{pid}/{name}"))
    limits = (3, 3)
    tries(f"limits of {pid}", lambda: resource.prlimit(pid, resource.RLIMIT_NOFILE, limits))
    tries(f"CPU of {pid}", lambda: os.sched_setaffinity(pid, {0}))
    idle = os.sched_param(0)
    tries(f"scheduler of {pid}", lambda: os.sched_setscheduler(pid, os.SCHED_IDLE, idle))
    tries(f"nice value of {pid}", lambda: os.setpriority(os.PRIO_PROCESS, pid, 19))
    handle = os.pidfd_open(pid)
    for descriptor in range(3, 12):
        tries(f"descriptor {descriptor} of {pid}", lambda: call(PIDFD_GETFD, handle, descriptor, 0))

for path in given["paths"]:
    for flags in (os.O_RDONLY, os.O_WRONLY, os.O_RDWR | os.O_TRUNC, os.O_WRONLY | os.O_CREAT):
        tries(f"open {path}", lambda: os.open(path, flags | os.O_NONBLOCK))
    tries(f"truncate {path}", lambda: os.truncate(path, 0))
    tries(f"remove {path}", lambda: os.unlink(path))
    tries(f"rename {path}", lambda: os.rename(path, path + ".theirs"))
    theirs = f"/var/tmp/theirs-{os.getpid()}-{tried}"
    tries(f"link {path}", lambda: os.link(path, theirs))
    tries(f"mode of {path}", lambda: os.chmod(path, 0o666))
    tries(f"list {path}", lambda: os.listdir(path))
    tries(f"create in {path}", lambda: os.mkdir(path + "/theirs"))
    tries(f"socket {path}", lambda: socket.socket(socket.AF_UNIX).connect(path))
for port in given["ports"]:
    for address in ("127.0.0.1", "0.0.0.0"):
        def bind():
            s = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
            s.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            s.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEPORT, 1)
            s.bind((address, port))
        tries(f"port {port} of {address}", bind)
print(json.dumps({"permitted": permitted, "tried": tried}))
"""


def everything_of(daemon: DaemonUnderTest) -> dict[str, Any]:
    """Return the processes, files and ports of a flight, as root sees them."""
    processes = [daemon.pid, *daemon.children()]
    paths, ports = set[str](), set[int]()
    rows = [row.split() for row in Path("/proc/net/udp").read_text().splitlines()[1:]]
    by_inode = {row[9]: int(row[1].partition(":")[2], 16) for row in rows}
    for pid in processes:
        for descriptor in Path(f"/proc/{pid}/fd").iterdir():
            try:
                target = str(descriptor.readlink())
            except FileNotFoundError:
                continue  # It has been closed since.
            if target.startswith("/") and not target.startswith(("/dev/null", "/proc")):
                paths.add(target)
            port = by_inode.get(target.removeprefix("socket:[").removesuffix("]"))
            if port:
                ports.add(port)
        for line in Path(f"/proc/{pid}/maps").read_text().splitlines():
            path = line.partition("/")[2]
            if "live-" in path:
                paths.add("/" + path)
    folders = {str(folder) for path in paths for folder in Path(path).parents}
    paths |= {folder for folder in folders if "fccd" in folder}
    return {"processes": processes, "paths": sorted(paths), "ports": sorted(ports)}


def test_another_user_is_refused_everything_in_flight(fccd: Path, tmp_path: Path) -> None:
    # Of its own name: daemons of one name publish one at a time.
    named = f'[telemetry]\ninstance = "another-{os.getpid()}"\n'
    with flight(fccd, tmp_path, others=named) as (simulator, daemon):
        engage(simulator, daemon)
        # Helper and publisher.
        wait_until(lambda: len(daemon.children()) >= 2, "the publisher runs")
        given = everything_of(daemon)
        # Lock, recording and shared memory.
        assert any("/live-" in path for path in given["paths"])
        assert any(path.endswith(".mcap") for path in given["paths"])
        assert given["ports"]
        done = subprocess.run(
            [*as_user(NOBODY), sys.executable, "-I", "-c", TRIES],
            input=json.dumps(given),
            capture_output=True,
            text=True,
            check=True,
            cwd="/",
            # SIGCONT is permitted within a session (kill(2)).
            start_new_session=True,
        )
        result = json.loads(done.stdout)
        ending = daemon.end(signal.SIGTERM)
        assert_released(simulator)
    print(f"{result['tried']} attempts at {len(given['paths'])} files")
    assert result["tried"] > 300
    assert result["permitted"] == []
    assert ending.exit_code == SUCCESS, ending.log
    assert ending.report["released"] is True
    assert ending.report["failsafes"] == 0
    assert ending.states == ["standby -> engaged", "engaged -> stopped"]


IN_A_NAMESPACE = ["unshare", "--user", "--map-root-user"]
"""As a service with PrivateUsers=yes: all users but its own are one."""


def test_in_a_namespace_of_users_commanders_are_refused_and_it_is_said(
    fccd: Path, tmp_path: Path
) -> None:
    instance = f"namespace-{os.getpid()}"
    others = (
        f'[telemetry]\ninstance = "{instance}"\n[rights]\nuser = "root"\ncommanders = ["nobody"]\n'
    )
    with StandInProcess(Settings(port=0)) as simulator:
        config = write_config(tmp_path, simulator.port, others=others)
        words: list[str | Path] = [*IN_A_NAMESPACE, fccd, "run", "--config", config, "--json"]
        with DaemonUnderTest(words, tmp_path) as daemon:
            daemon.wait_for("rights.commanders: this program is in a namespace of users")
            engage(simulator, daemon)
            assert "give the service PrivateUsers=no" in daemon.log
            command: list[str | Path] = [fccd, "command", "disengage", "--of", "root"]
            command = [*as_user(NOBODY), *command, "--instance", instance]
            done = subprocess.run(command, capture_output=True, text=True, check=False)
            assert f"user {NOBODY} may not command this fccd" in done.stderr
            ending = daemon.end(signal.SIGTERM)
        assert_released(simulator)
    assert ending.exit_code == SUCCESS, ending.log
    assert ending.states == ["standby -> engaged", "engaged -> stopped"]
