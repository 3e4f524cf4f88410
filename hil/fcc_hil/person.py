"""A stand-in with a person at it, who does what `fccd x-plane check --yes` asks for.

The check sends commands `fccd/check/step/NN/ACTION`, which X-Plane does not know: `begin` and `end`
of each step, and what only a person can do. X-Plane's own commands work as without the person.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

from .cockpit import SIM_SPEED
from .datarefs import Getter
from .faults import Address
from .frames import FrameClock
from .misbehaviour import MISBEHAVIOURS, Misbehaviour
from .protocol import HEADER_BYTES, RunCommand, WriteDataref, WriteRows, parse
from .readout import Readout
from .settings import Mode, Settings
from .standin import StandIn
from .state import Controls, State
from .subscriptions import Subscriptions

CUES = "fccd/check/step/"

_TURN_BANK_RAD = math.radians(30.0)
_NUDGE = 0.35
_NUDGE_S = 0.8
_FEW_FRAMES_HZ = 15.0
_FREEZE_S = 0.8
_PAIR_BYTES = 8


class Hands:
    """A person's hands: they hold level flight or a bank, and make one deflection at a time."""

    def __init__(self) -> None:
        """Hold level flight."""
        self.bank_rad = 0.0
        self._pitch_rad: float | None = None
        self._rudder = 0.0
        self._nudge = Controls()
        self._nudged_s = 0.0

    def deflect(self, controls: Controls) -> None:
        """Deflect the controls for a moment."""
        self._nudge, self._nudged_s = controls, _NUDGE_S

    def controls(self, state: State, trim: Controls, seconds: float) -> Controls:
        """Return the controls that they hold for the next frame."""
        if self._pitch_rad is None:
            self._pitch_rad = state.pitch_rad
        climb = math.atan2(-state.down_mps, state.true_airspeed_mps)
        pitch_error = self._pitch_rad - state.pitch_rad - 0.5 * climb
        # Towards the ball, until it is centred.
        self._rudder += 0.05 * seconds * -state.specific_force_y_mps2
        self._rudder = min(0.5, max(-0.5, self._rudder))
        held = Controls(
            elevator=trim.elevator + 2.0 * pitch_error - 0.5 * state.pitch_rate_radps,
            aileron=1.0 * (self.bank_rad - state.roll_rad) - 0.3 * state.roll_rate_radps,
            rudder=self._rudder - 0.1 * state.specific_force_y_mps2,
            throttle=trim.throttle,
        )
        if self._nudged_s > 0.0:
            self._nudged_s -= seconds
            nudge = self._nudge
            held = replace(
                held,
                elevator=held.elevator + nudge.elevator,
                aileron=held.aileron + nudge.aileron,
                rudder=held.rudder + nudge.rudder,
            )
        return Controls(
            elevator=min(1.0, max(-1.0, held.elevator)),
            aileron=min(1.0, max(-1.0, held.aileron)),
            rudder=min(1.0, max(-1.0, held.rudder)),
            throttle=held.throttle,
        )


class _Subscriptions(Subscriptions):
    """Subscriptions whose values a misbehaviour changes, withholds or splits."""

    misbehaviour = Misbehaviour("")
    world: StandIn

    def due(
        self, now_s: float, readout: Readout, withheld: frozenset[str] = frozenset()
    ) -> list[tuple[Address, bytes]]:
        """Return the datagrams due on this frame."""
        bad = self.misbehaviour
        datagrams = super().due(now_s, readout, withheld | bad.withholds)
        if not bad.splits:
            return datagrams
        return [(client, part) for client, whole in datagrams for part in _halves(whole)]

    def value_of(self, path: str, read: Getter, readout: Readout) -> float:
        """Return a value as it is sent."""
        change = self.misbehaviour.distorts.get(path)
        value = read(readout)
        return value if change is None else change(self.world, value)


def _halves(datagram: bytes) -> list[bytes]:
    header, body = datagram[:HEADER_BYTES], datagram[HEADER_BYTES:]
    middle = len(body) // _PAIR_BYTES // 2 * _PAIR_BYTES
    if header[:4] != b"RREF" or middle == 0:
        return [datagram]
    return [header + body[:middle], header + body[middle:]]


