"""What systemd does when the daemon hangs, is killed, or cannot start."""

from __future__ import annotations

import signal
from collections.abc import Callable
from pathlib import Path

import pytest

from guest import Guest
from service import DROP_IN, ENGAGED, Service, flight

USAGE = 2
REALTIME_REFUSED = 4

# Of systemd's catalogue, sd-messages(3).
PROCESS_ENDED = "98e322203f7a4ed290d09fe03c09fe15"
UNIT_FAILED = "d9b373ed55a64feb8242e02dbe79a49c"
RESTART_SCHEDULED = "5eb03494b6584870a536b337290809b3"
UNIT_STARTING = "7d4958e842da4a758f6c1cdc7b36dcc5"
UNIT_STARTED = "39f53479d3a045ac8e11786248231fbf"

# Nominally less than one; an emulated machine takes two, and nine on a busy host.
RESTART_S = 60.0

# The same applies to the age of a flight to recover, 10 s by default.
WARM = {"restart": {"mode": "warm", "max_age_s": 300.0}}
# The estimate of a captured altitude improves for some seconds; the stored one is at most a second
# old and differs by less than this.
KEPT_WITHIN_M = 0.3
COLD = {"restart": {"mode": "cold"}}


def _when(service: Service, message: str, place: int) -> float:
    """Return when systemd noted something, in seconds since the boot."""
    noted = [entry for entry in service.journal() if entry.get("MESSAGE_ID") == message]
    return int(noted[place]["__MONOTONIC_TIMESTAMP"]) * 1e-6


def _result(service: Service) -> str:
    failed = [entry for entry in service.journal() if entry.get("MESSAGE_ID") == UNIT_FAILED]
    return str(failed[-1]["UNIT_RESULT"])


def _kill(service: Service, name: str) -> None:
    service.guest.sh(f"systemctl kill --kill-whom=main --signal={name} fccd")


def _wait_for_restart(service: Service, pid: int) -> None:
    service.wait_until(
        lambda: service.show("ActiveState") == "active" and service.pid != pid,
        "another process is active",
    )
    assert service.show("NRestarts") == "1"


def _assert_restarted_soon(service: Service, figures: list[str], what: str) -> None:
    steps = (PROCESS_ENDED, RESTART_SCHEDULED, UNIT_STARTING, UNIT_STARTED)
    ended_s, scheduled_s, starting_s, started_s = (_when(service, step, -1) for step in steps)
    figures.append(
        f"{what}: active again {started_s - ended_s:.2f} s after the process' end; until the "
        f"helper had released {scheduled_s - ended_s:.2f} s (0.1 s of it RestartSec), until "
        f"systemd began {starting_s - scheduled_s:.2f} s, until it was ready "
        f"{started_s - starting_s:.2f} s"
    )
    assert ended_s < scheduled_s <= starting_s < started_s < ended_s + RESTART_S


def test_a_killed_flight_is_recovered(guest: Guest, tmp_path: Path, figures: list[str]) -> None:
    with flight(guest, WARM) as (simulator, service):
        service.engage(simulator)
        # It is kept each second.
        service.fly_on(simulator, 3.0)
        pid = service.pid
        _kill(service, "KILL")
        _wait_for_restart(service, pid)
        assert _result(service) == "signal"
        _assert_restarted_soon(service, figures, "killed")
        service.wait_for_status("engaged$")
        service.wait_until(lambda: simulator.progress().overridden, "the overrides are set")
        service.fly_on(simulator, 3.0)
        assert service.status == "engaged"
        service.guest.sh("systemctl stop fccd")
        killed, taken_up = (service.records(path, tmp_path) for path in service.recordings())
    assert killed[-1].state.phase == ENGAGED
    engaged = [record for record in taken_up if record.state.phase == ENGAGED]
    before_s = (engaged[0].tick.woke_ns - taken_up[0].tick.woke_ns) * 1e-9
    figures.append(f"killed: flight recovered {before_s:.2f} s after the new loop's first tick")
    # It engages as always, and gets the stored state in the next tick.
    last = killed[-1].setpoints
    for record in engaged[1:]:
        aims = record.setpoints
        assert aims.heading_rad == pytest.approx(last.heading_rad, abs=1e-6)
        assert aims.airspeed_mps == pytest.approx(last.airspeed_mps, abs=1e-6)
        assert aims.altitude_m == pytest.approx(last.altitude_m, abs=KEPT_WITHIN_M)


