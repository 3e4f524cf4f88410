"""A ground station beside a real daemon: start it, ask it, read what `fccd top` shows."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import time
import urllib.error
import urllib.request
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[2]
PATIENCE_S = 30.0


def waited(what: str, found: Callable[[], Any]) -> Any:
    """Return the first value that is true."""
    deadline = time.monotonic() + PATIENCE_S
    while time.monotonic() < deadline:
        value = found()
        if value:
            return value
        time.sleep(0.1)
    raise AssertionError(f"it took too long: {what}")


def place(latitude_deg: float, longitude_deg: float) -> dict[str, float]:
    return {"latitude_deg": latitude_deg, "longitude_deg": longitude_deg}


class Station:
    """A station, started by a command that prints its link as JSON, and what its page asks."""

    def __init__(
        self,
        words: Sequence[str | Path],
        fccd: Path,
        instance: str,
        environment: Mapping[str, str] | None = None,
    ) -> None:
        self.words = [str(word) for word in words]
        self.fccd = fccd
        self.instance = instance
        self.environment = {**os.environ, **(environment or {})}
        self.number = time.time_ns()
        self.start()

    def start(self, listen: str = "127.0.0.1:0") -> None:
        self.process = subprocess.Popen(
            [*self.words, "--json", "--listen", listen],
            cwd=ROOT,
            env=self.environment,
            stdout=subprocess.PIPE,
            text=True,
            start_new_session=True,
        )
        assert self.process.stdout is not None
        self.link = json.loads(self.process.stdout.readline())["link"]
        self.address, self.token = self.link.split("/#token=")
        waited("the daemon", self.daemon)

    def kill(self) -> None:
        self.process.kill()
        self.process.wait(PATIENCE_S)

    def start_again(self) -> None:
        """Start it at the port where it was."""
        self.start(self.address.removeprefix("http://"))

    def ask(self, method: str, path: str, body: Any = None) -> tuple[int, Any]:
        headers = {"Authorization": f"Bearer {self.token}", "Content-Type": "application/json"}
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(self.address + path, data, headers, method=method)
        try:
            with urllib.request.urlopen(request, timeout=PATIENCE_S) as answer:
                return answer.status, json.load(answer)
        except urllib.error.HTTPError as error:
            return error.code, json.load(error)

    def order(self) -> dict[str, int]:
        self.number += 1
        return {"number": self.number, "deadline_ms_utc": int(time.time() * 1000) + 10_000}

    def command(self, command: Any) -> tuple[int, Any]:
        path = f"/api/live/{self.instance}/command"
        return self.ask("POST", path, {**self.order(), "command": command})

    def carried_out(self, command: Any) -> tuple[int, Any]:
        """Give a command until it is carried out: a daemon just started does not engage yet."""

        def accepted() -> tuple[int, Any] | None:
            answer = self.command(command)
            return answer if answer[0] == 200 else None

        answer: tuple[int, Any] = waited(str(command), accepted)
        return answer

    def upload(self, draft: str, revision: int) -> tuple[int, Any]:
        body = {**self.order(), "draft": draft, "revision": revision, "item": 1}
        return self.ask("POST", f"/api/live/{self.instance}/plan", body)

    def vehicle(self) -> Any:
        return self.ask("GET", f"/api/live/{self.instance}/plan")[1]

    def daemon(self) -> Any:
        found = self.ask("GET", "/api/status")[1]["daemons"]
        return next((one for one in found if one["instance"] == self.instance), None)

    def tick(self) -> Any:
        """Return the newest tick, as `fccd top` shows it."""
        command = [str(self.fccd), "top", "--json", "--instance", self.instance]
        return json.loads(subprocess.check_output(command))["tick"]

    def end(self) -> None:
        if self.process.poll() is None:
            os.killpg(self.process.pid, signal.SIGINT)
            self.process.wait(PATIENCE_S)


def make_ground(folder: Path, fccd: Path, station: str, options: Sequence[str] = ()) -> Station:
    """Start `scripts/ground`: the station, and the built-in aircraft on its runway."""
    instance = f"ground-{os.getpid()}"
    environment = {"FCCD": str(fccd), "STATION": station, "GROUND": str(folder)}
    script: list[str | Path] = [ROOT / "scripts/ground", *options]
    return Station(script, fccd, instance, {**environment, "INSTANCE": instance})
