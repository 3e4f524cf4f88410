"""Flights: list, replay on the live view's instruments, comparison, deletion."""

import time

from made_up import first_flight


def open_replay(visit, mock, count=1):
    visitor = visit()
    page = visitor.open(f"flights/{first_flight(mock.link, count)}")
    page.wait_for_selector(".plot canvas")
    return page


def test_list_and_delete_asks(visit, mock):
    page = visit().open("flights")
    assert page.locator(".flight").count() == 2
    assert page.locator(".thumbnail polyline").first.get_attribute("points").count(",") > 50
    page.get_by_role("button", name="Delete the flight").first.click()
    assert page.locator(".flight").count() == 2
    page.get_by_role("button", name="Keep").click()
    page.get_by_role("button", name="Delete the flight").first.click()
    page.get_by_role("button", name="Delete", exact=True).click()
    page.wait_for_function("() => document.querySelectorAll('.flight').length === 1", timeout=3000)


def test_replay_plays_scrubs_and_shows_the_same_numbers(visit, mock):
    page = open_replay(visit, mock)
    slider = page.get_by_label("Time of the flight")
    slider.evaluate("one => { one.value = 60; one.dispatchEvent(new Event('input')); }")
    time.sleep(0.3)
    assert page.locator(".timeline-time").inner_text().startswith("01:00")
    assert page.locator(".readout dd").first.inner_text() == "engaged"
    page.get_by_label("Speed of the replay").select_option("25")
    page.get_by_role("button", name="Play").click()
    time.sleep(2)
    page.get_by_role("button", name="Pause").click()
    reached = float(slider.input_value())
    assert 60 + 25 * 1.2 < reached < 60 + 25 * 3.5


def test_events_lead_to_their_time(visit, mock):
    page = open_replay(visit, mock)
    event = page.locator(".events li", has_text="item 3 of the plan is reached")
    minutes, seconds = event.locator(".event-time").inner_text().split(":")
    event.get_by_role("button").click()
    assert (
        abs(
            float(page.get_by_label("Time of the flight").input_value())
            - int(minutes) * 60
            - int(seconds)
        )
        < 1
    )


def test_two_flights_over_each_other(visit, mock):
    page = open_replay(visit, mock, 2)
    page.wait_for_selector(".differences table")
    assert "1.3 m farther off its path" in page.locator(".differences").inner_text()
    assert page.locator(".key-second").count() >= 1


def test_space_plays(visit, mock):
    page = open_replay(visit, mock)
    page.locator("main").focus()
    page.keyboard.press("Space")
    time.sleep(0.6)
    assert page.get_by_role("button", name="Pause").is_visible()
