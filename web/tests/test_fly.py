"""What every viewer of a flight sees: its track, its goal, and one system of units."""

from __future__ import annotations

from ground_station import waited
from playwright.sync_api import Page

from air import Air, Visit

TRACK = ".leaflet-shadow-pane path"


def extent_px(page: Page) -> float:
    """Return the longer side of what is drawn as the track."""
    page.wait_for_selector(TRACK, state="attached")
    return float(
        page.locator(TRACK).first.evaluate(
            "path => { const { width, height } = path.getBBox(); return Math.max(width, height); }"
        )
    )


def test_a_reload_and_another_viewer_have_the_track_so_far(air: Air, visit: Visit) -> None:
    air.station.carried_out("engage")
    visitor = visit(air.station)
    page = visitor.open()
    waited("a track of 50 px", lambda: extent_px(page) > 50)
    before = extent_px(page)
    page.reload()
    page.wait_for_selector(".link[data-state=fresh]")
    # Without what was flown before, it would begin at nothing.
    page.wait_for_timeout(500)
    assert extent_px(page) > 0.9 * before
    other = visit(air.station, token=False).open()
    waited("the same track", lambda: extent_px(other) > 0.9 * before)


def test_every_viewer_sees_where_it_is_sent_until_the_mode_ends(air: Air, visit: Visit) -> None:
    air.station.carried_out("engage")
    pages = [visit(air.station).open(), visit(air.station, token=False).open()]
    place = {"latitude_deg": 47.51, "longitude_deg": 8.53, "altitude_m": 900.0}
    for page in pages:
        assert page.locator(".point:text-is('Go to')").count() == 0
    air.station.carried_out({"go_to": place})
    for page in pages:
        page.wait_for_selector(".point:text-is('Go to')", state="attached")
    # Another command ends the mode, whoever gives it.
    air.station.carried_out("pause")
    for page in pages:
        page.wait_for_selector(".point:text-is('Go to')", state="detached")


def test_events_are_in_the_chosen_units(air: Air, visit: Visit) -> None:
    air.station.carried_out("engage")
    page = visit(air.station).open()
    air.station.carried_out({"set": {"altitude_m": 1005.84}})
    event = page.locator(".event-text", has_text="command: altitude").first
    event.wait_for()
    # 3300 ft are 1005.84 m.
    assert event.inner_text().endswith("altitude 1006\u202fm")
    page.get_by_role("button", name="ft", exact=True).click()
    assert event.inner_text().endswith("altitude 3300 ft")
