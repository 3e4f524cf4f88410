"""The page shows the numbers of the daemon, of `fccd top`, and of the recording."""

from __future__ import annotations

import csv
import io
import math
import urllib.request
from typing import Any

import pytest
from ground_station import waited
from playwright.sync_api import Page

from air import Air, Visit

M_FT = 1 / 0.3048
# Columns of a recording.
USED = [
    "time_s",
    "state",
    "desired_guidance_mode",
    "estimated_airspeed_mps",
    "estimated_heading_rad",
    "estimated_north_mps",
    "estimated_east_mps",
    "estimated_pitch_rad",
    "estimated_roll_rad",
]
# Of a row of set points: its key in `fccd top --json`, how much it may move meanwhile.
ROWS = {
    "Airspeed": ("airspeed_kt", 3.0),
    "Heading": ("heading_deg", 3.0),
    "Altitude": ("altitude_ft", 30.0),
}


def number(text: str) -> float:
    """Return what is shown; NaN for the dash of a value that is not known yet."""
    return math.nan if text == "\u2013" else float(text.replace("\u2212", "-"))


def row(page: Page, name: str) -> tuple[float, float]:
    cells = page.locator(f".set-points tr:has-text('{name}') td.number")
    return number(cells.nth(0).inner_text()), number(cells.nth(1).inner_text())


def away(one: float, other: float) -> float:
    """Return a difference; that of two headings the short way round."""
    return abs((one - other + 180) % 360 - 180) if max(one, other) <= 360 else abs(one - other)


def test_fly_shows_what_top_shows(cruise: Air, visit: Visit) -> None:
    page = visit(cruise.station).open()
    page.get_by_role("button", name="ft", exact=True).click()
    page.wait_for_selector(".set-points tr:has-text('Altitude') .unit:text-is('ft')")

    def differences() -> dict[str, tuple[float, float]]:
        tick = cruise.station.tick()
        found = {}
        for name, (key, near) in ROWS.items():
            actual, wanted = row(page, name)
            assert away(wanted, tick["setpoints"][key]) <= 0.51, (name, wanted, tick)
            if away(actual, tick["actual"][key]) > near:
                found[name] = (actual, tick["actual"][key])
        return found

    # Both are of a moment of their own.
    waited("the same numbers", lambda: not differences())
    page.get_by_role("button", name="m", exact=True).click()
    page.wait_for_selector(".set-points tr:has-text('Altitude') .unit:text-is('m')")
    feet = cruise.station.tick()["setpoints"]["altitude_ft"]
    assert row(page, "Altitude")[1] == pytest.approx(feet / M_FT, abs=0.51)


def recorded(air: Air, file: str) -> list[dict[str, float]]:
    """Return the ticks of a flight, as CSV gives them."""
    url = f"{air.station.address}/api/flights/{file}/download?format=csv"
    with urllib.request.urlopen(url) as answer:
        rows = csv.reader(io.TextIOWrapper(answer, encoding="utf-8"))
        names = next(rows)
        at = [(name, names.index(name)) for name in USED]
        return [{name: float(row[index]) for name, index in at} for row in rows]


def seek(page: Page, time_s: float) -> float:
    """Move the slider, and return where it is."""
    at: float = page.get_by_label("Time of the flight").evaluate(
        "(one, s) => { one.value = s; one.dispatchEvent(new Event('input')); return +one.value; }",
        time_s,
    )
    return at


def values(page: Page) -> dict[str, str]:
    return dict(
        page.evaluate(
            "() => [...document.querySelectorAll('.replay .readout')]"
            ".map(one => [...one.children].map(part => part.textContent))"
        )
    )


def test_a_replay_shows_the_recorded_numbers(cruise: Air, visit: Visit) -> None:
    file = cruise.landed()
    rows = recorded(cruise, file)
    page = visit(cruise.station).open(f"flights/{file}")
    page.wait_for_selector(".plot canvas")
    modes = columns(cruise)["desired_guidance_mode"]["names"]
    for part in (0.0, 0.2, 0.4, 0.6, 0.8, 0.95):
        at_s = seek(page, part * rows[-1]["time_s"])
        tick = min(rows, key=lambda one: abs(one["time_s"] - at_s))
        shown = values(page)
        assert shown["State"] == ("engaged" if tick["state"] == 1 else "standby"), part
        if tick["state"] == 1:
            assert shown["Mode"].split(",")[0] == modes[int(tick["desired_guidance_mode"])], part
        speed = math.hypot(tick["estimated_north_mps"], tick["estimated_east_mps"])
        assert number(shown["Ground speed"].split("\u202f")[0]) == pytest.approx(speed, abs=0.3)


def test_two_flights_are_compared_in_degrees(cruise: Air) -> None:
    file = cruise.landed()
    found = cruise.station.ask("GET", f"/api/flights/{file}/compare/{file}")[1]
    bank = next(one for one in found if one["what"] == "greatest bank")
    most = max(abs(math.degrees(tick["estimated_roll_rad"])) for tick in recorded(cruise, file))
    assert bank["unit"] == "degrees"
    assert bank["a"] == bank["b"] == pytest.approx(most, rel=1e-6)


def columns(air: Air) -> dict[str, Any]:
    found = air.station.ask("GET", f"/api/live/{air.station.instance}/columns")[1]["columns"]
    return {one["name"]: one for one in found}
