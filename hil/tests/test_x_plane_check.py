"""`fccd x-plane check` against the stand-in with a person at it.

Every step passes, and each fails when the stand-in misbehaves in what the step checks. The checks
run at the same time, most of which is waiting: the steps in parts, well and badly behaved. A
misbehaviour lasts as long as its step, so that no step fails by another's. FCCD_FULL_CHECK=1
(`make test-x-plane`) runs the steps in full.
"""

from __future__ import annotations

import contextlib
import json
import os
import re
import socket
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from daemon_under_test import write_config

from fcc_hil.misbehaviour import MISBEHAVIOURS
from fcc_hil.process import StandInProcess
from fcc_hil.settings import Settings

STEPS = tuple(range(1, 21))
IS_FULL = os.environ.get("FCCD_FULL_CHECK") == "1"
PATIENCE_S = 1_800.0 if IS_FULL else 240.0
SUCCESS, FAILURE, USAGE, STEP_FAILED = 0, 1, 2, 15
# In parts of about the same duration.
PARTS = ((1, 2, 3, 4, 5, 6, 7, 8), (9, 10, 11, 20), (12, 13, 14, 15, 16, 17, 18, 19))


@dataclass(frozen=True)
class Checked:
    """A finished check."""

    exit_codes: list[int]
    steps: dict[int, dict[str, Any]]
    reports: list[str]
    log: str

    def why(self, number: int) -> str:
        return json.dumps(self.steps[number], indent=2, ensure_ascii=False)


class Check:
    """A running check against a stand-in of its own."""

    def __init__(self, fccd: Path, scratch: Path, only: tuple[int, ...], misbehaves: bool) -> None:
        self._stack = contextlib.ExitStack()
        self._scratch = scratch
        scratch.mkdir()
        settings = Settings(
            port=0,
            # X-Plane 12, which has all datarefs.
            version=121_000,
            person=True,
            misbehaves_in=only if misbehaves else (),
        )
        simulator = self._stack.enter_context(StandInProcess(settings))
        config = write_config(scratch, simulator.port, others="[failsafe]\nhold_s = 1.0\n")
        words = [fccd, "x-plane", "check", "--yes", "--config", config, "--json"]
        words += ["--only", ",".join(map(str, only)), "--report", scratch / "report.md"]
        words += [] if IS_FULL else ["--quick"]
        out = self._stack.enter_context((scratch / "out").open("wb"))
        err = self._stack.enter_context((scratch / "err").open("wb"))
        self._process = subprocess.Popen(
            [str(word) for word in words], stdin=subprocess.DEVNULL, stdout=out, stderr=err
        )

    def wait(self) -> tuple[int, dict[str, Any], str, str]:
        try:
            exit_code = self._process.wait(PATIENCE_S)
        finally:
            if self._process.poll() is None:
                self._process.kill()
                self._process.wait()
            self._stack.close()
        log = (self._scratch / "err").read_text()
        printed = (self._scratch / "out").read_text()
        assert printed, log
        report = json.loads(printed)
        assert report == json.loads((self._scratch / "report.json").read_text())
        return exit_code, report, (self._scratch / "report.md").read_text(), log


@dataclass(frozen=True)
class Running:
    """Everything that runs."""

    checks: dict[bool, list[Check]]
    identification: Identification


TWIN = "c310"
"""Another aircraft than the gains were tuned on: with two engines, and heavier controls."""


class Identification:
    """A running `fccd x-plane identify`, of an aircraft that a person flies."""

    def __init__(self, fccd: Path, scratch: Path) -> None:
        self._stack = contextlib.ExitStack()
        scratch.mkdir()
        simulator = self._stack.enter_context(
            StandInProcess(Settings(port=0, version=121_000, aircraft=TWIN, person=True))
        )
        config = write_config(scratch, simulator.port, x_plane="engines = 2")
        words = [fccd, "x-plane", "identify", "--by-hand", "--config", config, "--json"]
        self._process = subprocess.Popen(
            [str(word) for word in [*words, "--files", scratch / "files"]],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
        )

    def wait(self) -> dict[str, Any]:
        with self._stack:
            printed, log = self._process.communicate(timeout=PATIENCE_S)
        assert self._process.returncode == SUCCESS, log.decode()
        found: dict[str, Any] = json.loads(printed)
        return found


@pytest.fixture(scope="module")
def running(fccd: Path, tmp_path_factory: pytest.TempPathFactory) -> Running:
    """Start everything at the same time."""
    scratch = tmp_path_factory.mktemp("check")
    return Running(
        {
            misbehaves: [
                Check(fccd, scratch / f"{misbehaves}-{place}", only, misbehaves)
                for place, only in enumerate(PARTS)
            ]
            for misbehaves in (False, True)
        },
        Identification(fccd, scratch / "identify"),
    )


@pytest.fixture(scope="module")
def checks(running: Running) -> dict[bool, Checked]:
    """Return the finished checks, by whether the stand-in misbehaves."""
    ended = {}
    for misbehaves, parts in running.checks.items():
        results = [part.wait() for part in parts]
        ended[misbehaves] = Checked(
            [exit_code for exit_code, *_ in results],
            {step["number"]: step for _, report, *_ in results for step in report["steps"]},
            [markdown for _, _, markdown, _ in results],
            "\n".join(log for *_, log in results),
        )
    return ended


@pytest.mark.parametrize("number", STEPS)
def test_a_step_passes(checks: dict[bool, Checked], number: int) -> None:
    good = checks[False]
    assert good.steps[number]["outcome"] == "passed", good.why(number)
    assert good.steps[number]["why"] is None


