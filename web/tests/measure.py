"""What the ground station costs, and how fast its page is: `make bench-ground`.

The station, the daemon and Debian's chromium are the real ones. Flights with and without viewers
alternate. The viewers are of one process, which takes the processor's time from all others.
"""

from __future__ import annotations

import argparse
import base64
import contextlib
import json
import math
import os
import random
import selectors
import shutil
import signal
import socket
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

from daemon_under_test import DaemonUnderTest
from fcc_hil.measured import machine, write
from fcc_hil.table import markdown
from ground_station import ROOT, Station
from playwright.sync_api import Browser, Page, sync_playwright
from rich.progress import Progress

from mavlink_load import MavlinkStation, latencies_ms, take_50_hz
from visitor import Visitor, chromium

CONFIG = """
[engage]
command_needs_switch = false
[guidance]
mode = "plan"
[plan]
file = "{plan}"
[telemetry]
instance = "{instance}"
[recording]
folder = "{folder}/recordings"
"""
ITEMS = 100
THROTTLED = 6
VIEWERS = 200
MAVLINK_STATIONS = 3
MAVLINK_COMMANDS = 300
TITLES = {"viewers": "Viewers", "page": "The page", "soak": "Soak", "mavlink": "MAVLink"}
HEAD = ("figure", "seen", "wanted")
TICKS_PER_S = os.sysconf("SC_CLK_TCK")
MAPS = ("land-50m", "detail-", "coast-")
FRAMES = """seconds => new Promise(done => {
  let drawn = 0;
  const began = performance.now();
  const step = now => {
    drawn += 1;
    if (now - began < seconds * 1000) requestAnimationFrame(step);
    else done(drawn / ((now - began) / 1000));
  };
  requestAnimationFrame(step);
})"""
Row = tuple[str, str, str]


