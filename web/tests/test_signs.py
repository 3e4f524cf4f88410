"""The displays show the attitude and the heading as they are, against a drawn reference.

The reference is drawn here from what a window shows: a direction is in the sky if it is above
the horizon. It shares no code with the page.
"""

from __future__ import annotations

import math
import re
from itertools import pairwise

import pytest
from ground_station import waited
from playwright.sync_api import Page

from air import Air, Visit
from test_numbers import recorded, seek

# Around the horizon: the tapes left and right, the heading below, and degrees over the height.
TAPE_PX, HEADING_PX, SHOWN_DEG = 72, 50, 44.0
# Beside the symbols and scales, as parts of the width and height from the middle.
ACROSS = (-0.48, -0.45, -0.42, 0.42, 0.45, 0.48)
DOWN = [step / 20 - 0.45 for step in range(18)]
# Nearer to the horizon than this, it is its line.
LINE_DEG = 1.5


def reference(pitch_rad: float, roll_rad: float, wide: float) -> list[str | None]:
    """Return where there is sky or ground; None near the horizon. `wide`: width over height."""
    drawn: list[str | None] = []
    for x in ACROSS:
        for y in DOWN:
            right, up = x * wide * SHOWN_DEG, -y * SHOWN_DEG
            # With the right wing down, what is to the right of the nose is lower.
            above = math.degrees(pitch_rad) + up * math.cos(roll_rad) - right * math.sin(roll_rad)
            drawn.append(None if abs(above) < LINE_DEG else "sky" if above > 0 else "ground")
    return drawn


def shown(page: Page) -> tuple[list[str | None], float]:
    """Return what the display has at these places; None where it is a symbol; and its form."""
    pixels, wide = page.evaluate(
        """async ([across, down, tape, heading]) => {
            await new Promise(requestAnimationFrame);
            await new Promise(requestAnimationFrame);
            const canvas = document.querySelector('.pfd-canvas');
            const ratio = canvas.width / canvas.clientWidth;
            const width = canvas.clientWidth - 2 * tape, height = canvas.clientHeight - heading;
            const context = canvas.getContext('2d');
            const at = (x, y) => [...context.getImageData(
                (tape + (0.5 + x) * width) * ratio, (0.5 + y) * height * ratio, 1, 1).data];
            return [across.flatMap(x => down.map(y => at(x, y))), width / height];
        }""",
        [ACROSS, DOWN, TAPE_PX, HEADING_PX],
    )

    def kind(red: int, _green: int, blue: int, _alpha: int) -> str | None:
        return "sky" if blue - red > 40 else "ground" if red - blue > 20 else None

    return [kind(*pixel) for pixel in pixels], wide


def assert_shown(page: Page, pitch_rad: float, roll_rad: float) -> None:
    found, wide = shown(page)
    wanted = reference(pitch_rad, roll_rad, wide)
    both = [pair for pair in zip(found, wanted, strict=True) if None not in pair]
    assert len(both) > 0.6 * len(wanted)
    assert [pair for pair in both if pair[0] != pair[1]] == []


def on_screen(page: Page) -> float:
    """Return where the aircraft's nose points on the map, clockwise from up, in degrees."""
    nose, tail = page.evaluate(
        """() => {
            const symbol = document.querySelector('.aircraft:not(.second) polygon');
            const to = symbol.getScreenCTM();
            return [[0, -17], [0, 15]].map(([x, y]) => new DOMPoint(x, y).matrixTransform(to))
                .map(({x, y}) => [x, y]);
        }"""
    )
    return math.degrees(math.atan2(nose[0] - tail[0], tail[1] - nose[1])) % 360


def test_each_attitude_of_a_flight_is_drawn_as_in_the_reference(cruise: Air, visit: Visit) -> None:
    file = cruise.landed()
    rows = recorded(cruise, file)
    page = visit(cruise.station).open(f"flights/{file}")
    page.wait_for_selector(".plot canvas")
    # Steady ones: the replay shows a moment near by.
    steady = [
        one
        for one, later in pairwise(rows[::8])
        if all(abs(one[name] - later[name]) < 0.02 for name in (PITCH, ROLL))
    ]
    banks = sorted(steady, key=lambda one: one[ROLL])
    pitches = sorted(steady, key=lambda one: one[PITCH])
    chosen = [banks[0], banks[-1], pitches[0], pitches[-1], steady[len(steady) // 2]]
    assert banks[0][ROLL] < math.radians(-15) < math.radians(15) < banks[-1][ROLL]
    assert pitches[-1][PITCH] > math.radians(5)
    for one in chosen:
        seek(page, one["time_s"])
        assert_shown(page, one[PITCH], one[ROLL])


PITCH, ROLL, HEADING = "estimated_pitch_rad", "estimated_roll_rad", "estimated_heading_rad"


def test_the_aircraft_on_the_map_points_to_its_heading(cruise: Air, visit: Visit) -> None:
    file = cruise.landed()
    rows = recorded(cruise, file)
    page = visit(cruise.station).open(f"flights/{file}")
    page.wait_for_selector(".plot canvas")
    flown = [one for one in rows if one["estimated_airspeed_mps"] > 30]
    for wanted in (0, 90, 180, 270):
        one = min(flown, key=lambda row: off(math.degrees(row[HEADING]), wanted))
        assert off(math.degrees(one[HEADING]), wanted) < 10
        seek(page, one["time_s"])
        assert off(on_screen(page), math.degrees(one[HEADING])) < 4


def off(one_deg: float, other_deg: float) -> float:
    return abs((one_deg - other_deg + 180) % 360 - 180)


@pytest.mark.parametrize(("to_deg", "sign"), [(90, 1), (270, -1)])
def test_a_turn_is_seen_on_the_side_to_which_it_is_flown(
    air: Air, visit: Visit, to_deg: int, sign: int
) -> None:
    """Commanded to the right, `fccd top` and the display bank to the right, and the other way."""
    air.station.carried_out("engage")
    page = visit(air.station).open()
    page.wait_for_selector(".readout dd:text-is('engaged')")
    heading = {"set": {"heading_rad": math.radians(to_deg)}}
    assert air.station.command(heading)[0] == 200
    bank = waited("the bank", lambda: banked(air, sign))
    found, wide = shown(page)
    # Far from the horizon: the aircraft moves meanwhile.
    wanted = reference(0.0, math.radians(bank), wide)
    both = [pair for pair in zip(found, wanted, strict=True) if None not in pair]
    assert sum(one == other for one, other in both) > 0.9 * len(both)
    label = ".pfd-canvas[aria-label*='heading']"
    text = waited("the text", lambda: bank_in(page.get_attribute(label, "aria-label")))
    assert sign * text > 5
    waited("the turn", lambda: off(on_screen(page), to_deg) < 10)
    assert off(air.station.tick()["actual"]["heading_deg"], to_deg) < 15


def banked(air: Air, sign: int) -> float | None:
    bank = float(air.station.tick()["actual"]["bank_deg"])
    return bank if sign * bank > 15 else None


def bank_in(text: str | None) -> float | None:
    """Return the bank in the text for screen readers, which changes every two seconds."""
    found = re.search(r"bank (\S+)°", text or "")
    bank = float(found[1].replace("\u2212", "-")) if found else 0.0
    return bank if abs(bank) > 5 else None
