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
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import tomlkit
from fcc_hil.fly import ENGAGE_SWITCH
from fcc_hil.process import StandInProcess
from fcc_hil.standin import Settings
from recordings import RECORD, in_sequence

from guest import HOST, Guest

CONFIG = "/etc/fccd/fccd.toml"
RECORDINGS = "/var/lib/fccd/recordings"
DROP_IN = "/run/systemd/system/fccd.service.d"
PERIOD_NS = 25_000_000
ENGAGED = 1
"""The phase, as a recording calls it."""
PATIENCE_S = 180.0
_LOOK_S = 0.1

# A guest on a busy host pauses at times. These limits keep that from causing failsafes, which are
# not tested here.
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
                self.guest.sh("systemctl status --lines 40 fccd; true")
            )
            time.sleep(_LOOK_S)

    def wait_for_status(self, expression: str) -> None:
        """Wait until its status begins so."""
        self.wait_until(lambda: re.match(expression, self.status) is not None, expression)

    def engage(self, simulator: StandInProcess) -> None:
        """Move the switch inside the simulator, and wait for the status in systemd."""
        self.wait_for_status("standby$")
        simulator.write(ENGAGE_SWITCH, 1.0)
        self.wait_for_status("engaged$")
        self.wait_until(lambda: simulator.progress().overridden, "the overrides are set")

    def engage_again(self, simulator: StandInProcess) -> None:
        """Move the switch off first, for a daemon that has seen it on only."""
        simulator.write(ENGAGE_SWITCH, 0.0)
        self.engage(simulator)

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
