"""Who may command a daemon by its socket, and what the others get."""

from __future__ import annotations

import contextlib
import os
import signal
import stat
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

from daemon_under_test import (
    DaemonUnderTest,
    assert_released,
    engage,
    write_config,
)
from other_user import NOBODY, as_user, needs_two_users

from fcc_hil.process import StandInProcess
from fcc_hil.standin import Settings

SUCCESS = 0
FAILURE = 1
USAGE = 2

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
