"""The wire: bytes laid out by hand, and a parser that nothing can throw."""

from __future__ import annotations

import contextlib
import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fcc_hil.protocol import (
    Dialect,
    Position,
    ProtocolError,
    RequestPosition,
    RunCommand,
    SelectRows,
    Subscribe,
    WriteDataref,
    WriteRows,
    beacon,
    data_rows,
    parse,
    rpos_reply,
    rref_replies,
)

XPLANE_10, XPLANE_11, XPLANE_12 = Dialect(104_500), Dialect(115_501), Dialect(121_000)


def padded(path: bytes, size: int) -> bytes:
    return path + bytes(size - len(path))


# The bytes of each message, written out.
SUBSCRIBE = b"RREF\0" + b"\x28\0\0\0" + b"\x07\0\0\0" + padded(b"sim/time/paused", 400)
WRITE = b"DREF\0" + b"\0\0\x80\x3f" + padded(b"sim/operation/override/override_joystick", 500)
ROW_8 = b"\x08\0\0\0" + b"\0\0\x00\x3f" + b"\0\xc0\x79\xc4" * 7
GOOD = [
    (SUBSCRIBE, Subscribe(40, 7, "sim/time/paused")),
    (WRITE, WriteDataref(1.0, "sim/operation/override/override_joystick")),
    (b"DATA\0" + ROW_8, WriteRows(((8, (0.5, *[-999.0] * 7)),))),
    (b"DATA\0" + ROW_8 * 2, WriteRows(((8, (0.5, *[-999.0] * 7)),) * 2)),
    (b"RPOS\x0040\0", RequestPosition(40)),
    (b"RPOS\x000\0", RequestPosition(0)),
    (b"DSEL\0" + b"\x03\0\0\0" + b"\x11\0\0\0", SelectRows((3, 17), on=True)),
    (b"USEL\0" + b"\x03\0\0\0", SelectRows((3,), on=False)),
    (b"CMND\0sim/operation/pause_toggle", RunCommand("sim/operation/pause_toggle")),
    (b"CMND\0sim/operation/pause_toggle\0", RunCommand("sim/operation/pause_toggle")),
]


def test_lengths_are_those_of_the_layouts() -> None:
    assert len(SUBSCRIBE) == 413
    assert len(WRITE) == 509


@pytest.mark.parametrize(("datagram", "message"), GOOD)
def test_good_datagrams(datagram: bytes, message: object) -> None:
    assert parse(datagram) == message


@pytest.mark.parametrize(
    ("datagram", "why"),
    [
        (b"", "too short"),
        (b"RREF", "too short"),
        (b"DREFO" + WRITE[5:], "fifth byte"),
        (b"NOPE\0", "unknown"),
        (WRITE[:60], "60 bytes, and must be 509"),
        (WRITE + b"\0", "510 bytes, and must be 509"),
        (SUBSCRIBE[:-1], "412 bytes, and must be 413"),
        (b"RREF\0" + b"\xff\xff\xff\xff" + SUBSCRIBE[9:], "negative"),
        (WRITE[:9] + b"x" * 500, "no NUL"),
        (WRITE[:9] + bytes(500), "empty"),
        (WRITE[:9] + padded(b"sim/\xff", 500), "ASCII"),
        (WRITE[:5] + b"\0\0\xc0\x7f" + WRITE[9:], "not a finite number"),
        (b"DATA\0", r"5 \+ n x 36"),
        (b"DATA\0" + ROW_8[:-1], r"5 \+ n x 36"),
        (b"DATA\0" + b"\x8b\0\0\0" + ROW_8[4:], "row 139"),
        (b"DATA\0" + ROW_8[:4] + b"\0\0\x80\x7f" + ROW_8[8:], "not finite"),
        (b"RPOS\x0040", "ASCII digits and a NUL"),
        (b"RPOS\0-1\0", "ASCII digits and a NUL"),
        (b"RPOS\0" + b"\x28\0\0\0", "ASCII digits and a NUL"),
        (b"DSEL\0" + b"\xc8\0\0\0", "crashes X-Plane"),
        (b"DSEL\0\x03\0", r"5 \+ n x 4"),
        (b"CMND\0", "empty"),
    ],
)
def test_bad_datagrams_are_refused_with_the_reason(datagram: bytes, why: str) -> None:
    with pytest.raises(ProtocolError, match=why):
        parse(datagram)


tags = st.sampled_from([b"RREF", b"DREF", b"DATA", b"RPOS", b"DSEL", b"USEL", b"CMND", b"BECN"])


