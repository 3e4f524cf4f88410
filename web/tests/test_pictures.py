"""The pictures of the documents: `make pictures` takes them anew."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from ground_station import ROOT, Station

from air import Air, Visit

FOLDER = os.environ.get("FCC_PICTURES")

pytestmark = pytest.mark.skipif(not FOLDER, reason="`make pictures` takes them")


def taken(name: str) -> Path:
    return Path(FOLDER or ".", f"{name}.png")


def test_fly_and_plan(ground: Station, visit: Visit) -> None:
    """In the first turn of the plan that `make ground` has."""
    text = (ROOT / "config/plans/circuit.waypoints").read_text()
    _, read = ground.ask("POST", "/api/plan/import", {"text": text, "name": "circuit.waypoints"})
    ground.ask("PUT", "/api/drafts/circuit", {"plan": read["plan"]})
    ground.carried_out("engage")
    page = visit(ground).open()
    turning = "() => Math.abs(parseFloat([...document.querySelectorAll('tr')].find(row =>"
    turning += (
        " row.textContent.startsWith('Bank'))?.cells[1].textContent.replace('\\u2212', '-'))) > 20"
    )
    page.wait_for_function(turning, timeout=300_000)
    page.wait_for_timeout(3_000)
    page.screenshot(path=taken("fly"))
    visitor = visit(ground)
    page = visitor.open("plan")
    page.wait_for_selector(".items tbody tr")
    page.wait_for_timeout(1_000)
    page.screenshot(path=taken("plan"))


def test_replay(cruise: Air, visit: Visit) -> None:
    """Of a flight that has landed, in the last turn but one."""
    page = visit(cruise.station).open(f"flights/{cruise.landed()}")
    page.wait_for_selector(".plot canvas")
    scrubber = page.locator("input[type=range]").first
    scrubber.evaluate(
        "(one, part) => { one.value = one.min * (1 - part) + one.max * part;"
        " one.dispatchEvent(new Event('input', { bubbles: true })); }",
        0.64,
    )
    page.wait_for_timeout(1_500)
    page.screenshot(path=taken("replay"))
