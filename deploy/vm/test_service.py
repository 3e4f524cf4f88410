"""A flight of the service, and its state in systemd and the kernel."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from fault_flights import assert_regular
from fcc_hil.process import StandInProcess

from guest import Guest
from service import ENGAGED, PERIOD_NS, Service, flight

LOOP_PRIORITY = 80
WATCHDOG_PRIORITY = 81
SCHED_OTHER, SCHED_FIFO = 0, 1
MOST_EXPOSED = 2.0
# Fields of /proc/PID/task/TID/stat after the name, proc_pid_stat(5).
RT_PRIORITY, POLICY = 40 - 3, 41 - 3

AWAKE = {"realtime": {"cpu_dma_latency_us": 0}}

Flying = tuple[StandInProcess, Service]


@pytest.fixture(scope="module")
def flying(guest: Guest) -> Iterator[Flying]:
    """Fly, from `systemctl enable --now` on, all tests of this module."""
    with flight(guest, AWAKE) as (simulator, service):
        # It returns when the service is ready, and not before.
        assert service.status.startswith("standby")
        service.engage(simulator)
        yield simulator, service


def _status(service: Service, pid: int) -> dict[str, list[str]]:
    lines = service.guest.sh(f"cat /proc/{pid}/status").splitlines()
    return {name: value.split() for name, _, value in (line.partition(":") for line in lines)}


def test_systemd_has_its_state_and_status(flying: Flying) -> None:
    _, service = flying
    assert service.show("Type") == "notify"
    assert (service.show("ActiveState"), service.show("SubState")) == ("active", "running")
    assert service.status == "engaged"
    assert service.show("UnitFileState") == "enabled"
    assert service.show("NRestarts") == "0"


def test_the_loop_and_its_watchdog_are_real_time_threads_and_nothing_else(flying: Flying) -> None:
    _, service = flying
    granted = {}
    for line in service.guest.sh(f"cat /proc/{service.pid}/task/*/stat").splitlines():
        name = line[line.index("(") + 1 : line.rindex(")")]
        fields = line[line.rindex(")") + 2 :].split()
        policy, priority = int(fields[POLICY]), int(fields[RT_PRIORITY])
        if policy != SCHED_OTHER:
            granted[name] = (policy, priority)
    assert sorted(granted.values()) == [
        (SCHED_FIFO, LOOP_PRIORITY),
        (SCHED_FIFO, WATCHDOG_PRIORITY),
    ]
    assert granted["fcc-watchdog"] == (SCHED_FIFO, WATCHDOG_PRIORITY)


def test_its_rights_are_limited(flying: Flying) -> None:
    """Of the daemon, its release helper, and the process that publishes telemetry."""
    _, service = flying
    uid = service.guest.sh("id --user fccd").strip()
    gid = service.guest.sh("id --group fccd").strip()
    pids = service.guest.sh("cat /sys/fs/cgroup/system.slice/fccd.service/cgroup.procs").split()
    assert len(pids) == 3
    for pid in map(int, pids):
        status = _status(service, pid)
        assert status["Uid"] == [uid] * 4
        assert status["Gid"] == [gid] * 4
        for name in ("CapInh", "CapPrm", "CapEff", "CapBnd", "CapAmb"):
            assert int(status[name][0], 16) == 0, name
        assert status["NoNewPrivs"] == ["1"]
        # Filtered, by seccomp(2).
        assert status["Seccomp"] == ["2"]


def test_all_its_memory_is_locked(flying: Flying) -> None:
    _, service = flying
    status = _status(service, service.pid)
    locked_kb, resident_kb = int(status["VmLck"][0]), int(status["VmRSS"][0])
    assert 0 < resident_kb <= locked_kb
    assert status["VmSwap"][0] == "0"


def test_it_keeps_the_cpus_awake(flying: Flying) -> None:
    _, service = flying
    # It fails if one is closed between the list and the look.
    files = service.guest.try_sh(f"readlink /proc/{service.pid}/fd/*").out.split()
    assert "/dev/cpu_dma_latency" in files


def test_its_folders_are_its_own(flying: Flying) -> None:
    _, service = flying
    for folder in ("/var/lib/fccd", "/var/lib/fccd/recordings", "/run/fccd"):
        owner = service.guest.sh(f"stat --format '%U:%G' {folder}").strip()
        assert owner == "fccd:fccd", folder
    # Other users must not read recordings.
    modes = service.guest.sh("stat --format %a /var/lib/fccd/recordings/*.mcap").split()
    assert modes == ["640"]


def test_nothing_was_denied(flying: Flying) -> None:
    _, service = flying
    log = [str(entry["MESSAGE"]) for entry in service.journal()]
    assert any("recording to" in line for line in log)
    refused = re.compile("refused|not granted|denied|not permitted|EPERM|EACCES|failed", re.I)
    assert [line for line in log if refused.search(line)] == []
    # The kernel has not ended or logged anything because of a system call.
    assert "seccomp" not in service.guest.sh("dmesg")


def test_little_is_exposed_and_nothing_is_wrong(flying: Flying) -> None:
    _, service = flying
    output = service.guest.sh("systemd-analyze security --no-pager fccd")
    found = re.search(r"Overall exposure level for fccd.service: ([\d.]+)", output)
    assert found is not None, output
    assert float(found[1]) <= MOST_EXPOSED
    verified = service.guest.try_sh("systemd-analyze verify fccd.service")
    assert (verified.exit_code, verified.out + verified.err) == (0, "")


def test_it_can_be_watched_as_the_manual_says(flying: Flying) -> None:
    _, service = flying
    output = json.loads(service.guest.sh("sudo -u fccd fccd top --json"))
    assert output["process_id"] == service.pid
    assert output["tick"]["state"] == "engaged"
    assert (output["policy"], output["priority"]) == ("SCHED_FIFO", LOOP_PRIORITY)
    # On a terminal, until q is typed.
    screen = service.guest.sh(
        "cd $(mktemp -d); mkfifo keys; touch screen;"
        "TERM=xterm script --quiet --flush --return --command "
        "'stty rows 40 cols 120; sudo -u fccd fccd top' screen < keys > /dev/null & exec 3> keys;"
        "until grep --quiet engaged screen; do sleep 0.2; done; printf q >&3; wait $!; cat screen"
    )
    assert "Cessna" in screen or "X-Plane" in screen, screen


def test_it_stops_on_request_and_its_flight_can_be_replayed(flying: Flying, tmp_path: Path) -> None:
    """The last test: the service is stopped."""
    simulator, service = flying
    service.guest.sh("systemctl stop fccd")
    assert (service.show("ActiveState"), service.show("Result")) == ("inactive", "success")
    assert not simulator.progress().overridden
    (path,) = service.recordings()
    records = service.records(path, tmp_path)
    assert_regular(records, PERIOD_NS)
    assert any(record.state.phase == ENGAGED for record in records)
    found = service.replayed(path)
    assert found["exit_code"] == 0, found
    assert found["identity"]["differing"] == 0
    assert found["ticks"] == len(records)
