"""Each view at three sizes, light and dark: a picture, no finding of axe, nothing cut off."""

import time

import pytest
from made_up import first_flight

from visitor import PICTURES, SIZES, axe

VIEWS = ["fly", "plan", "flights", "replay", "health"]


def route(view: str, link: str) -> str:
    return f"flights/{first_flight(link)}" if view == "replay" else view


@pytest.mark.parametrize("theme", ["dark", "light"])
@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("view", VIEWS)
def test_view(visit, mock, view, size, theme):
    mock.command("engage")
    visitor = visit(size, theme)
    page = visitor.open(route(view, mock.link))
    time.sleep(1.5)
    PICTURES.mkdir(parents=True, exist_ok=True)
    page.screenshot(path=PICTURES / f"mock-{view}-{size}-{theme}.png")
    assert axe(page) == []
    wide = page.evaluate("[document.documentElement.scrollWidth, innerWidth]")
    assert wide[0] <= wide[1]
    assert visitor.errors == []


def test_every_target_is_large_enough(visit, mock):
    """WCAG 2.2, 2.5.8: 24 px; a finger gets 44 on a phone, where it is a button."""
    page = visit("phone").open("fly")
    sizes = page.evaluate(
        """() => [...document.querySelectorAll('button, a[href], input, select')].filter(one => one.offsetParent)
            .map(one => [one.getAttribute('aria-label') || one.textContent, one.getBoundingClientRect().width, one.getBoundingClientRect().height])"""
    )
    assert [one for one in sizes if min(one[1:]) < 24] == []


def test_no_request_leaves_the_station(visit, mock):
    visitor = visit()
    page = visitor.open("fly")
    for view in ["plan", "flights", route("replay", mock.link), "health"]:
        page.goto(f"{visitor.base}#/{view}")
        time.sleep(0.8)
    outside = [
        url for url in visitor.requests if not url.startswith((visitor.base, "data:", "blob:"))
    ]
    assert outside == []
    assert len(visitor.requests) > 10
