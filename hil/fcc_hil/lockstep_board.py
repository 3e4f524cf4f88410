"""A servo board in lockstep: between the loop and the aircraft lies a serial line, with its bytes.

The board is the reference one, with the pitot tube, the engage switch and the surfaces; the other
raw sensors are the computer's own. The line takes no time, and may change bits.
"""

from __future__ import annotations

import math
import random
import struct
from dataclasses import dataclass, field, replace

import fcc

from .board_link import disturbed
from .cockpit import ENGAGE_SWITCH, OVERRIDE_JOYSTICK, OVERRIDE_THROTTLES
from .lockstep_rig import Conditions, LockstepRig
from .plant import Plant
from .protocol import UNUSED
from .servo_board import DIFFERENTIAL_PRESSURE, Decoder, Readings, ServoBoard, encode
from .standin import Settings
from .state import Controls

_ASSERT_EVERY_S = 0.25
"""As the daemon: overrides are set and values requested again, for they may have been lost."""
_REPLIES_HZ = 250
_PRESSURE, _SWITCH = 0, 1
_ROW = struct.Struct("<i8f")
_PAIR = struct.Struct("<if")


@dataclass
class BoardLine:
    """A line, and what was lost on it."""

    bit_errors: float = 0.0
    """The probability of each bit to be wrong."""
    board: Decoder = field(default_factory=Decoder)
    """What the board received."""
    computer: Decoder = field(default_factory=Decoder)


class BoardedLockstepRig(LockstepRig):
    """A loop that flies an aircraft through a servo board."""

    def __init__(
        self,
        settings: Settings,
        plant: Plant,
        machine: fcc.Machine,
        conditions: Conditions,
        line: BoardLine,
    ) -> None:
        """Combine them."""
        self._board = ServoBoard()
        self._line = line
        self._rng = random.Random(settings.seed)
        self._sequences = [0, 0]
        self._asserted_s = -math.inf
        self._is_on = False
        super().__init__(settings, plant, machine, replace(conditions, raw_fault=self._read))

    def set_switch(self, *, on: bool) -> None:
        """Move the board's switch."""
        self._is_on = on

    def _read(self, values: fcc.Measurements, time_s: float) -> None:
        """Replace the pitot tube's reading by what the board sends of it."""
        pressure_pa = values.differential_pressure_pa
        values.differential_pressure_pa = math.nan
        readings = Readings(
            differential_pressure_pa=None if math.isnan(pressure_pa) else pressure_pa,
            engage_switch=self._is_on,
        )
        reply = self._board.poll(time_s, readings)
        if reply is None:
            return
        for message in self._line.computer.push(self._sent(1, reply)):
            for index, value in _PAIR.iter_unpack(message[5:]):
                if index == _PRESSURE:
                    values.differential_pressure_pa = value
                else:
                    super().set_switch(on=value >= 0.5)

    def _stand(self) -> Controls:
        # A board has no trim.
        return replace(self.plant.controls, elevator_trim=None)

    def _write(self, controls: Controls) -> None:
        """Send what the loop writes, and fly with what the board drives."""
        time_s = self.plant.time_s
        holds = self.holds_control
        messages = []
        if time_s - self._asserted_s >= _ASSERT_EVERY_S or not holds:
            self._asserted_s = time_s
            messages += [
                _subscribe(_PRESSURE, DIFFERENTIAL_PRESSURE),
                _subscribe(_SWITCH, ENGAGE_SWITCH),
                _set(OVERRIDE_JOYSTICK, float(holds)),
                _set(OVERRIDE_THROTTLES, float(holds)),
            ]
        if holds:
            messages.append(_surfaces(controls))
        for message in messages:
            for received in self._line.board.push(self._sent(0, message)):
                self._board.receive(time_s, "line", received)
        super()._write(self._board.drive(self.plant.trim))

    def _sent(self, way: int, message: bytes) -> bytes:
        frame = encode(self._sequences[way], message)
        self._sequences[way] = (self._sequences[way] + 1) % 256
        return disturbed(frame, self._line.bit_errors, self._rng)


def _subscribe(index: int, path: str) -> bytes:
    return b"RREF\0" + struct.pack("<ii", _REPLIES_HZ, index) + path.encode()


def _set(path: str, value: float) -> bytes:
    return b"DREF\0" + struct.pack("<f", value) + path.encode()


def _surfaces(controls: Controls) -> bytes:
    joystick = (controls.elevator, controls.aileron, controls.rudder)
    rows = [(8, joystick), (25, (controls.throttle,))]
    packed = (_ROW.pack(row, *values, *[UNUSED] * (8 - len(values))) for row, values in rows)
    return b"DATA\0" + b"".join(packed)