def test_after_a_killed_flight_it_stays_in_standby_if_configured(
    guest: Guest, tmp_path: Path
) -> None:
    with flight(guest, COLD) as (simulator, service):
        service.engage(simulator)
        service.fly_on(simulator, 3.0)
        pid = service.pid
        _kill(service, "KILL")
        _wait_for_restart(service, pid)
        service.wait_until(lambda: not simulator.progress().overridden, "the helper releases")
        service.wait_for_status("standby")
        service.fly_on(simulator, 3.0)
        assert not simulator.progress().overridden
        service.guest.sh("systemctl stop fccd")
        _, after = (service.records(path, tmp_path) for path in service.recordings())
    assert all(record.state.phase != ENGAGED for record in after)


def test_a_daemon_without_watchdog_notifications_is_restarted(
    guest: Guest, figures: list[str]
) -> None:
    with flight(guest, COLD) as (simulator, service):
        service.engage(simulator)
        assert service.show("WatchdogUSec") == "2s"
        pid = service.pid
        _kill(service, "STOP")
        _wait_for_restart(service, pid)
        assert _result(service) == "watchdog"
        ended = [e for e in service.journal() if e.get("MESSAGE_ID") == PROCESS_ENDED]
        # How the process ended, as wait(2) told systemd.
        assert ended[-1]["EXIT_CODE"] == "killed"
        assert int(ended[-1]["EXIT_STATUS"]) == signal.SIGABRT
        _assert_restarted_soon(service, figures, "stopped, and ended by the watchdog")
        service.wait_until(lambda: not simulator.progress().overridden, "the helper releases")
        # It flies again after the switch goes on.
        service.engage_again(simulator)


def _wrong_configuration(guest: Guest) -> None:
    guest.sh("echo 'rate_hz = 40' >> /etc/fccd/fccd.toml")


def _no_right_to_real_time(guest: Guest) -> None:
    guest.sh(
        f"mkdir -p {DROP_IN}; printf '[Service]\nLimitRTPRIO=0\n' > {DROP_IN}/refused.conf; "
        "systemctl daemon-reload"
    )


@pytest.mark.parametrize(
    ("spoil", "exit_code"),
    [(_wrong_configuration, USAGE), (_no_right_to_real_time, REALTIME_REFUSED)],
)
def test_a_start_that_would_fail_again_is_not_repeated(
    guest: Guest, spoil: Callable[[Guest], None], exit_code: int
) -> None:
    with flight(guest, {"realtime": {"strict": True}}) as (_, service):
        service.guest.sh("systemctl stop fccd")
        spoil(guest)
        try:
            assert guest.try_sh("systemctl start fccd").exit_code != 0
            # Between two tries it would be "activating (auto-restart)".
            assert (service.show("ActiveState"), service.show("SubState")) == ("failed", "failed")
            assert service.show("Result") == "exit-code"
            assert service.show("ExecMainStatus") == str(exit_code)
            assert service.show("NRestarts") == "0"
        finally:
            guest.sh(f"rm -rf {DROP_IN}; systemctl daemon-reload")


def test_other_failures_are_restarted_without_limit(guest: Guest) -> None:
    """More often than systemd's own limit, which is five times in ten seconds."""
    with flight(guest) as (_, service):
        for _ in range(7):
            pid = service.pid
            _kill(service, "KILL")
            service.wait_until(
                lambda pid=pid: service.show("ActiveState") == "active" and service.pid != pid,  # type: ignore[misc]
                "another process is active",
            )
        assert service.show("NRestarts") == "7"
