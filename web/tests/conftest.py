"""The page in Debian's chromium, against the mock or, with --station, a real station.

    pip install pytest playwright
    pytest web/tests [--station 'http://127.0.0.1:8460/#token=...']

CHROMIUM names the browser, by default /usr/bin/chromium.
"""

import json
import os
import re
import signal
import socket
import subprocess
import time
import urllib.request
from pathlib import Path

import pytest
from playwright.sync_api import sync_playwright

WEB = Path(__file__).resolve().parent.parent
OUT = WEB / "tests" / "out"
SIZES = {"desktop": (1440, 900), "tablet": (820, 1180), "phone": (390, 844)}
READY_MS = 20_000


def pytest_addoption(parser):
    parser.addoption("--station", help="link of a running station, with its token")


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class Mock:
    """The stand-in of the station, which can be ended and started again."""

    def __init__(self, drafts: Path):
        self.port = free_port()
        self.drafts = drafts
        self.numbers = 0
        self.start()

    @property
    def link(self) -> str:
        return f"http://127.0.0.1:{self.port}/#token=mock"

    def start(self) -> None:
        command = ["node", str(WEB / "mock/server.js"), "--port", str(self.port), "--drafts", str(self.drafts)]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        self.process.stdout.readline()

    def stop(self) -> None:
        self.process.send_signal(signal.SIGKILL)
        self.process.wait()

    def post(self, path: str, body: dict) -> dict:
        headers = {"authorization": "Bearer mock", "content-type": "application/json"}
        request = urllib.request.Request(f"http://127.0.0.1:{self.port}/api{path}", json.dumps(body).encode(), headers)
        with urllib.request.urlopen(request) as answer:
            return json.load(answer)

    def set(self, **what) -> None:
        self.post("/mock", what)

    def command(self, command) -> None:
        self.numbers += 1
        deadline = int(time.time() * 1000) + 5000
        self.post("/live/mock/command", {"number": self.numbers, "deadline_ms_utc": deadline, "command": command})

    def draft(self, name: str) -> dict:
        with urllib.request.urlopen(f"http://127.0.0.1:{self.port}/api/drafts/{name}") as answer:
            return json.load(answer)


@pytest.fixture
def mock(tmp_path):
    station = Mock(tmp_path / "drafts.json")
    yield station
    station.stop()


@pytest.fixture(scope="session")
def browser():
    with sync_playwright() as playwright:
        program = os.environ.get("CHROMIUM", "/usr/bin/chromium")
        opened = playwright.chromium.launch(executable_path=program, args=["--no-sandbox"])
        yield opened
        opened.close()


class Visitor:
    """A page, with what it asked for and what went wrong in it."""

    def __init__(self, browser, link: str, size: str, theme: str):
        width, height = SIZES[size]
        self.context = browser.new_context(
            viewport={"width": width, "height": height}, color_scheme=theme, has_touch=size != "desktop", accept_downloads=True
        )
        self.page = self.context.new_page()
        self.requests, self.errors = [], []
        self.page.on("request", lambda request: self.requests.append(request.url))
        self.page.on("pageerror", lambda error: self.errors.append(str(error)))
        self.page.on("console", lambda entry: self.errors.append(entry.text) if entry.type == "error" else None)
        self.link = link
        self.base = link.split("#")[0]

    def open(self, view: str = "fly"):
        name = view.split("/")[0]
        self.page.goto(self.link)
        self.page.wait_for_selector(".link[data-state=fresh]", timeout=READY_MS)
        if view != "fly":
            self.page.goto(f"{self.base}#/{view}")
        self.page.wait_for_selector(f"body[data-ready={name}]", timeout=READY_MS)
        return self.page

    def again(self):
        """Another page of the same browser; a tab has its own token."""
        page = self.context.new_page()
        page.goto(self.link)
        page.wait_for_selector(".link[data-state=fresh]", timeout=READY_MS)
        return page


@pytest.fixture
def visit(browser, mock):
    visitors = []

    def make(size="desktop", theme="dark", link=None):
        visitors.append(Visitor(browser, link or mock.link, size, theme))
        return visitors[-1]

    yield make
    for one in visitors:
        one.context.close()


@pytest.fixture
def station(request):
    link = request.config.getoption("--station")
    if not link:
        pytest.skip("needs --station LINK")
    return link


def axe(page) -> list:
    """What axe finds against WCAG 2.2 AA.

    Points on a map are where they are, and the table has the same functions: 2.5.8 exempts
    them from the size of targets (exceptions "essential" and "equivalent").
    """
    page.evaluate((WEB / "node_modules/axe-core/axe.min.js").read_text())
    run = "([where, options]) => axe.run(where, options)"
    tags = {"runOnly": ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa"], "rules": {"target-size": {"enabled": False}}}
    found = page.evaluate(run, [{"include": ["html"]}, tags])["violations"]
    found += page.evaluate(run, [{"include": ["html"], "exclude": [".leaflet-marker-pane"]}, {"runOnly": {"type": "rule", "values": ["target-size"]}}])["violations"]
    return [(one["id"], [node["target"] for node in one["nodes"]][:3], one["nodes"][0].get("failureSummary")) for one in found]


def first_flight(link: str, count: int = 1) -> str:
    with urllib.request.urlopen(re.sub(r"/#.*", "/api/flights", link)) as answer:
        return "/".join(one["file"] for one in json.load(answer)[:count])
