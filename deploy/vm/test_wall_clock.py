"""The wall clock of a whole machine, set in flight: a day forwards and two days back."""

from __future__ import annotations

import itertools
from pathlib import Path

import pytest
from fault_flights import assert_regular
from recordings import RECORD, in_sequence

from guest import Guest
from service import ENGAGED, PERIOD_NS, Service, flight

DAY_S = 86_400
# Between two readings of a clock, on an emulated machine.
LATE_S = 60.0


def _ahead_s(guest: Guest) -> float:
    """Return the kernel's wall clock minus the time since its boot."""
    now, up = guest.sh("date +%s; cat /proc/uptime").split()[:2]
    return float(now) - float(up)


def _set(service: Service, days: int) -> None:
    before_s = _ahead_s(service.guest)
    service.guest.sh(f"date --set '{days:+d} days'")
    stepped_s = _ahead_s(service.guest) - before_s
    assert stepped_s == pytest.approx(days * DAY_S, abs=LATE_S)


def test_a_wall_clock_that_is_set_changes_nothing(guest: Guest, tmp_path: Path) -> None:
    with flight(guest) as (simulator, service):
        service.engage(simulator)
        service.fly_on(simulator, 2.0)
        started = service.show("ExecMainStartTimestampMonotonic")
        up_s = float(guest.sh("cat /proc/uptime").split()[0])
        for days in (+1, -2):
            _set(service, days)
            service.fly_on(simulator, 4.0)
            assert service.status == "engaged"
            assert simulator.progress().overridden
        flown_s = float(guest.sh("cat /proc/uptime").split()[0]) - up_s
        # systemd's watchdog does not fire either: it is the same process.
        assert service.show("ExecMainStartTimestampMonotonic") == started
        assert service.show("NRestarts") == "0"
        guest.sh("systemctl stop fccd")
        (path,) = service.recordings()
        records = service.records(path, tmp_path)
        found = service.replayed(path)
    assert_regular(records, PERIOD_NS)
    phases = [record.state.phase for record in records]
    engaged = records[phases.index(ENGAGED) : -1]
    assert {record.state.phase for record in engaged} == {ENGAGED}
    assert all(record.faults == 0 for record in engaged)
    # The loop's time is the kernel's.
    spent_s = (engaged[-1].tick.woke_ns - engaged[0].tick.woke_ns) * 1e-9
    assert flown_s < spent_s < flown_s + LATE_S
    assert all(a.tick.woke_ns < b.tick.woke_ns for a, b in itertools.pairwise(records))
    # The wall clock is read once, at the start.
    seen = [m for m in in_sequence(tmp_path / Path(path).name) if m.topic == RECORD]
    assert (seen[-1].log_time_ns - seen[0].log_time_ns) * 1e-9 == pytest.approx(
        (records[-1].tick.woke_ns - records[0].tick.woke_ns) * 1e-9, abs=1.0
    )
    assert (found["exit_code"], found["identity"]["differing"]) == (0, 0), found
