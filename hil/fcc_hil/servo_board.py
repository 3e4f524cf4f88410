"""The reference servo board: messages, frames for a serial line, and who has the servos.

It measures airspeed, has the engage switch and drives the servos; it speaks X-Plane's messages.
Like `fcc-servo-board`, the crate for firmware, and written independently of it: both are tested
with the same frames. Bytes and the time are arguments, nothing here does I/O.
"""

from __future__ import annotations

import math
import struct
import zlib
from collections.abc import Hashable, Iterator
from dataclasses import dataclass, field
from enum import Enum

from .cockpit import (
    ENGAGE_SWITCH,
    FLAPS,
    GEAR,
    LEFT_BRAKE,
    OVERRIDE_JOYSTICK,
    OVERRIDE_THROTTLES,
    RIGHT_BRAKE,
    THROTTLE_USE,
    YOKE,
)
from .protocol import (
    DREF_BYTES,
    RREF_BYTES,
    UNUSED,
    ProtocolError,
    Subscribe,
    WriteDataref,
    WriteRows,
    parse,
)
from .state import Controls
from .units import KT_TO_MPS

AIRSPEED = "sim/flightmodel/position/indicated_airspeed"
TIME = "sim/network/misc/network_time_sec"
"""s by the board's clock: by it the computer tells a message that arrives late from a new one."""
DIFFERENTIAL_PRESSURE = "fccd/servo_board/differential_pressure_pa"
_THROTTLE = f"{THROTTLE_USE}[0]"
_WHEELS = (FLAPS, LEFT_BRAKE, RIGHT_BRAKE, GEAR)
"""0..1, with the joystick's override; they stay as they are in the failsafe, but for the gear,
which is down then."""

_PERIOD_S = 0.02
"""Between two replies."""
FAILSAFE_AFTER_S = 0.2
_ROWS: dict[int, dict[int, str]] = {
    8: dict(enumerate(YOKE)),
    25: {0: _THROTTLE},
    13: {3: FLAPS},
    14: {0: GEAR, 2: LEFT_BRAKE, 3: RIGHT_BRAKE},
}
"""Of DATA: what is set by which column."""
_CRC = struct.Struct("<I")
_LONGEST_RUN = 254
_LONGEST_FRAME = 246
"""Encoded, without the delimiters."""


def encode(sequence: int, message: bytes) -> bytes:
    """Return the frame of a message: COBS of number, message and CRC-32, between two zeros."""
    body = bytes([sequence]) + message
    plain = body + _CRC.pack(zlib.crc32(body))
    encoded = bytearray()
    for run in plain.split(b"\0"):
        while len(run) >= _LONGEST_RUN:
            encoded += b"\xff" + run[:_LONGEST_RUN]
            run = run[_LONGEST_RUN:]  # noqa: PLW2901 - the rest of it
        encoded += bytes([len(run) + 1]) + run
    return b"\0" + bytes(encoded) + b"\0"


def _decode(encoded: bytes) -> tuple[int, bytes] | None:
    """Return the number and the message; None if that is no frame."""
    plain = bytearray()
    at = 0
    while at < len(encoded):
        code = encoded[at]
        run = encoded[at + 1 : at + code]
        if len(run) != code - 1:
            return None
        plain += run
        at += code
        if code <= _LONGEST_RUN and at < len(encoded):
            plain.append(0)
    if len(plain) < 1 + _CRC.size:
        return None
    body, crc = bytes(plain[: -_CRC.size]), _CRC.unpack(plain[-_CRC.size :])[0]
    return (body[0], body[1:]) if zlib.crc32(body) == crc else None


