"""A visitor of the page in Debian's chromium; what axe finds in it; its colours."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from playwright.sync_api import Browser, Page, Playwright

WEB = Path(__file__).parents[1]
PICTURES = WEB.parent / "target" / "page"
SIZES = {"desktop": (1440, 900), "tablet": (820, 1180), "phone": (390, 844)}
THEMES = ("dark", "light")
# Of a busy machine, not of the page.
PATIENCE_MS = 30_000
QUIET = [
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
]
WCAG = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa"]


def chromium(playwright: Playwright) -> Browser:
    program = os.environ.get("CHROMIUM", "/usr/bin/chromium")
    return playwright.chromium.launch(executable_path=program, args=QUIET)


class Visitor:
    """A page, with what it asked for and what went wrong in it."""

    def __init__(
        self,
        browser: Browser,
        link: str,
        size: str = "desktop",
        theme: str = "dark",
        aircraft: str | None = None,
    ):
        self.aircraft = aircraft
        width, height = SIZES[size]
        self.context = browser.new_context(
            viewport={"width": width, "height": height},
            color_scheme="dark" if theme == "dark" else "light",
            has_touch=size != "desktop",
            accept_downloads=True,
        )
        self.context.set_default_timeout(PATIENCE_MS)
        self.page = self.context.new_page()
        self.requests: list[str] = []
        self.errors: list[str] = []
        self.page.on("request", lambda request: self.requests.append(request.url))
        self.page.on("pageerror", lambda error: self.errors.append(str(error)))
        self.page.on("console", lambda entry: self._note(entry.type, entry.text))
        self.link = link
        self.base = link.split("#", maxsplit=1)[0]

    def _note(self, kind: str, text: str) -> None:
        if kind == "error":
            self.errors.append(text)

    def open(self, route: str = "fly") -> Page:
        """Open the link, then a view."""
        self._arrive(self.page)
        self.go(route)
        return self.page

    def go(self, route: str) -> None:
        self.page.goto(f"{self.base}#/{route}")
        self.page.wait_for_selector(f"body[data-ready={route.split('/', maxsplit=1)[0]}]")

    def again(self) -> Page:
        """Return another page of the same browser; a tab has its own token."""
        page = self.context.new_page()
        self._arrive(page)
        return page

    def _arrive(self, page: Page) -> None:
        page.goto(self.link)
        if self.aircraft is not None:
            # Others may fly on this machine.
            page.wait_for_selector(f".instance option[value='{self.aircraft}']", state="attached")
            picker = page.get_by_label("Aircraft", exact=True)
            if picker.input_value() != self.aircraft:
                picker.select_option(self.aircraft)
        page.wait_for_selector(".link[data-state=fresh]")


def axe(page: Page) -> list[Any]:
    """Return what axe finds against WCAG 2.2 AA.

    Points on a map are where they are, and the table has the same functions: 2.5.8 exempts
    them from the size of targets (exceptions "essential" and "equivalent").
    """
    if not page.evaluate("'axe' in window"):
        page.evaluate((WEB / "node_modules/axe-core/axe.min.js").read_text())
    run = "async ([where, options]) => (await axe.run(where, options)).violations"
    off = {"target-size": {"enabled": False}}
    found = page.evaluate(run, [{"include": ["html"]}, {"runOnly": WCAG, "rules": off}])
    size = {"runOnly": {"type": "rule", "values": ["target-size"]}}
    where = {"include": ["html"], "exclude": [".leaflet-marker-pane"]}
    found += page.evaluate(run, [where, size])
    return [
        (
            one["id"],
            [node["target"] for node in one["nodes"]][:3],
            one["nodes"][0]["failureSummary"],
        )
        for one in found
    ]