class AttendedStandIn(StandIn):
    """The stand-in with a person at it."""

    def __init__(self, settings: Settings) -> None:
        """Set it up as any stand-in."""
        super().__init__(settings)
        self._replies_to = _Subscriptions(
            self.dialect, shuffle=settings.shuffle, seed=settings.seed
        )
        self._replies_to.world = self
        self._subscriptions = self._replies_to
        self._usual_clock = self.clock
        self._hands = Hands()
        self._joystick_is_over = False
        self._incoming_is_on = True
        self._firewall_drops = False
        self._known: set[Address] | None = None
        self._bad = Misbehaviour("")
        self.has_stopped = False
        """Whether it paused, showed a window or a replay, or hung, since the step's begin."""
        self.was_held = False
        """Whether a client overrode the controls since the step's begin."""

    def pass_time(self) -> bool:
        """Let a frame's time pass."""
        runs = super().pass_time()
        self.has_stopped |= self.mode is not Mode.RUNNING
        self.was_held |= self.overridden()
        return runs

    def fly(self) -> None:
        """Fly through a frame, by hand unless a client does."""
        if self.mode is Mode.RUNNING and not self.plant.state().on_ground:
            pilot = (
                replace(self.plant.trim, aileron=1.0, elevator=1.0)
                if self._joystick_is_over
                else self._hands.controls(self.plant.state(), self.plant.trim, self.period_s)
            )
            self.cockpit.hold(pilot)
        self._bad.each_frame(self)
        super().fly()

    def _handle(self, sender: Address, datagram: bytes) -> None:
        message = parse(datagram)
        if isinstance(message, RunCommand) and message.path.startswith(CUES):
            number, _, action = message.path.removeprefix(CUES).partition("/")
            self.follow(int(number), action)
            return
        if isinstance(message, WriteDataref | WriteRows | RunCommand) and not (
            self._incoming_is_on and self._bad.takes(self, message)
        ):
            return
        super()._handle(sender, datagram)

    def _transmit(self, client: Address, datagram: bytes) -> None:
        if client != self.settings.beacon and (
            self._firewall_drops or (self._known is not None and client not in self._known)
        ):
            return
        super()._transmit(client, datagram)

    def follow(self, step: int, action: str) -> None:
        """Do what a cue asks for; what no person does is ignored."""
        if action == "begin":
            self._begin(step)
        elif action == "end":
            self._end(step)
        elif action in _ACTIONS:
            _ACTIONS[action](self)

    def switch_incoming(self, *, on: bool) -> None:
        """Accept incoming connections, or not."""
        self._incoming_is_on = on or self._bad.ignores_person

    def switch_firewall(self, *, on: bool) -> None:
        """Let a firewall drop all replies, or none."""
        self._firewall_drops = on

    def fly_bank(self, bank_rad: float) -> None:
        """Fly with this bank."""
        self._hands.bank_rad = bank_rad

    def deflect(self, controls: Controls) -> None:
        """Deflect the controls for a moment."""
        self._hands.deflect(controls)

    def hold_over(self, *, on: bool) -> None:
        """Hold the joystick fully to the right and back, or let it go."""
        self._joystick_is_over = on

    def take_off(self) -> None:
        """Be in the air again."""
        if self.plant.state().on_ground:
            self.reload(on_runway=False, elsewhere=False)
            self._hands = Hands()

    def make_frames(self, rate_hz: float | None) -> None:
        """Make so many frames a second, or as many as before."""
        self.clock = self._usual_clock if rate_hz is None else FrameClock(rate_hz)
        self.clock.restart()

    def _begin(self, step: int) -> None:
        self.has_stopped = self.was_held = False
        if step in self.settings.misbehaves_in:
            self._bad = MISBEHAVIOURS[step]
            self._replies_to.misbehaviour = self._bad
            if self._bad.knows_nobody_else:
                self._known = set(self._subscriptions.paths())

    def _end(self, step: int) -> None:
        if step not in self.settings.misbehaves_in:
            return
        if self._bad.keeps_overrides:
            self.cockpit.clear_overrides()
        self._bad = self._replies_to.misbehaviour = Misbehaviour("")
        self._known = None
        self._joystick_is_over = self._firewall_drops = False
        self._incoming_is_on = True
        self.enter(Mode.RUNNING)
        self.cockpit.set(SIM_SPEED, 1.0)


_ACTIONS: dict[str, Callable[[AttendedStandIn], object]] = {
    "incoming-off": lambda sim: sim.switch_incoming(on=False),
    "incoming-on": lambda sim: sim.switch_incoming(on=True),
    "firewall-on": lambda sim: sim.switch_firewall(on=True),
    "firewall-off": lambda sim: sim.switch_firewall(on=False),
    "park": lambda sim: sim.reload(on_runway=True, elsewhere=False),
    "take-off": AttendedStandIn.take_off,
    "turn": lambda sim: sim.fly_bank(_TURN_BANK_RAD),
    "level": lambda sim: sim.fly_bank(0.0),
    "pull": lambda sim: sim.deflect(Controls(elevator=_NUDGE)),
    "roll-right": lambda sim: sim.deflect(Controls(aileron=_NUDGE)),
    "right-pedal": lambda sim: sim.deflect(Controls(rudder=_NUDGE)),
    "joystick-over": lambda sim: sim.hold_over(on=True),
    "joystick-centred": lambda sim: sim.hold_over(on=False),
    "frames-15": lambda sim: sim.make_frames(_FEW_FRAMES_HZ),
    "frames-normal": lambda sim: sim.make_frames(None),
    "freeze": lambda sim: sim.enter(Mode.FROZEN, _FREEZE_S),
}
"""What only a person can do, by the check's word for it."""
