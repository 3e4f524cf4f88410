"""The soak: its counts, and a short one in real time."""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from fcc_hil.__main__ import main
from fcc_hil.rig import FlightError
from fcc_hil.soak import Machine, Result, Soak, periods_lost, soak

GOOD = Result(
    ticks=180_000,
    missed=0,
    overruns=0,
    lateness_us={"p50": 0.02, "p99": 0.1, "p99_9": 1.0, "max": 400.0},
    within_2_percent=1.0,
    page_faults=0,
    memory_locked=True,
    watched_ticks=180_000,
    voluntary_switches_per_tick=1.0,
    involuntary_switches=0,
    cpu_percent=2.0,
    exit_code=0,
    cpus="0",
    machine=Machine(cycles=180_000, max_us=400.0, periods_lost=0, longest_periods=0),
)


def test_whole_periods_of_lateness_are_lost_ones() -> None:
    # As cyclictest writes it: microseconds to how often.
    histogram = {"17": 3, "9999": 1, "10000": 2, "29999": 1, "516576": 1}
    assert periods_lost(histogram, 516_576.0, 10_000.0) == 2 + 2 + 51


def test_periods_beyond_the_histogram_are_counted() -> None:
    # cyclictest omits it from its JSON, except for the maximum.
    assert periods_lost({"17": 3}, 2_345_678.0, 10_000.0) == 234


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        (replace(GOOD, page_faults=1), "1 page faults"),
        (replace(GOOD, missed=10), "10 ticks missed, where the machine lost 0"),
        (replace(GOOD, memory_locked=False, page_faults=7), "the memory was not locked"),
        (
            replace(GOOD, voluntary_switches_per_tick=(180_000 + 20) / 180_000),
            "1.000111 waits in a tick",
        ),
        (replace(GOOD, exit_code=9), "exit code 9"),
    ],
)
def test_failures_are_described(wrong: Result, words: str) -> None:
    assert GOOD.failures() == []
    (failure,) = wrong.failures()
    assert words in failure


def test_periods_that_the_machine_lost_are_no_failure() -> None:
    machine = replace(GOOD.machine, periods_lost=50)
    assert replace(GOOD, missed=55, machine=machine).failures() == []
    assert replace(GOOD, missed=90, machine=machine).failures() != []
    # One stop of 20 periods more, which only one of the two was there to see.
    machine = replace(machine, longest_periods=20)
    assert replace(GOOD, missed=90, machine=machine).failures() == []
    assert replace(GOOD, missed=111, machine=machine).failures() != []


@pytest.mark.parametrize(
    ("cpus", "own"), [("0", True), ("13", True), ("0-1", False), ("0,2", False)]
)
def test_one_cpu_is_its_own(cpus: str, own: bool) -> None:
    assert replace(GOOD, cpus=cpus).has_own_cpu is own


# cyclictest needs a right to real-time scheduling that not everybody has.
_CYCLICTEST = """#!/bin/sh
for word; do case $word in --json=*) file=${word#--json=} ;; esac; done
trap 'echo "{\\"thread\\": {\\"0\\": $measured}}" > "$file"; exit' TERM
measured='{"histogram": {"30": 299, "25000": 1}, "cycles": 300, "max": 25000}'
while :; do sleep 0.05; done
"""
_REFUSED = "#!/bin/sh\necho 'missing capabilities' >&2\nexit 1\n"


@pytest.fixture
def programs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[str, str], None]:
    """Return what puts a program before those of the machine."""
    monkeypatch.setenv("PATH", str(tmp_path), prepend=os.pathsep)

    def put(name: str, text: str) -> None:
        (tmp_path / name).write_text(text)
        (tmp_path / name).chmod(0o755)

    return put


def test_a_short_soak_never_waits_for_anything_but_the_timer(
    fccd: Path,
    tmp_path: Path,
    programs: Callable[[str, str], None],
    capsys: pytest.CaptureFixture[str],
) -> None:
    programs("cyclictest", _CYCLICTEST)
    written = tmp_path / "soak.json"
    main(["soak", "--fccd", str(fccd), "--minutes", "0.05", "--idle", "--json", str(written)])
    figures = json.loads(written.read_text())
    # Lateness depends on the machine; waiting does not.
    assert figures["ticks"] > 200
    assert figures["watched_ticks"] >= 300
    if figures["memory_locked"]:
        assert figures["page_faults"] == 0
    assert 0.5 < figures["voluntary_switches_per_tick"] <= 1.02
    assert figures["exit_code"] == 0
    assert figures["machine"] == {
        "cycles": 300,
        "max_us": 25000,
        "periods_lost": 2,
        "longest_periods": 2,
    }
    assert "waits" in capsys.readouterr().out


@pytest.mark.parametrize("refused", ["cyclictest", "stress-ng"])
def test_a_flight_ends_if_a_background_program_ends(
    fccd: Path, programs: Callable[[str, str], None], refused: str
) -> None:
    for name in ("cyclictest", "stress-ng"):
        programs(name, _REFUSED if name == refused else _CYCLICTEST)
    with pytest.raises(FlightError, match=f"{refused} ended with 1: missing capabilities"):
        soak(Soak(fccd, 600.0, 100, stress=True), lambda _: None)


@pytest.mark.parametrize(
    ("there", "missing"), [("stress-ng", "cyclictest"), ("cyclictest", "stress-ng")]
)
def test_a_missing_program_is_reported_before_the_flight(
    programs: Callable[[str, str], None],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    there: str,
    missing: str,
) -> None:
    programs(there, _CYCLICTEST)
    # Found by its name, although it is `nice` that starts it.
    programs("nice", _CYCLICTEST)
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(FlightError, match=f"{missing} is missing"):
        soak(Soak(Path("fccd"), 600.0, 100, stress=True), lambda _: None)
