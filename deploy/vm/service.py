"""The service in the guest, and a stand-in for X-Plane on this machine that it flies.

    with flight(guest, scratch) as (simulator, service):
        service.engage(simulator)
        guest.sh("systemctl restart fccd")

Its state is read from the guest's systemd, journal, kernel and recordings. All waits have long
limits, because an emulated machine is slow.
"""

from __future__ import annotations

import contextlib
import json
import re
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

import tomlkit
from fcc_hil.fly import ENGAGE_SWITCH
from fcc_hil.process import StandInProcess
from fcc_hil.standin import Settings
from recordings import RECORD, in_sequence

from guest import HOST, Guest, accelerator

CONFIG = "/etc/fccd/fccd.toml"
RECORDINGS = "/var/lib/fccd/recordings"
DROP_IN = "/run/systemd/system/fccd.service.d"
PERIOD_NS = 25_000_000
ENGAGED, FAILSAFE = 1, 2
"""Phases, as a recording calls them."""
PATIENCE_S = 180.0
_ATTEMPTS = 5
_LOOK_S = 0.1

# Faults, in bits, of the autopilot's flags.rs: the quantities that control needs are too old.
_ALL_OLD = 0x3F
# With these: the engage switch is silent, so is the simulator, readings are old by its own clock.
_LATE = _ALL_OLD | 1 << 11 | 1 << 20 | 1 << 42

# A guest on a busy host pauses at times. These limits keep that from causing most failsafes, which
# are not tested here.
UNHURRIED: Mapping[str, Mapping[str, object]] = {
    "budget": {"failsafe_after": 0},
    "failsafe": {"sensor_max_age_ms": 600},
    "guidance": {"mode": "hold"},
}


