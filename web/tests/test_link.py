"""Values age: grey after 1 s, crossed out after 3 s, and the page says what is lost."""

from __future__ import annotations

import signal
import time

from playwright.sync_api import Page

from air import Air, Visit

GREY_S = 1.0
LOST_S = 3.0
# A page looks every quarter of a second; later than that is a busy machine.
EARLY_S = 0.3


def wait_until_lost(page: Page, since: float) -> None:
    """Wait until values are grey, then crossed out: neither too early."""
    page.wait_for_selector(".readouts [data-fresh=stale]")
    assert time.monotonic() - since > GREY_S - EARLY_S
    speed = page.locator(".readout[data-fresh=lost]", has_text="Ground speed")
    speed.wait_for()
    assert time.monotonic() - since > LOST_S - EARLY_S
    page.wait_for_selector(".link[data-state=lost]")
    assert "line-through" in speed.evaluate("one => getComputedStyle(one).textDecorationLine")
    assert page.locator(".aircraft.lost").count() == 1
    assert page.locator(".slide").is_disabled()


def test_a_killed_station_is_said_and_found_again(air: Air, visit: Visit) -> None:
    air.station.carried_out("engage")
    page = visit(air.station).open()
    page.wait_for_selector(".readout dd:text-is('engaged')")
    killed = time.monotonic()
    air.station.kill()
    wait_until_lost(page, killed)
    assert page.locator(".no-data").is_visible()
    air.station.start_again()
    page.wait_for_selector(".link[data-state=fresh]")
    page.wait_for_selector(".readout[data-fresh=fresh]:has-text('Ground speed')")
    assert page.locator(".no-data").is_hidden()
    assert air.station.tick()["state"] == "engaged"


def test_a_daemon_that_hangs_is_seen_by_the_age_of_its_values(air: Air, visit: Visit) -> None:
    page = visit(air.station).open()
    page.wait_for_selector(".readout[data-fresh=fresh]:has-text('Ground speed')")
    stopped = time.monotonic()
    air.daemon.send(signal.SIGSTOP)
    wait_until_lost(page, stopped)
    air.daemon.send(signal.SIGCONT)
    page.wait_for_selector(".link[data-state=fresh]")
