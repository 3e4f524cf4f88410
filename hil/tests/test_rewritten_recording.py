"""Recordings that other programs have copied: what is read does not depend on how they write."""

from __future__ import annotations

import io
import json
import os
import random
import subprocess
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import fcc
import pytest
from mcap.reader import make_reader
from mcap.records import Attachment, Channel, Message, Metadata, Schema
from mcap.writer import CompressionType, IndexType, Writer
from recordings import RECORD, only_recording

SUCCESS = 0
USAGE = 2
NOT_REPLAYED = 8
INCOMPLETE = 13

TOOL = os.environ.get("MCAP_TOOL", "")
"""MCAP's command line tool, if it is installed."""

FLIGHTS = int(os.environ.get("MCAP_FLIGHTS", "1"))
"""How many flights go through it."""

Seen = tuple[Schema, Channel, Message]


@dataclass(frozen=True)
class Content:
    """All of a file."""

    profile: str
    attachments: list[Attachment]
    metadata: list[Metadata]
    messages: list[Seen]

    @classmethod
    def of(cls, path: Path) -> Content:
        with path.open("rb") as stream:
            reader = make_reader(stream)
            return cls(
                reader.get_header().profile,
                list(reader.iter_attachments()),
                list(reader.iter_metadata()),
                [(schema, of, sent) for schema, of, sent in reader.iter_messages() if schema],
            )


def as_they_are(messages: list[Seen]) -> list[Seen]:
    return messages


def by_topic(messages: list[Seen]) -> list[Seen]:
    """As the names sort, each topic as a whole: events before records."""
    return sorted(messages, key=lambda seen: seen[1].topic)


def backwards(messages: list[Seen]) -> list[Seen]:
    return messages[::-1]


def shuffled(messages: list[Seen]) -> list[Seen]:
    return random.Random(41).sample(messages, len(messages))


@dataclass(frozen=True)
class Way:
    """A way to write a file."""

    order: Callable[[list[Seen]], list[Seen]] = as_they_are
    options: dict[str, Any] = field(default_factory=dict)
    shuffles_numbers: bool = False
    is_about_last: bool = False
    keeps_sequence: bool = True
    keeps_profile: bool = True


WITHOUT_SUMMARY = {
    "index_types": IndexType.NONE,
    "use_statistics": False,
    "use_summary_offsets": False,
    "repeat_channels": False,
    "repeat_schemas": False,
}

WAYS = {
    "as they come": Way(),
    "numbers shuffled": Way(shuffles_numbers=True),
    "attachments last": Way(is_about_last=True),
    "not in chunks": Way(options={"use_chunking": False, "enable_data_crcs": True}),
    "not in chunks, attachments last": Way(options={"use_chunking": False}, is_about_last=True),
    "lz4": Way(options={"compression": CompressionType.LZ4}),
    "not compressed": Way(options={"compression": CompressionType.NONE}),
    "small chunks": Way(options={"chunk_size": 1}, shuffles_numbers=True),
    "one chunk": Way(options={"chunk_size": 1 << 30}, is_about_last=True),
    "by topic": Way(by_topic, shuffles_numbers=True),
    "by topic, in small chunks": Way(by_topic, {"chunk_size": 10_000}, is_about_last=True),
    "by topic, without sequence": Way(by_topic, keeps_sequence=False),
    "in order, without sequence": Way(keeps_sequence=False),
    "backwards": Way(backwards, is_about_last=True),
    "shuffled": Way(shuffled, {"compression": CompressionType.LZ4}, shuffles_numbers=True),
    "without a summary": Way(options=WITHOUT_SUMMARY, is_about_last=True, shuffles_numbers=True),
    "without checksums": Way(options={"enable_crcs": False}),
    "without profile": Way(keeps_profile=False, is_about_last=True),
    "all at once": Way(
        shuffled, {"use_chunking": False, **WITHOUT_SUMMARY}, True, True, True, False
    ),
}


def write(path: Path, content: Content, way: Way) -> None:
    """Write a file in a way."""
    with path.open("wb") as stream:
        _write(stream, content, way)


def _write(stream: io.BufferedWriter, content: Content, way: Way) -> None:
    writer = Writer(stream, **way.options)
    writer.start(profile=content.profile if way.keeps_profile else "", library="a test")

    def about() -> None:
        for record in content.metadata:
            writer.add_metadata(record.name, record.metadata)
        for one in content.attachments:
            writer.add_attachment(one.create_time, one.log_time, one.name, one.media_type, one.data)

    if not way.is_about_last:
        about()
    messages = way.order(content.messages)
    declared = {channel.id: (schema, channel) for schema, channel, _ in messages}
    order = list(declared)
    if way.shuffles_numbers:
        writer.register_channel("/of/another", "json", writer.register_schema("", "", b""))
        random.Random(5).shuffle(order)
    numbers = {}
    for number in order:
        schema, channel = declared[number]
        numbers[number] = writer.register_channel(
            channel.topic,
            channel.message_encoding,
            writer.register_schema(schema.name, schema.encoding, schema.data),
            channel.metadata,
        )
    for _, channel, message in messages:
        writer.add_message(
            numbers[channel.id],
            message.log_time,
            message.data,
            message.publish_time,
            message.sequence if way.keeps_sequence else 0,
        )
    if way.is_about_last:
        about()
    writer.finish()  # type: ignore[no-untyped-call]


