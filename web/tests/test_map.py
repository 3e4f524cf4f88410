"""The user's own map lies over the coast lines, and under what is drawn."""

from __future__ import annotations

import io
import struct
from pathlib import Path

from PIL import Image

from air import Air, Visit

RED = (200, 30, 40)
ZOOM = 13


def varint(value: int) -> bytes:
    parts = []
    while value > 0x7F:
        parts.append(value & 0x7F | 0x80)
        value >>= 7
    return bytes([*parts, value])


def write_raster_map(path: Path) -> None:
    """Write every tile of one zoom as the same PNG.

    As PMTiles version 3 says (github.com/protomaps/PMTiles, spec/v3): a header of 127 bytes, a
    directory of one entry whose run length is all tiles, metadata, data; nothing compressed.
    """
    picture = io.BytesIO()
    Image.new("RGB", (256, 256), RED).save(picture, "PNG")
    tile, metadata = picture.getvalue(), b"{}"
    first = (4**ZOOM - 1) // 3
    directory = b"".join(varint(one) for one in (1, first, 4**ZOOM, len(tile), 1))
    places = [(127, len(directory)), (127 + len(directory), len(metadata)), (0, 0)]
    places.append((127 + len(directory) + len(metadata), len(tile)))
    header = b"PMTiles\x03" + b"".join(struct.pack("<QQ", *place) for place in places)
    header += struct.pack("<QQQ", 4**ZOOM, 1, 1)
    none, png = 1, 2
    header += bytes([1, none, none, png, ZOOM, ZOOM])
    header += struct.pack("<iiii", -1_800_000_000, -850_000_000, 1_800_000_000, 850_000_000)
    header += struct.pack("<Bii", ZOOM, 0, 0)
    assert len(header) == 127
    path.write_bytes(header + directory + metadata + tile)


def test_a_map_of_pictures_is_shown_over_the_coast_lines(air: Air, visit: Visit) -> None:
    file = air.folder / "red.pmtiles"
    write_raster_map(file)
    air.station.kill()
    air.station.words += ["--map", str(file), "--map-attribution", "A red world"]
    air.station.start_again()
    page = visit(air.station).open("fly")
    page.get_by_text("A red world").wait_for()
    page.wait_for_function("() => document.querySelectorAll('.leaflet-tile-loaded').length > 4")
    shown = page.locator(".fly-map .leaflet-container")
    # Until the last tile has faded in.
    page.wait_for_timeout(500)
    picture = Image.open(io.BytesIO(shown.screenshot())).convert("RGB")
    red = sum(count for count, colour in picture.getcolors(1 << 20) or [] if colour == RED)
    assert red > 0.7 * picture.width * picture.height
