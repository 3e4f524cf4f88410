"""The reference servo board, without a computer: frames, messages, failsafe."""

from __future__ import annotations

import struct
import zlib

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fcc_hil.cockpit import (
    ENGAGE_SWITCH,
    LEFT_BRAKE,
    OVERRIDE_JOYSTICK,
    OVERRIDE_THROTTLES,
    YOKE_PITCH,
)
from fcc_hil.servo_board import (
    AIRSPEED,
    DIFFERENTIAL_PRESSURE,
    Control,
    Decoder,
    Readings,
    ServoBoard,
    encode,
)
from fcc_hil.state import Controls

FRAME = bytes.fromhex(
    "0001054452454601012f803f73696d2f6f7065726174696f6e2f6f766572726964652f"
    "6f766572726964655f6a6f79737469636b9805f56500"
)
"""Frame 0 that sets `override_joystick` to 1; also in `crates/fcc-servo-board/tests/it/frames.rs`,
where firmware's crate makes and reads it."""

PILOT = Controls(elevator=0.1, aileron=0.2, rudder=0.3, throttle=0.4)


def dref(path: str, value: float) -> bytes:
    return b"DREF\0" + struct.pack("<f", value) + path.encode()


def rref(frequency_hz: int, index: int, path: str) -> bytes:
    return b"RREF\0" + struct.pack("<ii", frequency_hz, index) + path.encode()


def rows(elevator: float, aileron: float, rudder: float, throttle: float) -> bytes:
    unused = [-999.0] * 8
    joystick = [elevator, aileron, rudder, *unused][:8]
    throttles = [throttle, *unused][:8]
    return b"DATA\0" + struct.pack("<i8f", 8, *joystick) + struct.pack("<i8f", 25, *throttles)


def pairs(reply: bytes | None) -> dict[int, float]:
    assert reply is not None
    assert reply[:5] == b"RREF,"
    return dict(struct.iter_unpack("<if", reply[5:]))


def test_a_frame_is_as_firmware_makes_it() -> None:
    message = dref(OVERRIDE_JOYSTICK, 1.0)
    assert encode(0, message) == FRAME
    assert list(Decoder().push(FRAME)) == [message]
    # The check value of CRC-32/ISO-HDLC in the catalogue of CRC algorithms (G. Cook).
    assert zlib.crc32(b"123456789") == 0xCBF43926
    assert encode(0x31, b"23456789") == b"\x00\x0e123456789\x26\x39\xf4\xcb\x00"


@given(st.lists(st.binary(max_size=240), max_size=6), st.binary(max_size=400))
def test_frames_arrive_whole_after_any_bytes(messages: list[bytes], noise: bytes) -> None:
    decoder = Decoder()
    list(decoder.push(noise))
    line = b"".join(encode(number, message) for number, message in enumerate(messages))
    assert list(decoder.push(line))[-len(messages) or None :] == messages


def test_lost_and_corrupt_frames_are_counted() -> None:
    decoder = Decoder()
    line = b"".join(encode(number % 256, b"DATA\0") for number in range(300) if number != 257)
    damaged = bytearray(line)
    damaged[3] ^= 4
    assert len(list(decoder.push(bytes(damaged)))) == 298
    assert (decoder.received, decoder.corrupt, decoder.lost) == (298, 1, 1)


def held() -> ServoBoard:
    board = ServoBoard()
    for path in (OVERRIDE_JOYSTICK, OVERRIDE_THROTTLES):
        assert board.receive(0.0, "line", dref(path, 1.0))
    assert board.drive(PILOT) == PILOT
    assert board.receive(0.0, "line", rows(0.5, -0.5, 0.25, 0.75))
    return board


