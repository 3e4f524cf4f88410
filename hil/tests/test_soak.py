"""The soak: what it counts, and a short one in real time."""

from __future__ import annotations

import json
import os
from dataclasses import replace
from pathlib import Path

import pytest

from fcc_hil.__main__ import main
from fcc_hil.soak import Machine, Result, periods_lost

GOOD = Result(
    ticks=180_000,
    missed=0,
    lateness_us={"p50": 0.02, "p99": 0.1, "p99_9": 1.0, "max": 400.0},
    within_2_percent=1.0,
    page_faults=0,
    voluntary_switches_per_tick=1.0,
    involuntary_switches=0,
    cpu_percent=2.0,
    exit_code=0,
    machine=Machine(cycles=180_000, max_us=400.0, periods_lost=0),
)


def test_whole_periods_of_lateness_are_lost_ones() -> None:
    # As cyclictest writes it: microseconds to how often.
    histogram = {"17": 3, "9999": 1, "10000": 2, "29999": 1, "516576": 1}
    assert periods_lost(histogram, 10_000.0) == 2 + 2 + 51


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        (replace(GOOD, page_faults=1), "1 page faults"),
        (replace(GOOD, missed=10), "10 ticks missed, where the machine lost 0"),
        (replace(GOOD, voluntary_switches_per_tick=1.01), "1.0100 waits in a tick"),
        (replace(GOOD, exit_code=9), "exit code 9"),
    ],
)
def test_what_is_not_as_it_should_be_is_said(wrong: Result, words: str) -> None:
    assert GOOD.failures() == []
    (failure,) = wrong.failures()
    assert words in failure


def test_what_the_machine_lost_too_is_no_failure() -> None:
    machine = replace(GOOD.machine, periods_lost=50)
    assert replace(GOOD, missed=55, machine=machine).failures() == []
    assert replace(GOOD, missed=90, machine=machine).failures() != []


# cyclictest needs a right to real-time scheduling that not everybody has.
_CYCLICTEST = """#!/bin/sh
for word; do case $word in --json=*) file=${word#--json=} ;; esac; done
trap 'echo "{\\"thread\\": {\\"0\\": $measured}}" > "$file"; exit' TERM
measured='{"histogram": {"30": 299, "25000": 1}, "cycles": 300, "max": 25000}'
while :; do sleep 0.05; done
"""


def test_a_short_soak_never_waits_for_anything_but_the_timer(
    fccd: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    cyclictest = tmp_path / "cyclictest"
    cyclictest.write_text(_CYCLICTEST)
    cyclictest.chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path), prepend=os.pathsep)
    written = tmp_path / "soak.json"
    main(["soak", "--fccd", str(fccd), "--minutes", "0.05", "--idle", "--json", str(written)])
    figures = json.loads(written.read_text())
    # How late it was is the machine's affair; that it did not wait is ours.
    assert figures["ticks"] > 200
    assert figures["page_faults"] == 0
    assert 0.5 < figures["voluntary_switches_per_tick"] <= 1.05
    assert figures["exit_code"] == 0
    assert figures["machine"] == {"cycles": 300, "max_us": 25000, "periods_lost": 2}
    assert "waits" in capsys.readouterr().out
