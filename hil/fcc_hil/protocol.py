"""X-Plane's side of its UDP protocol: parses received datagrams, builds replies.

Every message begins with four letters and a fifth byte. To X-Plane that byte is NUL; from X-Plane
it is for internal use and differs by version. All numbers are packed and little-endian. Parsing is
as strict as X-Plane 12: a datagram of the wrong length is refused, and `ProtocolError` states the
reason.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

HEADER_BYTES = 5
DREF_BYTES = 509
"""5 + f32 + path[500]"""
RREF_BYTES = 413
"""5 + i32 + i32 + path[400]"""
DATA_ROW_BYTES = 36
"""i32 + 8 x f32"""
MAX_PAIRS = 183
"""Pairs of index and value in one RREF reply: 1,469 bytes."""
LAST_ROW = 138
"""The highest row of the Data Output screen. Selecting a higher one crashes X-Plane."""
UNUSED = -999.0
"""In a DATA row: no value, unchanged."""

_SUBSCRIBE = struct.Struct("<ii")
_FLOAT = struct.Struct("<f")
_ROW = struct.Struct("<i8f")
_PAIR = struct.Struct("<if")
_POSITION = struct.Struct("<3d10f")
_BEACON = struct.Struct("<BBiiIH")


class ProtocolError(ValueError):
    """A datagram that X-Plane would not accept."""


@dataclass(frozen=True)
class Subscribe:
    """RREF: send a dataref's value at this frequency, under the caller's index."""

    frequency_hz: int
    """0 ends the subscription."""
    index: int
    path: str


@dataclass(frozen=True)
class WriteDataref:
    """DREF: set a dataref, or one element of it."""

    value: float
    path: str


@dataclass(frozen=True)
class WriteRows:
    """DATA: set the columns of rows, except those with -999."""

    rows: tuple[tuple[int, tuple[float, ...]], ...]


@dataclass(frozen=True)
class RequestPosition:
    """RPOS: send the position at this frequency; 0 ends it."""

    frequency_hz: int


@dataclass(frozen=True)
class SelectRows:
    """DSEL and USEL: switch rows of the Data Output on or off."""

    rows: tuple[int, ...]
    on: bool


@dataclass(frozen=True)
class RunCommand:
    """CMND: run a command once."""

    path: str


Message = Subscribe | WriteDataref | WriteRows | RequestPosition | SelectRows | RunCommand


def parse(datagram: bytes) -> Message:
    """Return the message in a datagram sent to X-Plane, or raise ProtocolError."""
    if len(datagram) < HEADER_BYTES:
        raise ProtocolError(f"{len(datagram)} bytes: too short for a header of {HEADER_BYTES}")
    tag, fifth, body = datagram[:4], datagram[4], datagram[HEADER_BYTES:]
    if fifth != 0:
        raise ProtocolError(f"{tag!r}: the fifth byte is {fifth}, and must be NUL to X-Plane")
    if tag == b"RREF":
        return _parse_subscribe(body)
    if tag == b"DREF":
        return _parse_write(body)
    if tag == b"DATA":
        return _parse_rows(body)
    if tag == b"RPOS":
        return _parse_position_request(body)
    if tag in (b"DSEL", b"USEL"):
        return _parse_selection(body, on=tag == b"DSEL")
    if tag == b"CMND":
        return RunCommand(_path(body, "CMND"))
    raise ProtocolError(f"unknown message {tag!r}")


def _path(field: bytes, tag: str, *, terminated: bool = False) -> str:
    text, end, _padding = field.partition(b"\0")
    if terminated and not end:
        raise ProtocolError(f"{tag}: the path has no NUL in its {len(field)} bytes")
    if not text:
        raise ProtocolError(f"{tag}: the path is empty")
    try:
        return text.decode("ascii")
    except UnicodeDecodeError as error:
        raise ProtocolError(f"{tag}: the path is not ASCII: {text[:40]!r}") from error


def _require_length(body: bytes, expected: int, tag: str) -> None:
    length = len(body) + HEADER_BYTES
    if length != expected:
        raise ProtocolError(f"{tag}: {length} bytes, and must be {expected}")


def _parse_subscribe(body: bytes) -> Subscribe:
    _require_length(body, RREF_BYTES, "RREF")
    frequency_hz, index = _SUBSCRIBE.unpack_from(body)
    if frequency_hz < 0:
        raise ProtocolError(f"RREF: frequency {frequency_hz} Hz is negative")
    return Subscribe(frequency_hz, index, _path(body[_SUBSCRIBE.size :], "RREF", terminated=True))


def _parse_write(body: bytes) -> WriteDataref:
    _require_length(body, DREF_BYTES, "DREF")
    (value,) = _FLOAT.unpack_from(body)
    path = _path(body[_FLOAT.size :], "DREF", terminated=True)
    if not math.isfinite(value):
        raise ProtocolError(f"DREF: {path} = {value} is not a finite number")
    return WriteDataref(value, path)


def _parse_rows(body: bytes) -> WriteRows:
    if not body or len(body) % DATA_ROW_BYTES != 0:
        raise ProtocolError(
            f"DATA: {len(body) + HEADER_BYTES} bytes, and must be "
            f"{HEADER_BYTES} + n x {DATA_ROW_BYTES}"
        )
    rows = []
    for row, *values in _ROW.iter_unpack(body):
        if not 0 <= row <= LAST_ROW:
            raise ProtocolError(f"DATA: row {row} is outside 0..{LAST_ROW}")
        if not all(math.isfinite(value) for value in values):
            raise ProtocolError(f"DATA: row {row} holds a value that is not finite")
        rows.append((row, tuple(values)))
    return WriteRows(tuple(rows))


def _parse_position_request(body: bytes) -> RequestPosition:
    digits, end, rest = body.partition(b"\0")
    if not end or rest or not digits.isdigit() or len(digits) > 5:
        raise ProtocolError(f"RPOS: {body[:20]!r} is not a frequency as ASCII digits and a NUL")
    return RequestPosition(int(digits))


def _parse_selection(body: bytes, *, on: bool) -> SelectRows:
    tag = "DSEL" if on else "USEL"
    if not body or len(body) % 4 != 0:
        raise ProtocolError(f"{tag}: {len(body) + HEADER_BYTES} bytes, and must be 5 + n x 4")
    rows = struct.unpack(f"<{len(body) // 4}i", body)
    for row in rows:
        if not 0 <= row <= LAST_ROW:
            raise ProtocolError(f"{tag}: row {row} is outside 0..{LAST_ROW} and crashes X-Plane")
    return SelectRows(rows, on)


@dataclass(frozen=True)
class Dialect:
    """Differences between versions of X-Plane's protocol."""

    version: int
    """As X-Plane reports it: 115501 is 11.55 r1."""

    @property
    def major(self) -> int:
        """Return 10, 11 or 12."""
        return self.version // 10_000

    @property
    def rref_tag(self) -> bytes:
        """Return the five bytes that begin a reply to RREF."""
        return b"RREF," if self.major >= 11 else b"RREFO"

    @property
    def data_tag(self) -> bytes:
        """Return the five bytes that begin a DATA datagram."""
        return b"DATA*" if self.major >= 11 else b"DATA@"

    @property
    def beacon_minor(self) -> int:
        """Return the beacon's minor version."""
        return 2 if self.version >= 115_000 else 1