def test_control_is_taken_followed_and_released() -> None:
    board = ServoBoard()
    assert not board.receive(0.0, "line", rows(0.5, -0.5, 0.25, 0.75))
    assert (board.control, board.drive(PILOT)) == (Control.FREE, PILOT)
    board = held()
    assert board.control is Control.HELD
    assert board.drive(PILOT) == Controls(elevator=0.5, aileron=-0.5, rudder=0.25, throttle=0.75)
    board.receive(0.1, "line", dref(YOKE_PITCH, -3.0))
    assert board.drive(PILOT).elevator == -1.0
    for path in (OVERRIDE_JOYSTICK, OVERRIDE_THROTTLES):
        board.receive(0.1, "line", dref(path, 0.0))
    assert (board.control, board.drive(PILOT)) == (Control.FREE, PILOT)


def test_flaps_brakes_and_gear_stay_as_written_until_the_release() -> None:
    board = held()
    unused = -999.0
    flaps = struct.pack("<i8f", 13, unused, unused, unused, 0.5, *[unused] * 4)
    brakes = struct.pack("<i8f", 14, 0.0, 1.0, 0.25, 0.75, *[unused] * 4)
    assert board.receive(0.1, "line", b"DATA\0" + flaps + brakes)
    driven = board.drive(PILOT)
    assert (driven.flaps, driven.left_brake, driven.right_brake) == (0.5, 0.25, 0.75)
    assert driven.gear == 0.0
    assert board.receive(0.1, "line", dref(LEFT_BRAKE, 3.0))
    assert board.receive(0.1, "line", rref(50, 7, LEFT_BRAKE))
    assert pairs(board.poll(0.4, Readings())) == {7: 1.0}
    driven = board.drive(PILOT)
    assert (board.control, driven.flaps, driven.left_brake) == (Control.FAILSAFE, 0.5, 1.0)
    assert driven.gear == 1.0
    board.receive(0.5, "line", dref(OVERRIDE_JOYSTICK, 0.0))
    assert board.drive(PILOT).flaps is None


def test_after_200_ms_of_silence_it_is_centred_until_the_next_write() -> None:
    board = held()
    readings = Readings()
    board.poll(0.199, readings)
    assert board.control is Control.HELD
    # Requests and overrides are no writes of the surfaces.
    board.receive(0.199, "line", dref(OVERRIDE_JOYSTICK, 1.0))
    board.poll(0.2, readings)
    assert (board.control, board.drive(PILOT)) == (Control.FAILSAFE, Controls())
    board.receive(9.0, "line", rows(0.5, -0.5, 0.25, 0.75))
    assert board.control is Control.HELD


def test_readings_are_sent_as_they_are_requested() -> None:
    board = ServoBoard()
    for index, path in enumerate((AIRSPEED, DIFFERENTIAL_PRESSURE, ENGAGE_SWITCH)):
        assert board.receive(0.0, "line", rref(250, index, path))
    assert not board.receive(0.0, "line", rref(250, 9, "sim/time/paused"))
    # 36 kt are 18.52 m/s.
    readings = Readings(airspeed_mps=18.52, differential_pressure_pa=-3.5, engage_switch=True)
    assert pairs(board.poll(1.0, readings)) == pytest.approx({0: 36.0, 1: -3.5, 2: 1.0})
    assert board.poll(1.01, readings) is None
    assert pairs(board.poll(1.02, Readings(engage_switch=False))) == {2: 0.0}


def test_a_message_has_the_time_at_which_it_was_made() -> None:
    board = ServoBoard()
    assert board.receive(0.0, "line", rref(50, 4, "sim/network/misc/network_time_sec"))
    assert pairs(board.poll(12.5, Readings())) == {4: 12.5}
    assert not board.receive(12.5, "line", dref("sim/network/misc/network_time_sec", 1.0))


def test_while_it_is_held_no_other_computer_is_heard() -> None:
    board = held()
    assert not board.receive(0.1, "another", dref(OVERRIDE_JOYSTICK, 0.0))
    assert (board.control, board.peer) == (Control.HELD, "line")
    assert board.receive(0.3, "another", dref(OVERRIDE_JOYSTICK, 0.0))
