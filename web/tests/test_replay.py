"""A recorded flight is shown by what is in its recording, also while others are read."""

from __future__ import annotations

from playwright.sync_api import Page, Route

from air import Air, Visit

# So wide is the tape of the airspeed.
TAPE_PX = 72
# Pixels of the tape that are of a colour: of the band above never-exceed, and below stall.
RED = """wide => {
    const canvas = document.querySelector('.pfd-canvas');
    const ratio = canvas.width / canvas.clientWidth;
    const { data } = canvas.getContext('2d').getImageData(0, 0, wide * ratio, canvas.height);
    let red = 0;
    for (let at = 0; at < data.length; at += 4)
        if (data[at] > 180 && data[at + 1] < 120 && data[at + 2] < 120) red += 1;
    return red;
}"""
MODES = """() => [...document.querySelectorAll('.timeline-legend li')].map(one =>
    [one.querySelector('.mode-key').textContent, one.lastChild.textContent])"""


def replay(cruise: Air, visit: Visit) -> Page:
    page = visit(cruise.station).open(f"flights/{cruise.landed()}")
    page.wait_for_selector(".plot canvas")
    return page


def test_the_speed_tape_has_its_bands_without_a_daemon(cruise: Air, visit: Visit) -> None:
    flights = cruise.station.ask("GET", "/api/flights")[1]
    flown_by = next(one["instance"] for one in flights if one["file"] == cruise.landed())
    daemons = cruise.station.ask("GET", "/api/status")[1]["daemons"]
    assert flown_by not in [one["instance"] for one in daemons]
    page = replay(cruise, visit)
    # On the runway: all of the tape that is shown is below the stall.
    page.wait_for_function(f"wide => ({RED})(wide) > 300", arg=TAPE_PX)


def test_a_recording_opens_before_the_list_is_there(cruise: Air, visit: Visit) -> None:
    visitor = visit(cruise.station)
    held: list[Route] = []

    def hold(route: Route) -> None:
        held.append(route)

    visitor.page.route("**/api/flights", hold)
    page = visitor.open()
    landed = cruise.landed()
    visitor.go(f"flights/{landed}")
    page.wait_for_selector(".plot canvas")
    others = page.get_by_label("Second flight").locator("option")
    assert held
    assert others.count() == 1
    for route in held:
        route.continue_()
    page.wait_for_function(
        "() => document.querySelector('[aria-label=\"Second flight\"]').options.length > 1"
    )


def test_the_bands_of_the_time_line_have_a_legend(cruise: Air, visit: Visit) -> None:
    page = replay(cruise, visit)
    found = dict(page.evaluate(MODES))
    # The modes of the plan that it flew, by their numbers in a record (proto/layout.md).
    assert found["7"] == "take-off"
    assert found["3"] == "plan"
    assert found["8"] == "land"
    colours = page.locator(".mode-key").evaluate_all(
        "all => all.map(one => getComputedStyle(one).backgroundColor)"
    )
    assert len(set(colours)) == len(colours) == len(found)