@given(st.one_of(st.binary(max_size=600), st.builds(bytes.__add__, tags, st.binary(max_size=520))))
def test_any_bytes_are_a_message_or_refused(datagram: bytes) -> None:
    with contextlib.suppress(ProtocolError):
        parse(datagram)


@given(st.sampled_from([datagram for datagram, _ in GOOD]), st.data())
def test_cut_and_flipped_datagrams_are_a_message_or_refused(
    datagram: bytes, data: st.DataObject
) -> None:
    broken = bytearray(datagram)
    where = data.draw(st.integers(0, len(broken) - 1))
    broken[where] ^= data.draw(st.integers(1, 255))
    length = data.draw(st.integers(0, len(broken)))
    for candidate in (bytes(broken), bytes(broken[:length])):
        with contextlib.suppress(ProtocolError):
            parse(candidate)


finite = st.floats(width=32, allow_nan=False, allow_infinity=False)
paths = st.from_regex(r"sim/[a-z_/]{1,60}(\[[0-9]{1,2}\])?", fullmatch=True)


@given(finite, paths)
def test_writes_are_read_back(value: float, path: str) -> None:
    datagram = b"DREF\0" + struct.pack("<f500s", value, path.encode())
    assert parse(datagram) == WriteDataref(value, path)


@given(st.integers(0, 1000), st.integers(-(2**31), 2**31 - 1), paths)
def test_subscriptions_are_read_back(frequency: int, index: int, path: str) -> None:
    datagram = b"RREF\0" + struct.pack("<ii400s", frequency, index, path.encode())
    assert parse(datagram) == Subscribe(frequency, index, path)


@pytest.mark.parametrize(
    ("dialect", "rref", "data"),
    [
        (XPLANE_10, b"RREFO", b"DATA@"),
        (XPLANE_11, b"RREF,", b"DATA*"),
        (XPLANE_12, b"RREF,", b"DATA*"),
    ],
)
def test_the_fifth_byte_follows_the_version(dialect: Dialect, rref: bytes, data: bytes) -> None:
    assert rref_replies([(7, 1.0)], dialect) == [rref + b"\x07\0\0\0" + b"\0\0\x80\x3f"]
    assert data_rows([(3, [0.5, *[-999.0] * 7])], dialect) == data + b"\x03\0\0\0" + ROW_8[4:]


def test_replies_hold_at_most_183_pairs() -> None:
    replies = rref_replies([(i, float(i)) for i in range(400)], XPLANE_11)
    assert [len(reply) for reply in replies] == [1469, 1469, 5 + 34 * 8]
    assert rref_replies([], XPLANE_11) == []


def test_position_reply() -> None:
    position = Position(
        -87.9, 43.0, 914.4, 700.0, 1.0, 270.0, -3.0, 10.0, 0.5, -50.0, 0.1, 0.2, 0.3
    )
    reply = rpos_reply(position)
    assert len(reply) == 69
    assert reply[:4] == b"RPOS"
    assert struct.unpack_from("<ddd", reply, 5) == (-87.9, 43.0, 914.4)
    floats = struct.unpack_from("<10f", reply, 29)
    assert floats == pytest.approx((700.0, 1.0, 270.0, -3.0, 10.0, 0.5, -50.0, 0.1, 0.2, 0.3))


def test_position_reply_byte_by_byte() -> None:
    # Longitude, latitude, elevation as doubles; height, pitch, heading, roll, velocities and rates
    # as floats, packed: the order of X-Plane's "Exchanging Data with X-Plane".
    numbers = (1.0, 2.0, -1.0, 0.5, 1.0, 2.0, -1.0, 0.5, 1.0, 2.0, -1.0, 0.5, 1.0)
    doubles = {1.0: "000000000000f03f", 2.0: "0000000000000040", -1.0: "000000000000f0bf"}
    floats = {1.0: "0000803f", 2.0: "00000040", -1.0: "000080bf", 0.5: "0000003f"}
    layout = [doubles[n] for n in numbers[:3]] + [floats[n] for n in numbers[3:]]
    reply = rpos_reply(Position(*numbers))
    assert reply[:4] == b"RPOS"
    assert reply[5:].hex() == "".join(layout)


def test_beacon() -> None:
    assert beacon(XPLANE_11, 49_000, "cessna") == (
        b"BECN\0"  # header
        b"\x01\x02"  # beacon 1.2
        b"\x01\0\0\0"  # X-Plane
        b"\x2d\xc3\x01\0"  # 115501
        b"\x01\0\0\0"  # master
        b"\x68\xbf"  # port 49000
        b"cessna\0"
    )
    assert beacon(XPLANE_10, 49_000, "x")[6] == 1