class Service:
    """`fccd.service` of a guest."""

    def __init__(self, guest: Guest) -> None:
        """Read the journal from now on."""
        self.guest = guest
        output = guest.sh("journalctl --lines 1 --quiet --output json")
        self._cursor = json.loads(output)["__CURSOR"]

    def show(self, name: str) -> str:
        """Return one of its properties."""
        return self.guest.sh(f"systemctl show --property {name} --value fccd").strip()

    @property
    def status(self) -> str:
        """Return its status in systemd."""
        return self.show("StatusText")

    @property
    def pid(self) -> int:
        return int(self.show("MainPID"))

    def journal(self) -> list[dict[str, Any]]:
        """Return the journal of systemd and the daemon since this was created."""
        lines = self.guest.sh(
            f"journalctl --unit fccd --output json --after-cursor '{self._cursor}'"
        )
        return [json.loads(line) for line in lines.splitlines()]

    def configure(self, sections: Mapping[str, Mapping[str, object]]) -> None:
        """Change values in its configuration, as with an editor."""
        document = tomlkit.parse(self.guest.agent.read(CONFIG).decode())
        for section, values in sections.items():
            if section not in document:
                document[section] = tomlkit.table()
            document[section].update(values)
        self.guest.agent.write(CONFIG, tomlkit.dumps(document).encode())

    def wait_until(self, holds: Callable[[], bool], what: str) -> None:
        give_up_s = time.monotonic() + PATIENCE_S
        while not holds():
            assert time.monotonic() < give_up_s, f"not within {PATIENCE_S:.0f} s: {what}; " + (
                self.guest.sh(
                    "systemctl status --no-pager --lines 0 fccd; "
                    f"journalctl --no-pager --unit fccd --after-cursor '{self._cursor}'"
                )
            )
            time.sleep(_LOOK_S)

    def wait_for_status(self, expression: str) -> None:
        """Wait until its status begins so."""
        self.wait_until(lambda: re.match(expression, self.status) is not None, expression)

    def engage(self, simulator: StandInProcess) -> None:
        """Move the switch inside the simulator, and wait for the status in systemd."""
        for _ in range(_ATTEMPTS):
            self.wait_for_status("standby$")
            before = self._refusals()
            simulator.write(ENGAGE_SWITCH, 1.0)
            self.wait_until(
                lambda before=before: self.status == "engaged" or self._refusals() > before,  # type: ignore[misc]
                "engaged, or refused",
            )
            if self.status == "engaged":
                break
            # On a busy host it was ready no more when the switch arrived.
            self._switch_off(simulator)
        self.wait_for_status("engaged$")
        self.wait_until(lambda: simulator.progress().overridden, "the overrides are set")

    def engage_again(self, simulator: StandInProcess) -> None:
        """Move the switch off first, for a daemon that has seen it on only."""
        self._switch_off(simulator)
        self.engage(simulator)

    def _switch_off(self, simulator: StandInProcess) -> None:
        simulator.write(ENGAGE_SWITCH, 0.0)
        # Long enough to be seen: an on that follows an off unseen is none.
        self.fly_on(simulator, 1.0)

    def _refusals(self) -> int:
        """Return how often it has said that it does not engage."""
        texts = (str(entry["MESSAGE"]) for entry in self.journal())
        return sum("not engaged" in text for text in texts)

    def fly_on(self, simulator: StandInProcess, seconds: float) -> None:
        """Wait until the simulator has flown on."""
        until_s = simulator.progress().time_s + seconds
        self.wait_until(lambda: simulator.progress().time_s > until_s, f"{seconds} s of flight")

    def recordings(self) -> list[str]:
        """Return the paths of its recordings, oldest first, unless the clock was set."""
        return self.guest.sh(f"find {RECORDINGS} -name '*.mcap' | sort").split()

    def replayed(self, path: str) -> dict[str, Any]:
        """Fly a recording again in the guest; return what `fccd replay` found."""
        done = self.guest.try_sh(f"fccd replay --json {path}")
        found: dict[str, Any] = json.loads(done.out)
        return {**found, "exit_code": done.exit_code}

    def records(self, path: str, scratch: Path) -> list[Any]:
        """Return the records of each tick of a recording, decoded by PyPI's mcap."""
        copy = scratch / Path(path).name
        copy.write_bytes(self.guest.agent.read(path))
        return [seen.content for seen in in_sequence(copy) if seen.topic == RECORD]


@contextlib.contextmanager
def flight(
    guest: Guest, sections: Mapping[str, Mapping[str, object]] | None = None
) -> Iterator[tuple[StandInProcess, Service]]:
    """Start a stand-in here and the service there; end both, and remove all files."""
    # East, where a heading and another one beside it are nearly the same number.
    with StandInProcess(Settings(port=0, heading_deg=90.0)) as simulator:
        service = Service(guest)
        kept = guest.agent.read(CONFIG)
        service.configure(UNHURRIED)
        service.configure({"x-plane": {"simulator": f"{HOST}:{simulator.port}"}})
        service.configure(sections or {})
        guest.sh("systemctl enable --now fccd")
        try:
            yield simulator, service
        finally:
            guest.try_sh("systemctl disable --now fccd; systemctl reset-failed fccd")
            guest.try_sh(f"rm -rf {RECORDINGS} /var/lib/fccd/*.flight")
            # Unless the package was removed meanwhile.
            if guest.try_sh("test -d /etc/fccd").exit_code == 0:
                guest.agent.write(CONFIG, kept)


def assert_control_is_kept(records: Iterable[Any]) -> None:
    """Assert that it is engaged in all of them.

    An emulated machine receives late at times, by more than the 600 ms that can be configured. A
    failsafe because of that, and of nothing else, is permitted there: control is kept in it.
    """
    for record in records:
        state = record.state
        if state.phase == FAILSAFE and accelerator() == "tcg":
            assert state.flags & _ALL_OLD == _ALL_OLD, hex(state.flags)
            assert state.flags & ~_LATE == 0, hex(state.flags)
        else:
            assert state.phase == ENGAGED
