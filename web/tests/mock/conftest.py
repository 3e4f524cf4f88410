"""The page beside a stand-in of the station, whose flights are made up."""

import contextlib
import json
import signal
import socket
import subprocess
import time
import urllib.request
from pathlib import Path

import pytest

from visitor import WEB, Visitor


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
        command = [
            "node",
            str(WEB / "mock/server.js"),
            "--port",
            str(self.port),
            "--drafts",
            str(self.drafts),
        ]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        self.process.stdout.readline()

    def stop(self) -> None:
        self.process.send_signal(signal.SIGKILL)
        self.process.wait()

    def post(self, path: str, body: dict) -> dict:
        headers = {"authorization": "Bearer mock", "content-type": "application/json"}
        request = urllib.request.Request(
            f"http://127.0.0.1:{self.port}/api{path}", json.dumps(body).encode(), headers
        )
        with urllib.request.urlopen(request) as answer:
            return json.load(answer)

    def set(self, **what) -> None:
        self.post("/mock", what)

    def command(self, command) -> None:
        self.numbers += 1
        deadline = int(time.time() * 1000) + 5000
        self.post(
            "/live/mock/command",
            {"number": self.numbers, "deadline_ms_utc": deadline, "command": command},
        )

    def draft(self, name: str) -> dict:
        with urllib.request.urlopen(f"http://127.0.0.1:{self.port}/api/drafts/{name}") as answer:
            return json.load(answer)


@pytest.fixture
def mock(tmp_path):
    station = Mock(tmp_path / "drafts.json")
    yield station
    station.stop()


@pytest.fixture
def visit(browser, mock):
    with contextlib.ExitStack() as ends:

        def make(size="desktop", theme="dark", link=None):
            visitor = Visitor(browser, link or mock.link, size, theme)
            ends.callback(visitor.context.close)
            return visitor

        yield make
