"""A plan drawn on the map is the plan that the vehicle has; no edit is lost."""

from __future__ import annotations

import json
import re
import subprocess
from pathlib import Path
from typing import Any

from ground_station import Station, waited
from playwright.sync_api import Page

from air import Air, Visit
from visitor import axe

HOSTILE = "<img src=x onerror=document.title='owned'>"
MANY = "n => document.querySelectorAll('.items tbody tr:not(.problem)').length === n"


def saved(page: Page, station: Station, name: str, holds: Any) -> Any:
    """Wait until the board has a draft that is as wanted, and return it."""
    page.wait_for_function(
        "() => document.querySelector('.save-state').textContent.startsWith('Saved')"
    )

    def found() -> Any:
        status, draft = station.ask("GET", f"/api/drafts/{name}")
        return draft if status == 200 and holds(draft["plan"]) else None

    return waited("the draft on the board", found)


def tap(page: Page, tool: str, right: float, down: float) -> None:
    """Tap the map with a tool, at parts of its size."""
    tools = page.get_by_role("group", name="What a tap on the map adds")
    tools.get_by_role("button", name=tool, exact=True).click()
    box = page.locator(".plan .chart-map").bounding_box()
    assert box is not None
    before = page.locator(".items tbody tr:not(.problem)").count()
    page.mouse.click(box["x"] + right * box["width"], box["y"] + down * box["height"])
    page.wait_for_function(MANY, arg=before + 1)


def draw(page: Page) -> None:
    tap(page, "Take-off", 0.5, 0.2)
    tap(page, "Waypoint", 0.8, 0.2)
    tap(page, "Waypoint", 0.8, 0.8)
    tap(page, "Loiter", 0.3, 0.8)
    page.get_by_label("Altitude of item 3, m").fill("260")
    page.keyboard.press("Tab")


def test_a_plan_drawn_by_taps_is_read_back_by_its_hash(
    ground: Station, visit: Visit, tmp_path: Path
) -> None:
    page = visit(ground).open("plan")
    draw(page)
    draft = saved(page, ground, "plan-1", lambda plan: altitudes(plan)[2:3] == [260])
    assert [item["kind"] for item in draft["plan"]["items"]] == [
        "takeoff",
        "waypoint",
        "waypoint",
        "loiter",
    ]
    # What is tapped at one height of the picture is at one latitude: the map has not moved.
    north = [item["place"]["latitude_deg"] for item in draft["plan"]["items"]]
    assert abs(north[0] - north[1]) < 1e-3 < north[1] - north[2]
    # Home is on the runway, as the vehicle's plan has it.
    drawn, flown = draft["plan"]["home"], ground.vehicle()["plan"]["home"]
    assert drawn["altitude_m"] == flown["altitude_m"]
    # Another program than the station computes the same hash of the exported file.
    with page.expect_download() as download:
        page.get_by_role("button", name="Export .plan").click()
    file = tmp_path / "drawn.plan"
    download.value.save_as(file)
    checked = subprocess.check_output([ground.fccd, "plan", "check", "--json", file])
    found = json.loads(checked)
    sha256 = (found[0] if isinstance(found, list) else found)["sha256"]
    assert sha256.startswith(draft["hash"])
    # Uploaded, the record of each tick has it, and the page says so.
    before = ground.vehicle()["hash"]
    page.locator("button:enabled", has_text="Upload to vehicle").click()
    page.wait_for_function(
        "hash => document.querySelector('.vehicle .result').textContent.includes(hash)",
        arg=f"read back: the vehicle has plan {draft['hash']}",
    )
    assert ground.vehicle()["hash"] == draft["hash"] != before
    assert ground.vehicle()["plan"] == draft["plan"]
    page.wait_for_selector('.differs:text-is("Draft is the vehicle\'s plan")')
    # An edit is an edit of the draft: the vehicle's plan stays, and both are shown.
    page.get_by_label("Altitude of item 3, m").fill("270")
    page.keyboard.press("Tab")
    page.wait_for_selector(".differs:text-is('Draft differs from vehicle')")
    assert ground.vehicle()["hash"] == draft["hash"]
    assert draft["hash"] in page.locator(".vehicle-text").inner_text()