def rref_replies(pairs: Sequence[tuple[int, float]], dialect: Dialect) -> list[bytes]:
    """Return the datagrams that answer subscriptions, at most 183 pairs in each."""
    return [
        dialect.rref_tag + b"".join(_PAIR.pack(*pair) for pair in pairs[first : first + MAX_PAIRS])
        for first in range(0, len(pairs), MAX_PAIRS)
    ]


@dataclass(frozen=True)
class Position:
    """The content of RPOS, in the order and the units of the protocol."""

    longitude_deg: float
    latitude_deg: float
    elevation_m: float
    height_m: float
    """Above the ground."""
    pitch_deg: float
    heading_deg: float
    """True."""
    roll_deg: float
    east_mps: float
    up_mps: float
    south_mps: float
    roll_radps: float
    pitch_radps: float
    yaw_radps: float


def rpos_reply(position: Position) -> bytes:
    """Return the 69 bytes that answer RPOS."""
    return b"RPOS4" + _POSITION.pack(*vars(position).values())


def data_rows(rows: Iterable[tuple[int, Sequence[float]]], dialect: Dialect) -> bytes:
    """Return a DATA datagram of rows of eight values."""
    return dialect.data_tag + b"".join(_ROW.pack(row, *values) for row, values in rows)


def beacon(dialect: Dialect, port: int, computer_name: str) -> bytes:
    """Return the beacon of an X-Plane that is master and listens on `port`."""
    host_is_xplane, role_is_master = 1, 1
    fields = _BEACON.pack(
        1, dialect.beacon_minor, host_is_xplane, dialect.version, role_is_master, port
    )
    return b"BECN\0" + fields + computer_name.encode("ascii", "replace") + b"\0"
