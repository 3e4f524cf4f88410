"""A daemon on another host, flown against the stand-in on this one.

That daemon runs already, with `[x-plane] simulator` set to this host. There is no shell
and no live telemetry between the two: what is known of it is what it does to the
simulator. It takes the controls, and gives them back. Where it gives them back though
nobody switched off, it was in failsafe, and had been for as long as it holds one before
it releases (`[failsafe] hold_s`): so a failsafe is seen late and dated back.
"""

from __future__ import annotations

import socket
from dataclasses import replace

from .marks import AutopilotMark
from .process import StandInError, StandInProcess
from .rig import ENGAGED, FAILSAFE, RELEASED, Event, FlightError
from .standin import Progress, Settings
from .standin_rig import StandInRig

_SUBSCRIBE_S = 30.0
"""A daemon repeats its subscriptions every 5 s by default."""
_SETTLE_S = 4.0
_SEEN_LATE_S = 0.5


def address_of(host: str) -> str:
    """Return a host's IPv4 address, or raise ValueError."""
    try:
        return socket.gethostbyname(host)
    except (OSError, UnicodeError) as error:
        raise ValueError(f"no address for the host '{host}': {error}") from error


def address_towards(host: str) -> str:
    """Return this machine's address as `host` sees it, or raise ValueError."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            # Nothing is sent: the kernel only selects the route.
            probe.connect((address_of(host), 9))
        except OSError as error:
            raise ValueError(f"no route to the host '{host}': {error.strerror}") from error
        here: str = probe.getsockname()[0]
    return here


class RemoteRig(StandInRig):
    """A stand-in that waits for the daemon of another host."""

    def __init__(
        self, host: str, listen: tuple[str, int], settings: Settings, autopilot: AutopilotMark
    ) -> None:
        """Listen at an address of this host. Raise FlightError if that fails."""
        self.host = host
        self._daemon_at = address_of(host)
        try:
            simulator = StandInProcess(replace(settings, host=listen[0], port=listen[1]))
        except StandInError as error:
            raise FlightError(f"the stand-in does not start: {error}") from error
        super().__init__(simulator, f"{settings.aircraft}, flown by {host}")
        self._here = f"{listen[0]}:{simulator.port}"
        self._hold_s = autopilot.failsafe_hold_s
        self._was_held = False
        self.failsafe_shows_after_s = self._hold_s + _SEEN_LATE_S

    def prepare(self) -> None:
        """Wait until that host's daemon subscribes, and let its navigation settle."""
        self._await_subscriptions(
            _SUBSCRIBE_S,
            f"no daemon subscribed to the stand-in at {self._here} for {_SUBSCRIBE_S:.0f} s: is "
            f'fccd running on {self.host}, with [x-plane] simulator = "{self._here}", and is no '
            "firewall in between?",
        )
        clients = [client.rpartition(":")[0] for client in self.simulator.status()["clients"]]
        strangers = [client for client in clients if client != self._daemon_at]
        if strangers:
            raise FlightError(
                f"{', '.join(strangers)} subscribed to the stand-in at {self._here}, and not only "
                f"{self.host} ({self._daemon_at}): stop the daemon there"
            )
        self.fly_to(self.time_s + _SETTLE_S)

    def _look(self) -> Progress:
        progress = super()._look()
        if progress.overridden and not self._was_held:
            self.events.append(Event(progress.time_s, ENGAGED))
        elif self._was_held and not progress.overridden:
            at_s = self.simulator.releases()[-1].time_s
            if self.switch_is_on:
                began = f"{FAILSAFE}: by the release {self._hold_s:g} s later"
                self.events.append(Event(at_s - self._hold_s, began))
                self.events.append(Event(at_s, "failsafe -> standby"))
            else:
                self.events.append(Event(at_s, "engaged -> standby"))
            self.events.append(Event(at_s, RELEASED))
        self._was_held = progress.overridden
        return progress