@pytest.mark.parametrize("number", STEPS, ids=lambda n: f"{n}: {MISBEHAVIOURS[n].does}")
def test_a_step_fails_when_the_stand_in_misbehaves(
    checks: dict[bool, Checked], number: int
) -> None:
    bad = checks[True]
    assert bad.steps[number]["outcome"] == "failed", bad.why(number)
    assert bad.steps[number]["why"]
    assert bad.steps[number]["advice"]


def test_the_exit_code_and_the_report_say_how_it_ended(checks: dict[bool, Checked]) -> None:
    assert checks[False].exit_codes == [SUCCESS] * len(PARTS), checks[False].log
    assert checks[True].exit_codes == [STEP_FAILED] * len(PARTS)
    good, bad = checks[False].reports[0], checks[True].reports[0]
    assert "8 of 8 steps passed" in good
    assert "0 of 8 steps passed, 8 failed" in bad
    assert "| X-Plane | 12.1.0 |" in good
    assert 'simulator = "127.0.0.1:' in good


def test_responses_over_x_planes_protocol_are_those_of_the_aircraft(running: Running) -> None:
    """They are compared with the same deflections of JSBSim's aircraft, without X-Plane between.

    The surfaces move at a limited rate here, and replies come once a frame.
    """
    from fcc_hil.tuning.identify import answer  # noqa: PLC0415 - needs the module fcc

    found = running.identification.wait()
    measured = {one["control"]: one["response"] for one in found["responses"]}
    true = answer(TWIN)
    for control, response, share in (
        ("elevator", true.pitch_radps, 0.15),
        ("aileron", true.roll_radps, 0.15),
        ("rudder", true.yaw_radps, 0.15),
        # In steps of half the duration, up and down, from the power of level flight.
        ("throttle", true.acceleration_mps2, 0.25),
    ):
        assert measured[control] == pytest.approx(response, rel=share), measured
    scale = {one["control"]: one["scale"] for one in found["responses"]}
    reference = answer("c172p")
    assert scale["elevator"] == pytest.approx(reference.pitch_radps / true.pitch_radps, rel=0.15)


def test_without_a_person_and_without_yes_it_says_what_to_do(fccd: Path, tmp_path: Path) -> None:
    done = run_alone(fccd, tmp_path, "check")
    assert done.returncode == USAGE
    assert "--yes" in done.stderr


def test_the_page_has_every_step_once(fccd: Path) -> None:
    page = (Path(__file__).parents[2] / "docs" / "x-plane.md").read_text()
    listed = subprocess.run(
        [fccd, "x-plane", "steps", "--json"], capture_output=True, text=True, check=True
    )
    steps = json.loads(listed.stdout)
    assert [step["number"] for step in steps] == list(STEPS)
    _, _, table = page.partition("| steps | check |")
    rows, _, _ = table.partition("\n\n")
    told: list[int] = []
    for cell in re.findall(r"^\| ([0-9][^|]*) \|", rows, re.MULTILINE):
        if " to " in cell:
            first, last = map(int, cell.split(" to "))
            told += range(first, last + 1)
        else:
            told += map(int, cell.split(", "))
    assert told == list(STEPS)


@pytest.mark.parametrize(
    ("action", "why"), [("pause", "X-Plane is paused"), ("servos", "X-Plane's own autopilot")]
)
def test_identification_is_refused_where_it_would_measure_something_else(
    fccd: Path, tmp_path: Path, action: str, why: str
) -> None:
    with StandInProcess(Settings(port=0, version=121_000, person=True)) as simulator:
        simulator.act(action)
        done = identify_by_hand(fccd, tmp_path, simulator.port)
    assert done.returncode == FAILURE
    assert why in done.stderr


def test_identification_without_x_plane_says_so(fccd: Path, tmp_path: Path) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as nobody:
        nobody.bind(("127.0.0.1", 0))
        port = nobody.getsockname()[1]
        done = identify_by_hand(fccd, tmp_path, port)
    assert done.returncode == FAILURE
    assert f"nothing arrives from X-Plane at 127.0.0.1:{port}" in done.stderr


def test_a_check_without_x_plane_ends_with_its_first_step(fccd: Path, tmp_path: Path) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as nobody:
        nobody.bind(("127.0.0.1", 0))
        config = write_config(tmp_path, nobody.getsockname()[1])
        words = ["--yes", "--json", "--only", "1,2,3", "--config", str(config)]
        done = run_alone(fccd, tmp_path, "check", *words)
    steps = json.loads(done.stdout)["steps"]
    assert [step["outcome"] for step in steps] == ["failed", "skipped", "skipped"]
    assert {step["why"] for step in steps[1:]} == {"X-Plane does not answer"}


def run_alone(fccd: Path, scratch: Path, *words: str) -> subprocess.CompletedProcess[str]:
    """Run `fccd x-plane` with these words and without a terminal."""
    return subprocess.run(
        [fccd, "x-plane", *words],
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        cwd=scratch,
        check=False,
        timeout=PATIENCE_S,
    )


def identify_by_hand(fccd: Path, scratch: Path, port: int) -> subprocess.CompletedProcess[str]:
    return run_alone(
        fccd, scratch, "identify", "--by-hand", "--config", str(write_config(scratch, port))
    )


def test_a_report_that_cannot_be_written_is_refused_before_the_steps(
    fccd: Path, tmp_path: Path
) -> None:
    (tmp_path / "folder").mkdir()
    # Nobody answers there: a step would fail with another exit code.
    words = ["--yes", "--only", "1", "--report", str(tmp_path / "folder")]
    done = run_alone(fccd, tmp_path, "check", *words)
    assert done.returncode == FAILURE
    assert "the report cannot be written" in done.stderr