def altitudes(plan: Any) -> list[float]:
    return [item["altitude"]["m"] for item in plan["items"]]


def test_a_reload_and_a_killed_station_lose_no_edit(air: Air, visit: Visit) -> None:
    station = air.station
    page = visit(station).open("plan")
    draw(page)
    # At once: the answer may not be there yet.
    page.reload()
    page.wait_for_function(MANY, arg=4)
    assert page.get_by_label("Altitude of item 3, m").input_value() == "260"
    saved(page, station, "plan-1", lambda plan: altitudes(plan)[2:3] == [260])
    station.kill()
    page.get_by_label("Altitude of item 3, m").fill("280")
    page.keyboard.press("Tab")
    page.wait_for_function(
        "() => document.querySelector('.save-state').textContent.startsWith('Not saved')"
    )
    station.start_again()
    saved(page, station, "plan-1", lambda plan: altitudes(plan)[2:3] == [280])
    page.reload()
    page.wait_for_function(MANY, arg=4)
    assert page.get_by_label("Altitude of item 3, m").input_value() == "280"
    # Each edit can be undone, and is saved as undone.
    for _ in range(3):
        page.keyboard.press("Control+z")


def test_two_pages_share_a_draft(air: Air, visit: Visit) -> None:
    visitor = visit(air.station)
    one = visitor.open("plan")
    draw(one)
    saved(one, air.station, "plan-1", lambda plan: altitudes(plan)[2:3] == [260])
    two = visitor.again()
    two.goto(f"{visitor.base}#/plan")
    two.wait_for_function(MANY, arg=4)
    two.get_by_label("Altitude of item 2, m").fill("333")
    two.keyboard.press("Tab")
    one.wait_for_function(
        "() => document.querySelector('[data-key=item-1-altitude]').value === '333'"
    )
    assert one.get_by_label("Altitude of item 3, m").input_value() == "260"


def test_a_table_drawn_anew_keeps_what_is_being_typed(air: Air, visit: Visit) -> None:
    """As by the edit of another page."""
    page = visit(air.station).open("plan")
    draw(page)
    page.get_by_label("Altitude of item 3, m").click()
    page.keyboard.press("Control+a")
    for digits, other in (("2", 310), ("71", 320)):
        page.keyboard.type(digits)
        draft = saved(page, air.station, "plan-1", lambda plan: altitudes(plan)[2:3] == [260])
        draft["plan"]["items"][1]["altitude"]["m"] = other
        edit = {"based_on": draft["revision"], "plan": draft["plan"]}
        air.station.ask("PUT", "/api/drafts/plan-1", edit)
        page.wait_for_function(
            "shown => document.querySelector('[data-key=item-1-altitude]').value === shown",
            arg=str(other),
        )
    page.keyboard.press("Enter")
    saved(page, air.station, "plan-1", lambda plan: altitudes(plan)[1:3] == [320, 271])


def test_a_plan_with_a_problem_is_not_uploaded(ground: Station, visit: Visit) -> None:
    page = visit(ground).open("plan")
    draw(page)
    before = ground.vehicle()["hash"]
    page.get_by_label("Altitude of item 3, m").fill("9000")
    page.keyboard.press("Tab")
    problem = page.locator("tr.problem.error").first
    problem.wait_for()
    assert (
        problem.evaluate(
            "row => row.previousElementSibling.querySelector('.item-number').textContent"
        )
        == "3"
    )
    assert page.get_by_role("button", name="Upload to vehicle").is_disabled()
    assert ground.vehicle()["hash"] == before