def fccd_json(fccd: Path, *words: str | Path, exit_code: int = SUCCESS) -> dict[str, Any]:
    done = subprocess.run([fccd, *words, "--json"], capture_output=True, text=True, check=False)
    assert done.returncode == exit_code, done.stderr or done.stdout
    found = json.loads(done.stdout)
    assert isinstance(found, dict)
    return found


def fly(fccd: Path, folder: Path, seconds: int = 12, begin: int = 2) -> Path:
    """Fly in lockstep: engaged, and with a pattern's changes."""
    config = folder / "c.toml"
    folder.mkdir(exist_ok=True)
    config.write_text(
        f"[built-in]\nengage_at_s = {begin}\n[guidance]\nmode = 'timed-pattern'\nhold_s = 2.0\n"
        "leg_s = 3.0\n"
    )
    words: list[str | Path] = ["fly", "--config", config, "--lockstep", "--quiet"]
    words += ["--recordings", folder / "recordings", "--seconds", str(seconds)]
    fccd_json(fccd, *words)
    return only_recording(folder / "recordings")


def assert_the_same(fccd: Path, copy: Path, flown: dict[str, Any], ticks: int) -> None:
    """Assert that a copy is read, and replayed, as the recording."""
    report = fccd_json(fccd, "report", copy)
    assert report["damages"] == []
    assert report["continuity"]["ticks"] == ticks
    assert report["continuity"]["out_of_order"] == 0
    again = fccd_json(fccd, "replay", copy)
    assert again["identity"]["differing"] == 0
    assert again["identity"]["outputs"] == flown["identity"]["outputs"]
    assert again["unflown"] is None


