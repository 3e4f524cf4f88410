"""Commands from the page: only what is meant is sent, once and in time, and the daemon obeys."""

from __future__ import annotations

import json
import time

import pytest
from playwright.sync_api import Page, Route

from air import Air, Visit


def said(page: Page, text: str) -> None:
    page.wait_for_function(
        "text => document.querySelector('.commands .result').textContent.includes(text)", arg=text
    )


def slide(page: Page, part: float) -> None:
    """Draw the thumb over a part of its way."""
    box = page.locator(".slide").bounding_box()
    assert box is not None
    y = box["y"] + box["height"] / 2
    page.mouse.move(box["x"] + 20, y)
    page.mouse.down()
    page.mouse.move(box["x"] + 20 + part * (box["width"] - 24), y, steps=8)
    page.mouse.up()


def ready(air: Air, visit: Visit) -> Page:
    page = visit(air.station).open()
    page.wait_for_selector(".slide[aria-disabled=false]")
    return page


def test_a_slide_engages_and_disengages_and_half_of_it_does_not(air: Air, visit: Visit) -> None:
    page = ready(air, visit)
    page.locator(".slide").click()
    slide(page, 0.6)
    page.locator(".slide").focus()
    page.keyboard.press("Enter")
    # Had one of them been sent, the page would say so.
    assert page.locator(".commands .result").inner_text() == ""
    assert air.station.tick()["state"] == "standby"
    slide(page, 1.0)
    said(page, "engage: carried out at tick")
    assert air.station.tick()["state"] == "engaged"
    page.wait_for_selector(".readout dd:text-is('engaged')")
    slide(page, 1.0)
    said(page, "disengage: carried out")
    assert air.station.tick()["state"] == "standby"


def test_a_command_that_the_network_delays_is_refused(air: Air, visit: Visit) -> None:
    page = ready(air, visit)
    held: list[Route] = []

    def hold(route: Route) -> None:
        held.append(route)

    page.route("**/command", hold)
    with page.expect_request("**/command") as asked:
        slide(page, 1.0)
    deadline_s = json.loads(asked.value.post_data or "")["deadline_ms_utc"] / 1000
    page.wait_for_timeout(max(0.0, deadline_s - time.time()) * 1000 + 100)
    held[0].continue_()
    said(page, "engage refused")
    assert "after its deadline" in page.locator(".commands .result").inner_text()
    assert air.station.tick()["state"] == "standby"


def test_a_command_that_is_sent_again_is_refused(air: Air, visit: Visit) -> None:
    page = ready(air, visit)
    with page.expect_request("**/command") as asked:
        slide(page, 1.0)
    said(page, "engage: carried out")
    assert air.station.command("disengage")[0] == 200
    again = page.request.post(
        asked.value.url,
        data=asked.value.post_data,
        headers={**asked.value.headers, "content-type": "application/json"},
    )
    assert again.status == 409
    assert "used before" in again.json()["refused"]
    assert air.station.tick()["state"] == "standby"


def test_set_points_are_changed_within_their_limits(air: Air, visit: Visit) -> None:
    air.station.carried_out("engage")
    page = visit(air.station).open()
    page.get_by_role("button", name="ft", exact=True).click()
    page.get_by_label("New altitude (pressure)").fill("3300")
    page.get_by_label("New heading (mag)").fill("045")
    page.get_by_label("New heading (mag)").press("Enter")
    said(page, "set points: carried out")
    points = air.station.tick()["setpoints"]
    assert points["altitude_ft"] == pytest.approx(3300)
    assert points["heading_deg"] == pytest.approx(45)
    cell = ".set-points tr:has-text('{}') .set:text-is('{}')"
    page.wait_for_selector(cell.format("Altitude", "3300"))
    page.wait_for_selector(cell.format("Heading", "045"))
    # Nothing is sent that is beyond the limits: the field says why.
    speed = page.get_by_label("New airspeed")
    speed.fill("900")
    speed.press("Enter")
    # It is emptied when it is sent.
    assert speed.input_value() == "900"
    assert air.station.tick()["setpoints"]["airspeed_kt"] == pytest.approx(points["airspeed_kt"])


def test_who_has_no_token_watches_and_commands_nothing(air: Air, visit: Visit) -> None:
    page = visit(air.station, token=False).open()
    assert page.locator(".slide").is_disabled()
    assert page.locator(".viewer").is_visible()
    for name in ("Pause", "Go to…", "Return", "Land"):
        assert page.get_by_role("button", name=name, exact=True).is_disabled()
    # Even if somebody enables it.
    body = {**air.station.order(), "command": "engage"}
    answer = page.request.post(
        f"{air.station.address}/api/live/{air.station.instance}/command", data=body
    )
    assert answer.status == 401
    assert air.station.tick()["state"] == "standby"
    # Set points have no field, and a draft no tool, that would be refused.
    air.station.carried_out("engage")
    page.wait_for_selector(".readout:has-text('engaged')")
    page.wait_for_selector(".set-points tr:has-text('Airspeed') .set:not(:text-is('\u2013'))")
    assert page.locator(".set-points").locator("input:visible, button:visible").count() == 0
    page.goto(f"{air.station.address}/#/plan")
    page.wait_for_selector(".save-state:text-is('View only')")
    for name in (
        "New draft",
        "Delete draft",
        "Import",
        "Copy draft",
        "Upload to vehicle",
        "Waypoint",
    ):
        assert page.get_by_role("button", name=name, exact=True).is_disabled()


def test_the_token_leaves_the_address(air: Air, visit: Visit) -> None:
    visitor = visit(air.station)
    page = visitor.open()
    assert "token" not in page.url
    assert all(air.station.token not in url for url in visitor.requests)
    kept = page.evaluate("JSON.stringify([localStorage, document.cookie, document.title])")
    assert air.station.token not in kept
    history = page.context.new_cdp_session(page).send("Page.getNavigationHistory")
    assert [one for one in history["entries"] if air.station.token in one["url"]] == []
