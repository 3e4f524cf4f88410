"""The configuration of a model aircraft is valid, and its page lists each key of the airframe."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import fcc

ROOT = Path(__file__).parents[2]
CONFIG = ROOT / "config/model-2m.toml"
PAGE = (ROOT / "docs/own-aircraft.md").read_text()
AIRFRAME = ("autopilot", "plan", "contingency")


def test_it_is_accepted(fccd: Path) -> None:
    assert subprocess.run([fccd, "check", CONFIG], check=False).returncode == 0


def test_the_page_lists_each_key_of_the_airframe_with_its_value() -> None:
    rows = [line.split("|")[1:4] for line in PAGE.splitlines() if line.startswith("| `")]
    listed = {
        key: (value, keys)
        for keys, _, value in rows
        for key in re.findall(r"`([a-z][\w.]+)`", keys)
    }
    given = fcc.Config(CONFIG.read_text())
    section = ""
    for line in CONFIG.read_text().splitlines():
        if header := re.match(r"\[+([\w.-]+)", line):
            section = header[1]
        elif (key := re.match(r"(\w+) = ", line)) and section.split(".")[0] in AIRFRAME:
            name = f"{section}.{key[1]}"
            assert name in listed, name
            value = given[name]
            shown = "false" if value is False else f"{value:g}"
            assert re.search(rf"(?<![\d.]){re.escape(shown)}(?![\d])", listed[name][0]), name


def test_the_scales_follow_from_what_was_measured() -> None:
    given = fcc.Config(CONFIG.read_text())
    cruise_mps = given["autopilot.reference_airspeed_kt"] * 0.514444
    assert abs(given["autopilot.scale.aileron"] - 4.7 / (cruise_mps / 2.0)) < 0.01
    assert abs(given["autopilot.scale.elevator"] - 10.7 / (cruise_mps / 1.0)) < 0.01
    assert abs(given["autopilot.scale.throttle"] - 0.34 / 0.45) < 0.01