@dataclass
class Decoder:
    """Finds the frames in received bytes."""

    received: int = 0
    corrupt: int = 0
    """What was between two zeros and is no frame."""
    lost: int = 0
    """Frames that did not arrive, by their numbers."""
    _next: int | None = None
    _buffer: bytearray = field(default_factory=bytearray)

    def push(self, received: bytes) -> Iterator[bytes]:
        """Take bytes; yield the messages that they complete."""
        *whole, rest = received.split(b"\0")
        for part in whole:
            encoded = bytes(self._buffer + part)
            self._buffer.clear()
            if not encoded:
                continue
            frame = _decode(encoded) if len(encoded) <= _LONGEST_FRAME else None
            if frame is None:
                self.corrupt += 1
                continue
            sequence, message = frame
            self.lost += 0 if self._next is None else (sequence - self._next) % 256
            self._next = (sequence + 1) % 256
            self.received += 1
            yield message
        # One byte more than the longest is enough to know that it is too long.
        room = _LONGEST_FRAME + 1 - len(self._buffer)
        self._buffer += rest[:room]


class Control(Enum):
    """Who has the servos."""

    FREE = "free"
    HELD = "held"
    FAILSAFE = "failsafe"


@dataclass(frozen=True)
class Readings:
    """What the board measures; None for what it does not have."""

    airspeed_mps: float | None = None
    differential_pressure_pa: float | None = None
    engage_switch: bool | None = None
    pilot: Controls | None = None
    """Where the pilot's receiver has the servos."""


_CENTRED = Controls()


@dataclass
class _Subscription:
    path: str
    period_s: float
    sent_s: float = -math.inf