def test_a_plan_and_its_problems_are_seen_whole_on_a_phone(ground: Station, visit: Visit) -> None:
    page = visit(ground, "phone").open("plan")
    page.get_by_role("button", name="Copy into draft").click()
    page.wait_for_function(MANY, arg=9)
    saved(page, ground, "plan-1", lambda plan: len(plan["items"]) == 9)
    # A QGroundControl plan has its default cruise speed, and loiters of few metres.
    page.get_by_label("Action of item 4").select_option("loiter")
    page.get_by_label("Radius of item 4, m").fill("30")
    page.keyboard.press("Tab")
    problem = page.locator("tr.problem.error span").first
    problem.wait_for()
    text, table = problem.bounding_box(), page.locator(".tables").bounding_box()
    assert text is not None
    assert table is not None
    assert table["x"] <= text["x"]
    assert text["x"] + text["width"] <= table["x"] + table["width"]
    # As it is opened, no tool covers a point, and only the panels scroll.
    page.reload()
    page.wait_for_function(MANY, arg=9)
    page.wait_for_selector(".point:text-is('8')")
    # Points are drawn anew when the plan is checked.
    page.locator(".totals div", has_text="Problems").get_by_text("error").wait_for()
    tools = page.locator(".plan-tools").bounding_box()
    assert tools is not None
    for point in page.locator(".plan .point:visible").all():
        box = point.bounding_box()
        assert box is not None
        assert box["y"] >= tools["y"] + tools["height"]
    assert page.evaluate("document.documentElement.scrollHeight === innerHeight")


def test_a_refused_value_says_at_its_cell_how_to_mend_it(air: Air, visit: Visit) -> None:
    page = visit(air.station).open("plan")
    draw(page)
    holds = saved(page, air.station, "plan-1", lambda plan: altitudes(plan)[2:3] == [260])["plan"]
    field = page.get_by_label("Altitude of item 3, m")
    # A letter, nothing, and more than the table's 20,000 m.
    for typed in ("26o", "", "20001"):
        field.fill(typed)
        page.keyboard.press("Tab")
        # It stays as typed, also in the table that the focus of another row draws anew.
        page.get_by_label("Altitude of item 1, m").focus()
        page.wait_for_selector("tr.selected [data-key=item-0-altitude]")
        assert field.input_value() == typed
        assert field.get_attribute("aria-invalid") == "true"
        why = page.locator(f"#{field.get_attribute('aria-describedby')}")
        assert (typed or "Nothing") in why.inner_text()
        assert "The plan keeps 260" in why.inner_text()
        assert "Altitude of item 3" in page.locator(".plan-side > [role=status]").inner_text()
    assert "type -1000 m to 20000 m" in why.inner_text()
    assert axe(page) == []
    assert air.station.ask("GET", "/api/drafts/plan-1")[1]["plan"] == holds
    field.focus()
    page.keyboard.press("Escape")
    assert field.input_value() == "260"
    assert why.inner_text() == ""
    # A decimal comma is a point.
    field.fill("261,5")
    page.keyboard.press("Enter")
    saved(page, air.station, "plan-1", lambda plan: altitudes(plan)[2:3] == [261.5])


def test_markup_of_others_stays_text(air: Air, visit: Visit, tmp_path: Path) -> None:
    """In a recording's name, in the address, and in a file that is imported."""
    recordings = air.folder / "recordings"
    recordings.mkdir(exist_ok=True)
    (recordings / f"{HOSTILE}.mcap").write_bytes(b"no recording")
    visitor = visit(air.station)
    page = visitor.open("flights")
    page.get_by_text(HOSTILE, exact=False).first.wait_for()
    visitor.go(f"flights/{re.sub('/', '%2F', HOSTILE)}")
    page.get_by_text("there is no recording").first.wait_for()
    visitor.go("plan")
    file = tmp_path / f"{HOSTILE}.plan"
    file.write_text(HOSTILE)
    page.locator("input[type=file]").set_input_files(file)
    page.get_by_text("is not imported").first.wait_for()
    assert page.locator("main img, main script").count() == 0
    assert page.title() != "owned"
