"""Recordings read by another program: PyPI's `mcap`, with decoded protobuf."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mcap.exceptions import EndOfFile
from mcap.reader import make_reader
from mcap.records import Channel, McapRecord, Message, Schema
from mcap.stream_reader import StreamReader
from mcap_protobuf.decoder import DecoderFactory

RECORD = "/fcc/record"
EVENT = "/fcc/event"


@dataclass(frozen=True)
class Seen:
    """A message of a recording."""

    topic: str
    log_time_ns: int
    data: bytes
    """As it is in the file."""
    content: Any
    """Decoded."""


def only_recording(folder: Path) -> Path:
    """Return the one recording in a folder."""
    files = list(folder.glob("*.mcap"))
    assert len(files) == 1, files
    return files[0]


def by_index(path: Path) -> list[Seen]:
    """Read a whole recording as most programs do: by its index, in log-time order."""
    with path.open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True, decoder_factories=[DecoderFactory()])
        return [
            Seen(channel.topic, message.log_time, message.data, content)
            for _, channel, message, content in reader.iter_decoded_messages()
        ]


def in_sequence(path: Path) -> list[Seen]:
    """Read a recording from its first byte to its last, cut off or not."""
    decoders = DecoderFactory()
    schemas: dict[int, Schema] = {}
    channels: dict[int, Channel] = {}
    seen = []
    with path.open("rb") as stream:
        for record in _until_cut(StreamReader(stream, validate_crcs=True)):
            if isinstance(record, Schema):
                schemas[record.id] = record
            elif isinstance(record, Channel):
                channels[record.id] = record
            elif isinstance(record, Message):
                channel = channels[record.channel_id]
                decode = decoders.decoder_for(channel.message_encoding, schemas[channel.schema_id])
                assert decode is not None
                content = decode(record.data)
                seen.append(Seen(channel.topic, record.log_time, record.data, content))
    return seen


def _until_cut(reader: StreamReader) -> Iterator[McapRecord]:
    try:
        yield from reader.records
    except EndOfFile:
        return


def ticks(messages: list[Seen]) -> list[int]:
    """Return the numbers of the ticks recorded."""
    return [message.content.tick.number for message in messages if message.topic == RECORD]


def assert_all_recorded(flown: list[Any]) -> None:
    """Assert that no tick between the first record and the last is lost.

    A busy machine makes the loop miss some; the next says how many.
    """
    assert flown[0].tick.number == 1 + flown[0].tick.missed
    for record, following in itertools.pairwise(flown):
        assert following.tick.number == record.tick.number + 1 + following.tick.missed


def is_in_log_time_order(messages: list[Seen]) -> bool:
    """Return whether the messages are in order of log time."""
    times = [message.log_time_ns for message in messages]
    return times == sorted(times)


def metadata(path: Path) -> dict[str, dict[str, str]]:
    """Return the metadata records of a whole recording by their names."""
    with path.open("rb") as stream:
        reader = make_reader(stream)
        return {record.name: dict(record.metadata) for record in reader.iter_metadata()}


def attachments(path: Path) -> dict[str, bytes]:
    """Return the attachments of a whole recording by their names."""
    with path.open("rb") as stream:
        return {found.name: found.data for found in make_reader(stream).iter_attachments()}
