"""Each view at three sizes, light and dark: a picture, no finding of axe, nothing cut off."""

from __future__ import annotations

import pytest

from air import Air, Visit
from visitor import PICTURES, SIZES, THEMES, axe

# What a view has when it shows the flight.
SHOWN = {
    "fly": ".readout[data-fresh=fresh] dd:text-is('engaged')",
    "plan": ".items tbody tr",
    "flights": ".flight polyline",
    "replay": ".plot canvas",
    "health": ".findings li",
}


# Displays that are higher or wider than what is around them shows; panels that are wider than
# the page, or whose content is wider than they are, and cannot be scrolled sideways.
CUT_OFF = """() => [...document.querySelectorAll('.pfd')].filter(one => {
    const own = one.getBoundingClientRect(), around = one.parentElement.getBoundingClientRect();
    return own.bottom > around.bottom + 1 || own.right > around.right + 1;
}).concat([...document.querySelectorAll('.top, .panel')].filter(one =>
    one.scrollWidth > one.clientWidth + 1 || one.getBoundingClientRect().right > innerWidth
)).map(one => one.className)"""


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("view", SHOWN)
def test_a_view_has_no_finding_and_fits(cruise: Air, visit: Visit, view: str, size: str) -> None:
    draft = {"plan": cruise.station.ask("GET", f"/api/flights/{cruise.landed()}/plan")[1]["plan"]}
    cruise.station.ask("PUT", "/api/drafts/circuit", draft)
    visitor = visit(cruise.station, size)
    page = visitor.open(f"flights/{cruise.landed()}" if view == "replay" else view)
    page.wait_for_selector(SHOWN[view])
    PICTURES.mkdir(parents=True, exist_ok=True)
    for theme in THEMES:
        page.emulate_media(color_scheme="dark" if theme == "dark" else "light")
        page.wait_for_selector(f"html[data-theme={theme}]")
        page.screenshot(path=PICTURES / f"{view}-{size}-{theme}.png")
        assert axe(page) == [], theme
    wide, window = page.evaluate("[document.documentElement.scrollWidth, innerWidth]")
    assert wide <= window
    assert page.evaluate(CUT_OFF) == []
    assert visitor.errors == []


def test_every_target_is_large_enough_for_a_finger(cruise: Air, visit: Visit) -> None:
    """WCAG 2.2, 2.5.8 asks for 24 px."""
    visitor = visit(cruise.station, "phone")
    visitor.open()
    for view in ("fly", "plan", "flights", "health"):
        visitor.go(view)
        visitor.page.wait_for_selector(SHOWN[view])
        sizes = visitor.page.evaluate(
            """() => [...document.querySelectorAll('button, a[href], input, select')]
                .filter(one => one.offsetParent && !one.closest('.visually-hidden'))
                .map(one => [one, one.getBoundingClientRect()])
                .map(([one, box]) => [one.outerHTML.slice(0, 80), box.width, box.height])"""
        )
        assert len(sizes) >= 10
        assert [one for one in sizes if min(one[1:]) < 24 and "visually-hidden" not in one[0]] == []


def test_no_request_leaves_the_station(cruise: Air, visit: Visit) -> None:
    visitor = visit(cruise.station)
    page = visitor.open()
    routes = ["plan", "flights", f"flights/{cruise.landed()}", "health"]
    for route, view in zip(routes, list(SHOWN)[1:], strict=True):
        visitor.go(route)
        page.wait_for_selector(SHOWN[view])
    own = (visitor.base, "data:", "blob:")
    assert [url for url in visitor.requests if not url.startswith(own)] == []
    assert len(visitor.requests) > 20