class ServoBoard:
    """The board's state. Times are of any clock in s."""

    def __init__(self, engage_switch: str = ENGAGE_SWITCH) -> None:
        """Start with nobody in control."""
        self.peer: Hashable = None
        """The computer that requested or wrote last."""
        self.silent_s = 0.0
        """How long nothing had been written, when that was last looked at."""
        self._switch = engage_switch
        self._subscriptions: dict[int, _Subscription] = {}
        self._overrides = {OVERRIDE_JOYSTICK: False, OVERRIDE_THROTTLES: False}
        self._written: dict[str, float] = {}
        self._written_s = 0.0
        self._is_lost = False
        self._replied_s = -math.inf

    @property
    def control(self) -> Control:
        """Return who has control."""
        if not any(self._overrides.values()):
            return Control.FREE
        return Control.FAILSAFE if self._is_lost else Control.HELD

    def receive(self, now_s: float, sender: Hashable, message: bytes) -> bool:
        """Take a message, with or without padding; return whether it had an effect."""
        self._notice_loss(now_s)
        size = {b"RREF\0": RREF_BYTES, b"DREF\0": DREF_BYTES}.get(message[:5], 0)
        try:
            request = parse(message.ljust(size, b"\0"))
        except ProtocolError:
            return False
        if self.control is Control.HELD and sender != self.peer:
            return False
        if sender != self.peer:
            self.peer = sender
            self._subscriptions.clear()
        match request:
            case Subscribe(frequency_hz, index, path):
                self._subscriptions.pop(index, None)
                if frequency_hz > 0 and path in self._names():
                    self._subscriptions[index] = _Subscription(path, 1.0 / frequency_hz)
                return path in self._names()
            case WriteDataref(value, path):
                return self._write(now_s, path, value)
            case WriteRows(rows):
                # Each, also after one without an effect.
                outcomes = [self._write_row(now_s, row, values) for row, values in rows]
                return all(outcomes)
        return False

    def poll(self, now_s: float, readings: Readings) -> bytes | None:
        """Return a message for `peer`, if one is due; to be called every few ms."""
        self._notice_loss(now_s)
        if now_s - self._replied_s < _PERIOD_S:
            return None
        self._replied_s = now_s
        pairs = []
        for index, subscription in self._subscriptions.items():
            if now_s - subscription.sent_s + 0.5 * _PERIOD_S >= subscription.period_s:
                subscription.sent_s = now_s
                path = subscription.path
                value = now_s if path == TIME else self._value(path, readings)
                if value is not None and math.isfinite(value):
                    pairs.append(struct.pack("<if", index, value))
        return b"RREF," + b"".join(pairs) if pairs else None

    def drive(self, otherwise: Controls) -> Controls:
        """Return where the servos go; what nobody holds goes where `otherwise` says."""
        safe = self.control is Control.FAILSAFE
        joystick, throttles = self._overrides.values()
        has_yoke = joystick and (safe or all(path in self._written for path in YOKE))
        yoke = [0.0 if safe else self._written.get(path, 0.0) for path in YOKE]
        elevator, aileron, rudder = (
            yoke if has_yoke else (otherwise.elevator, otherwise.aileron, otherwise.rudder)
        )
        has_throttle = throttles and (safe or _THROTTLE in self._written)
        throttle = 0.0 if safe else self._written.get(_THROTTLE, 0.0)
        return Controls(
            elevator=elevator,
            aileron=aileron,
            rudder=rudder,
            throttle=throttle if has_throttle else otherwise.throttle,
            flaps=self._written.get(FLAPS, otherwise.flaps),
            left_brake=self._written.get(LEFT_BRAKE, otherwise.left_brake),
            right_brake=self._written.get(RIGHT_BRAKE, otherwise.right_brake),
            gear=1.0 if safe and GEAR in self._written else self._written.get(GEAR, otherwise.gear),
        )

    def _names(self) -> set[str]:
        names = {TIME, AIRSPEED, DIFFERENTIAL_PRESSURE, self._switch, _THROTTLE}
        return names | set(YOKE) | set(_WHEELS) | set(self._overrides)

    def _value(self, path: str, readings: Readings) -> float | None:
        if path in self._overrides:
            return float(self._overrides[path])
        if path == AIRSPEED:
            speed = readings.airspeed_mps
            return None if speed is None else speed / KT_TO_MPS
        if path == DIFFERENTIAL_PRESSURE:
            return readings.differential_pressure_pa
        if path == self._switch:
            return None if readings.engage_switch is None else float(readings.engage_switch)
        if path == GEAR:
            return self.drive(_CENTRED).gear
        if path in _WHEELS:
            return self._written.get(path)
        is_free = self.control is Control.FREE
        if readings.pilot is None and (is_free or path not in self._written):
            return None
        driven = self.drive(readings.pilot if is_free and readings.pilot else _CENTRED)
        values = (driven.elevator, driven.aileron, driven.rudder, driven.throttle)
        return dict(zip((*YOKE, _THROTTLE), values, strict=True))[path]

    def _write_row(self, now_s: float, row: int, values: tuple[float, ...]) -> bool:
        targets = _ROWS.get(row, {})
        each = [
            self._write(now_s, path, values[column])
            for column, path in targets.items()
            if values[column] != UNUSED
        ]
        return bool(targets) and all(each)

    def _write(self, now_s: float, path: str, value: float) -> bool:
        if path in self._overrides:
            is_set = value >= 0.5
            if is_set and self.control is Control.FREE:
                self._written_s, self._is_lost = now_s, False
            if self._overrides[path] != is_set:
                self._overrides[path] = is_set
                for gone in (*YOKE, *_WHEELS) if path == OVERRIDE_JOYSTICK else (_THROTTLE,):
                    self._written.pop(gone, None)
            return True
        override = OVERRIDE_THROTTLES if path == _THROTTLE else OVERRIDE_JOYSTICK
        if path not in (*YOKE, *_WHEELS, _THROTTLE) or not self._overrides[override]:
            return False
        least = -1.0 if path in YOKE else 0.0
        self._written[path] = min(1.0, max(least, value))
        self._written_s, self._is_lost = now_s, False
        return True

    def _notice_loss(self, now_s: float) -> None:
        self.silent_s = now_s - self._written_s
        if self.control is Control.HELD and self.silent_s >= FAILSAFE_AFTER_S:
            self._is_lost = True