@pytest.fixture(scope="module")
def flight(fccd: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return fly(fccd, tmp_path_factory.mktemp("flight"))


@pytest.mark.parametrize("way", WAYS.values(), ids=WAYS.keys())
def test_a_copy_is_read_as_the_recording(
    fccd: Path, flight: Path, tmp_path: Path, way: Way
) -> None:
    copy = tmp_path / "copy.mcap"
    write(copy, Content.of(flight), way)
    original = fcc.Recording(str(flight))
    recording = fcc.Recording(str(copy))
    assert recording.records.tobytes() == original.records.tobytes()
    assert [str(event) for event in recording.events] == [str(event) for event in original.events]
    assert recording.about == original.about
    assert recording.account() == original.account()
    assert recording.damages == []
    flown = fccd_json(fccd, "replay", flight)
    assert_the_same(fccd, copy, flown, len(original))


def merged(path: Path, *contents: Content) -> Path:
    """Write the content of several files into one, each as a whole."""
    together = Content(
        contents[0].profile,
        [one for content in contents for one in content.attachments],
        [one for content in contents for one in content.metadata],
        [one for content in contents for one in content.messages],
    )
    write(path, together, Way(is_about_last=True))
    return path


def test_the_parts_of_a_recording_merged_into_a_file_are_read_as_one(
    fccd: Path, tmp_path: Path
) -> None:
    config = tmp_path / "c.toml"
    config.write_text("[built-in]\nengage_at_s = 1.5\n[recording]\nmax_file_minutes = 1\n")
    words: list[str | Path] = ["fly", "--config", config, "--lockstep", "--seconds", "70"]
    flown = fccd_json(fccd, *words, "--recordings", tmp_path)
    parts = [Path(file) for file in flown["recording"]["files"]]
    assert len(parts) == 2
    path = merged(tmp_path / "merged.mcap", *map(Content.of, parts))
    expected = fccd_json(fccd, "replay", *parts)
    assert_the_same(fccd, path, expected, flown["timing"]["ticks"])


def test_a_recording_merged_with_a_copy_of_itself_is_read_once(
    fccd: Path, flight: Path, tmp_path: Path
) -> None:
    content = Content.of(flight)
    path = merged(tmp_path / "merged.mcap", content, content)
    flown = fccd_json(fccd, "replay", flight)
    assert_the_same(fccd, path, flown, flown["ticks"])


def test_two_flights_merged_into_a_file_are_refused_with_what_to_do(
    fccd: Path, flight: Path, tmp_path: Path
) -> None:
    other = fly(fccd, tmp_path / "other", seconds=3)
    path = merged(tmp_path / "merged.mcap", Content.of(flight), Content.of(other))
    for command in ("report", "replay"):
        done = subprocess.run([fccd, command, path], capture_output=True, text=True, check=False)
        assert done.returncode == USAGE
        assert "several recordings are merged in it" in done.stderr
        assert "read the files that it was made of" in done.stderr


def test_a_copy_without_its_attachments_is_reported_and_says_what_a_replay_needs(
    fccd: Path, flight: Path, tmp_path: Path
) -> None:
    content = Content.of(flight)
    path = tmp_path / "bare.mcap"
    write(path, Content(content.profile, [], [], content.messages), Way())
    assert fccd_json(fccd, "report", path)["damages"] == []
    done = subprocess.run([fccd, "replay", path], capture_output=True, text=True, check=False)
    assert done.returncode == NOT_REPLAYED
    assert "contains no configuration" in done.stderr
    assert "copy it with its attachments and metadata" in done.stderr


def test_of_a_copy_of_a_part_its_own_ticks_are_listed(
    fccd: Path, flight: Path, tmp_path: Path
) -> None:
    content = Content.of(flight)
    some = content.messages[len(content.messages) // 2 :]
    path = tmp_path / "part.mcap"
    write(path, Content(content.profile, content.attachments, content.metadata, some), Way())
    done = subprocess.run([fccd, "list", tmp_path, "--json"], capture_output=True, check=False)
    assert done.returncode == INCOMPLETE
    (listed,) = json.loads(done.stdout)
    assert listed["ticks"] == sum(channel.topic == RECORD for _, channel, _ in some)
    assert listed["file"] == "cut"
    late = fccd_json(fccd, "replay", path, exit_code=NOT_REPLAYED)
    assert "the recording begins in tick" in late["unflown"]["why"]


@pytest.mark.parametrize(
    ("keeps", "missing"),
    [
        (lambda at, _: at < 0.5, "ticks"),
        (lambda _, topic: topic == RECORD, "events"),
    ],
    ids=["its beginning", "its records"],
)
def test_of_a_copy_of_a_part_it_is_said_what_was_left_out(
    fccd: Path, flight: Path, tmp_path: Path, keeps: Callable[[float, str], bool], missing: str
) -> None:
    content = Content.of(flight)
    count = len(content.messages)
    some = [
        seen for number, seen in enumerate(content.messages) if keeps(number / count, seen[1].topic)
    ]
    path = tmp_path / "part.mcap"
    write(path, Content(content.profile, content.attachments, content.metadata, some), Way())
    report = fccd_json(fccd, "report", path, exit_code=INCOMPLETE)
    assert missing in report["end"]["words"]
    assert "copied without" in report["end"]["words"]
    replayed = subprocess.run([fccd, "replay", path], capture_output=True, text=True, check=False)
    assert replayed.returncode == NOT_REPLAYED
    assert "copied without" in replayed.stdout + replayed.stderr


def test_a_damaged_copy_loses_its_chunk_and_is_recovered(
    fccd: Path, flight: Path, tmp_path: Path
) -> None:
    path = tmp_path / "copy.mcap"
    write(path, Content.of(flight), Way(options={"chunk_size": 50_000}, shuffles_numbers=True))
    with path.open("rb") as stream:
        summary = make_reader(stream).get_summary()
    assert summary
    damaged = bytearray(path.read_bytes())
    chunk = summary.chunk_indexes[3]
    end = chunk.chunk_start_offset + chunk.chunk_length
    damaged[end - 200 : end - 100] = bytes(100)
    path.write_bytes(damaged)
    recovered = fccd_json(fccd, "recover", path, exit_code=INCOMPLETE)
    (damage,) = recovered["damages"]
    report = fccd_json(fccd, "report", path)
    assert report["damages"] == []
    assert report["continuity"]["lost"] == damage["ticks"] > 10
    gap = f"ticks {damage['first_tick']} to {damage['last_tick']}"
    assert any(gap in event["text"] for event in report["events"])


TOOLS: dict[str, list[str]] = {
    "filter": ["--include-metadata", "--include-attachments", "-o"],
    "merge": ["-o"],
    "sort": ["-o"],
    "compress": ["--compression=lz4", "-o"],
    "decompress": ["-o"],
    "recover": ["-o"],
}


@pytest.mark.skipif(not TOOL, reason="MCAP_TOOL does not name MCAP's command line tool")
def test_flights_that_went_through_mcap_tools_are_replayed_alike(
    fccd: Path, tmp_path: Path
) -> None:
    for number in range(FLIGHTS):
        folder = tmp_path / str(number)
        path = fly(fccd, folder, seconds=8 + number % 20, begin=2 + number % 7)
        flown = fccd_json(fccd, "replay", path)
        for tool, words in TOOLS.items():
            copy = folder / f"{tool}.mcap"
            subprocess.run([TOOL, tool, path, *words, copy], check=True, capture_output=True)
            assert_the_same(fccd, copy, flown, flown["ticks"])
            copy.unlink()