def plan_of_a_survey(file: Path) -> None:
    """Write parallel legs north and south of the built-in aircraft's runway."""
    first = (ROOT / "config/plans/circuit.waypoints").read_text().splitlines()
    home = first[1].split("\t")
    latitude, longitude = float(home[8]), float(home[9])
    rows = [first[0], first[1]]
    for n in range(ITEMS):
        north = latitude + (0.05 if n // 2 % 2 == n % 2 else -0.05)
        east = longitude + 0.03 * (n // 2)
        rows.append(f"{n + 1}\t0\t3\t16\t0\t0\t0\t0\t{north:.6f}\t{east:.6f}\t600\t1")
    file.write_text("\n".join(rows) + "\n")


class Process:
    """A process of this machine, as the kernel counts it."""

    def __init__(self, process_id: int):
        self.folder = Path("/proc", str(process_id))
        self.began = time.monotonic(), self.seconds()

    def seconds(self) -> float:
        fields = (self.folder / "stat").read_text().rsplit(") ", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / TICKS_PER_S

    def cores(self) -> float:
        """Return the processors in use since the last call."""
        now = time.monotonic(), self.seconds()
        used = (now[1] - self.began[1]) / (now[0] - self.began[0])
        self.began = now
        return used

    def resident_mb(self) -> float:
        status = (self.folder / "status").read_text()
        line = next(line for line in status.splitlines() if line.startswith("VmRSS"))
        return int(line.split()[1]) / 1024

    def descriptors(self) -> int:
        return len(list((self.folder / "fd").iterdir()))


class Viewer:
    """A WebSocket that takes whatever it is sent."""

    # A pong nobody asked for, by RFC 6455, section 5.5.3: masked, empty.
    PONG = bytes([0x8A, 0x80, 1, 2, 3, 4])

    def __init__(self, station: Station) -> None:
        host, port = station.address.removeprefix("http://").split(":")
        self.socket = socket.create_connection((host, int(port)))
        key = base64.b64encode(os.urandom(16)).decode()
        lines = [
            f"GET /api/live/{station.instance} HTTP/1.1",
            f"Host: {host}:{port}",
            "Connection: Upgrade",
            "Upgrade: websocket",
            "Sec-WebSocket-Version: 13",
            f"Sec-WebSocket-Key: {key}",
        ]
        self.socket.sendall(("\r\n".join(lines) + "\r\n\r\n").encode())
        answer = self.socket.recv(12)
        if answer != b"HTTP/1.1 101":
            raise ConnectionError(f"the station answered {answer!r}")
        self.answered = time.monotonic()


def watch(station: Station, viewers: int, until: float, churn_s: float = 0) -> int:
    """Keep as many viewers, and return the bytes that they got; each stays `churn_s` at most."""
    chance = random.Random(1)
    waiting = selectors.DefaultSelector()
    buffer = bytearray(1 << 18)
    got = 0
    here: list[tuple[Viewer, float]] = []

    def come() -> None:
        viewer = Viewer(station)
        stays_s = chance.uniform(0.1, churn_s) if churn_s else math.inf
        waiting.register(viewer.socket, selectors.EVENT_READ)
        here.append((viewer, time.monotonic() + stays_s))

    def leave(viewer: Viewer) -> None:
        waiting.unregister(viewer.socket)
        viewer.socket.close()

    while time.monotonic() < until:
        while len(here) < viewers:
            come()
        for key, _ in waiting.select(0.1):
            assert isinstance(key.fileobj, socket.socket)
            bytes_ = key.fileobj.recv_into(buffer)
            if not bytes_:
                raise ConnectionError("the station closed a viewer's connection")
            got += bytes_
        now = time.monotonic()
        for entry in list(here):
            viewer, leaves = entry
            if now > leaves:
                leave(viewer)
                here.remove(entry)
            elif now > viewer.answered + 5.0:
                viewer.socket.sendall(Viewer.PONG)
                viewer.answered = now
    for viewer, _ in here:
        leave(viewer)
    return got


class Measured:
    """The programs under test, in a folder of their own."""

    def __init__(self, folder: Path, fccd: Path, program: Path) -> None:
        self.folder, self.fccd, self.program = folder, fccd, program
        self.instance = f"measured-{os.getpid()}"
        self.config = folder / "fccd.toml"
        plan = folder / "survey.waypoints"
        plan_of_a_survey(plan)
        self.config.write_text(
            CONFIG.format(plan=plan, folder=folder, instance=self.instance) + "[built-in]\n"
        )

    @contextlib.contextmanager
    def flight(self) -> Iterator[DaemonUnderTest]:
        words: list[str | Path] = [self.fccd, "run", "--json", "--quiet", "--config", self.config]
        with DaemonUnderTest(words, self.folder) as daemon:
            yield daemon

    @contextlib.contextmanager
    def station(self, options: Sequence[str] = ()) -> Iterator[Station]:
        words: list[str | Path] = [self.program, "--config", self.config, "--fccd", self.fccd]
        state: list[str | Path] = ["--state", self.folder / "state"]
        station = Station([*words, *state, *options], self.fccd, self.instance)
        try:
            yield station
        finally:
            station.end()


def in_turn(
    measured: Measured,
    rounds: int,
    beside: Callable[[Station, bool], None],
    options: Sequence[str] = (),
) -> tuple[float, float]:
    """Return the loop's p99 without and with a load, µs; flights without and with it alternate."""
    p99_us: dict[bool, list[float]] = {False: [], True: []}
    for _ in range(rounds):
        for is_loaded, found_us in p99_us.items():
            given = options if is_loaded else ()
            with measured.flight() as daemon, measured.station(given) as station:
                beside(station, is_loaded)
                ending = daemon.end(signal.SIGINT)
            found_us.append(ending.report["timing"]["lateness_us"]["p99"])
    return statistics.median(p99_us[False]), statistics.median(p99_us[True])


def lateness(measured: Measured, seconds: float, rounds: int, progress: Progress) -> list[Row]:
    """Return the loop's lateness with viewers against without, and the station's cost."""
    cores, resident_mb, sent_mb = [], [], []
    task = progress.add_task("flights without and with viewers", total=2 * rounds)

    def beside(station: Station, is_loaded: bool) -> None:
        process = Process(station.process.pid)
        got = watch(station, VIEWERS if is_loaded else 0, time.monotonic() + seconds)
        if is_loaded:
            cores.append(process.cores())
            resident_mb.append(process.resident_mb())
            sent_mb.append(got / seconds / 1e6)
        progress.advance(task)

    without, with_them = in_turn(measured, rounds, beside)
    flights = f"{rounds} flights of {seconds:.0f} s each, in turn"
    return [
        (f"loop's p99 with {VIEWERS} viewers against without", f"{with_them / without:.2f}", "1.1"),
        (f"the same in µs; {flights}", f"{with_them:.1f}; {without:.1f}", ""),
        (f"station with {VIEWERS} viewers: cores", f"{max(cores):.2f}", "0.5"),
        ("the same: memory, MB", f"{max(resident_mb):.0f}", "60"),
        ("the same: sent, MB/s", f"{max(sent_mb):.1f}", ""),
    ]


def mavlink(measured: Measured, seconds: float, rounds: int, progress: Progress) -> list[Row]:
    """Return the latency of commands, and the loop's lateness with MAVLink stations."""
    task = progress.add_task("MAVLink", total=2 * rounds + 1)
    cores, frames = [], []
    stations = [MavlinkStation(255 - n) for n in range(MAVLINK_STATIONS)]

    def beside(station: Station, is_loaded: bool) -> None:
        process, until = Process(station.process.pid), time.monotonic() + seconds
        if is_loaded:
            frames.append(take_50_hz(stations, until) / seconds)
            cores.append(process.cores())
        else:
            time.sleep(seconds)
        progress.advance(task)

    links = [word for one in stations for word in ("--mavlink", one.link)]
    without, with_them = in_turn(measured, rounds, beside, links)
    one = MavlinkStation(255)
    with measured.flight() as daemon, measured.station(["--mavlink", one.link]):
        found = latencies_ms(one, MAVLINK_COMMANDS)
        daemon.end(signal.SIGINT)
    progress.advance(task)
    what = f"{MAVLINK_STATIONS} MAVLink stations at 50 Hz"
    flights = f"{rounds} flights of {seconds:.0f} s each, in turn"
    rows: list[Row] = [
        (f"loop's p99 with {what} against without", f"{with_them / without:.2f}", "1.1"),
        ("MAVLink: the same in µs", f"{with_them:.2f}; {without:.2f}; {flights}", ""),
        (f"station with {what}: cores", f"{max(cores):.2f}", ""),
        ("MAVLink: messages a second", f"{min(frames):.0f}", ""),
    ]
    for name, taken_ms in found.items():
        cuts = statistics.quantiles(taken_ms, n=100)
        figure = f"`{name}` by UDP, {len(taken_ms)} times: p50; p99, ms"
        rows.append((figure, f"{cuts[49]:.1f}; {cuts[98]:.1f}", "p99 100"))
    return rows


def page_of(browser: Browser, station: Station) -> Visitor:
    return Visitor(browser, station.link, aircraft=station.instance)


def arrival(browser: Browser, station: Station) -> list[Row]:
    """Return how long the page takes until it shows live values, and its size."""
    ready_ms, sizes = [], []
    for _ in range(5):
        visitor = page_of(browser, station)
        # Chromium has to have opened its own window first, which takes two processors a second.
        visitor.page.wait_for_timeout(2_500)
        visitor.page.goto(visitor.link)
        visitor.page.wait_for_selector(".link[data-state=fresh]")
        ready_ms.append(visitor.page.evaluate("performance.now()"))
        entries = visitor.page.evaluate(
            "['navigation', 'resource'].flatMap(kind => performance.getEntriesByType(kind))"
            ".map(one => [one.name, one.encodedBodySize])"
        )
        sizes.append(sum(size for name, size in entries if not any(map_ in name for map_ in MAPS)))
        visitor.context.close()
    ready_s = statistics.median(ready_ms) / 1e3
    return [
        ("page shows live values, s; median of 5", f"{ready_s:.2f}", "0.5"),
        ("bytes gzip without maps, KB", f"{max(sizes) / 1e3:.0f}", "200"),
    ]


def frames(page: Page, seconds: float) -> tuple[float, float, float]:
    """Return frames a second, the main thread's share, and frames at a part of the processor."""
    session = page.context.new_cdp_session(page)
    session.send("Performance.enable")

    def busy() -> float:
        metrics = session.send("Performance.getMetrics")["metrics"]
        return float(next(one["value"] for one in metrics if one["name"] == "TaskDuration"))

    before, began = busy(), time.monotonic()
    drawn = float(page.evaluate(FRAMES, seconds))
    share = (busy() - before) / (time.monotonic() - began)
    session.send("Emulation.setCPUThrottlingRate", {"rate": THROTTLED})
    slow = float(page.evaluate(FRAMES, seconds))
    session.send("Emulation.setCPUThrottlingRate", {"rate": 1})
    return drawn, share, slow


def of_frames(what: str, found: tuple[float, float, float]) -> list[Row]:
    drawn, share, slow = found
    return [
        (f"{what}: frames a second", f"{drawn:.0f}", "60"),
        (f"{what}: main thread, %", f"{100 * share:.0f}", "25"),
        (f"{what}: frames a second at a sixth of the processor", f"{slow:.0f}", "40"),
    ]


def heap_mb(page: Page) -> float:
    session = page.context.new_cdp_session(page)
    session.send("HeapProfiler.collectGarbage")
    return float(session.send("Runtime.getHeapUsage")["usedSize"]) / 1e6


def an_hour(measured: Measured) -> None:
    """Fly the plan for an hour of simulated time, and keep the recording."""
    words: list[str | Path] = [
        measured.fccd,
        "fly",
        "--lockstep",
        "--quiet",
        "--config",
        measured.config,
    ]
    words += ["--seconds", "3600", "--recordings", measured.folder / "recordings"]
    ended = subprocess.run(words, check=False, capture_output=True)
    if not list((measured.folder / "recordings").glob("*.mcap")):
        sys.exit(f"the flight of an hour ended with {ended.returncode}, without a recording")


def page_figures(measured: Measured, minutes: float, progress: Progress) -> list[Row]:
    task = progress.add_task("the page", total=None)
    an_hour(measured)
    with (
        measured.flight() as daemon,
        measured.station() as station,
        sync_playwright() as playwright,
        contextlib.closing(chromium(playwright)) as browser,
    ):
        rows = arrival(browser, station)
        # One page at a time: each takes a share of the same processors.
        longest = max(station.ask("GET", "/api/flights")[1], key=lambda one: one["duration_s"])
        replay = page_of(browser, station)
        other = replay.open("flights")
        opening = time.monotonic()
        replay.go(f"flights/{longest['file']}")
        other.wait_for_selector(".uplot")
        opened_s = time.monotonic() - opening
        rows.append(("a flight of an hour is open, s", f"{opened_s:.2f}", "1"))
        other.get_by_role("button", name="Play").click()
        other.wait_for_timeout(5_000)
        rows += of_frames("Replay, an hour, 6 plots", frames(other, 5.0))
        replay.context.close()
        live = page_of(browser, station)
        page = live.open("fly")
        page.wait_for_timeout(5_000)
        rows += of_frames(f"Fly, plan of {ITEMS} items", frames(page, 5.0))
        first_mb = heap_mb(page)
        page.wait_for_timeout(60e3 * minutes)
        heaps = f"{first_mb:.1f}; {heap_mb(page):.1f}"
        rows.append((f"heap, MB, at first; after {minutes:g} min", heaps, "flat"))
        errors = len(live.errors)
        rows.append(("errors in the page's console", str(errors), "0"))
        live.context.close()
        daemon.end(signal.SIGINT)
    progress.update(task, total=1, completed=1)
    return rows


def soak(measured: Measured, minutes: float, progress: Progress) -> list[Row]:
    """Viewers come and go, and flights start and end, beside one station."""
    flight_s = 20.0
    flights = max(int(60 * minutes / flight_s), 2)
    task = progress.add_task("soak", total=flights)
    states: list[tuple[float, int]] = []
    with contextlib.ExitStack() as ends:
        with measured.flight():
            station = ends.enter_context(measured.station())
        process = Process(station.process.pid)
        for _ in range(flights):
            # Until the station has seen that the one before has ended.
            time.sleep(3.0)
            with measured.flight() as daemon:
                while station.daemon() is None:
                    time.sleep(0.1)
                stops = time.monotonic() + flight_s
                watch(station, 5, stops, churn_s=2.0)
                daemon.end(signal.SIGINT)
            states.append((process.resident_mb(), process.descriptors()))
            shutil.rmtree(measured.folder / "recordings", ignore_errors=True)
            progress.advance(task)
    quarter = max(len(states) // 4, 1)
    first, last = states[quarter - 1], states[-1]
    what = f"soak: {flights} flights of {flight_s:.0f} s, 5 viewers of up to 2 s"
    return [
        (
            f"{what}: memory, MB, after a quarter; at the end",
            f"{first[0]:.1f}; {last[0]:.1f}",
            "flat",
        ),
        ("the same: descriptors", f"{first[1]}; {last[1]}", "none lost"),
    ]


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--fccd", type=Path, required=True)
    options.add_argument("--station", type=Path, required=True)
    options.add_argument("--results", type=Path, help="write a section for each part here")
    options.add_argument("--json", action="store_true", help="print the figures as JSON")
    seconds_of = "of a flight with viewers, or MAVLink stations"
    options.add_argument("--seconds", type=float, default=60.0, help=seconds_of)
    options.add_argument("--rounds", type=int, default=3)
    options.add_argument("--heap-minutes", type=float, default=10.0)
    options.add_argument("--soak-minutes", type=float, default=20.0)
    options.add_argument("--only", nargs="+", choices=TITLES, help="parts")
    given = options.parse_args()
    rows: list[Row] = []
    with Progress(disable=not sys.stderr.isatty()) as progress:
        parts: dict[str, Callable[[Measured], list[Row]]] = {
            "viewers": lambda of: lateness(of, given.seconds, given.rounds, progress),
            "page": lambda of: page_figures(of, given.heap_minutes, progress),
            "soak": lambda of: soak(of, given.soak_minutes, progress),
            "mavlink": lambda of: mavlink(of, given.seconds, given.rounds, progress),
        }
        for name, part in parts.items():
            if given.only and name not in given.only:
                continue
            with tempfile.TemporaryDirectory() as folder:
                measured = Measured(Path(folder), given.fccd.resolve(), given.station.resolve())
                found = part(measured)
            rows += found
            if given.results:
                command = f'make bench-ground MEASURE="--only {name}"'
                write(given.results, TITLES[name], command, markdown(HEAD, found))
    said: Any = [dict(zip(HEAD, row, strict=True)) for row in rows]
    print(
        json.dumps({"machine": machine(), "figures": said}) if given.json else markdown(HEAD, rows)
    )


main()
