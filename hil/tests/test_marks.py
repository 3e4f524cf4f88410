"""The marks of a test: their effect, and wrong arguments."""

from __future__ import annotations

import math
from typing import Any

import fcc
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fcc_hil.aircraft import AIRCRAFT
from fcc_hil.marks import aircraft_mark, autopilot_mark
from fcc_hil.pattern import TimedPattern
from fcc_hil.plant import Weather


def test_the_aircraft_of_a_mark() -> None:
    settings = aircraft_mark("c172x", wind=(270, 10), turbulence=3, seed=7, noise=True, heading=90)
    assert (settings.aircraft, settings.seed, settings.noise) == ("c172x", 7, True)
    assert settings.heading_deg == 90.0
    assert settings.weather == Weather(270.0, 10.0, 3)


def test_the_autopilot_of_a_mark() -> None:
    mark = autopilot_mark(hold_s=5, leg_s=15, turn_deg=-45, climb_ft=0, failsafe_hold_s=2)
    assert mark.pattern == TimedPattern(5.0, 15.0, -45.0, 0.0)
    assert autopilot_mark("hold").pattern is None


@given(
    mode=st.sampled_from(["timed-pattern", "hold"]),
    hold_s=st.floats(0.0, 86_400.0),
    leg_s=st.floats(1.0, 86_400.0),
    turn_deg=st.floats(-179.0, 179.0),
    climb_ft=st.floats(-5_000.0, 5_000.0),
    failsafe_hold_s=st.floats(0.0, 600.0),
    all_silent_s=st.floats(0.25, 600.0),
    degraded_s=st.floats(0.0, 600.0),
)
def test_the_daemon_accepts_what_a_mark_accepts(mode: str, **others: float) -> None:
    fcc.Machine(autopilot_mark(mode, **others).toml())  # type: ignore[arg-type]


def test_keys_of_failsafe_are_added_to_those_of_the_mark() -> None:
    more = '[loop]\nrate_hz = 100\n[failsafe]\nend = "glide"\n[engage]\nstick_takeover = 0.5\n'
    config = fcc.Config(autopilot_mark("hold", degraded_s=60, config=more).toml())
    assert config["failsafe.degraded_s"] == 60
    assert config["failsafe.end"] == "glide"
    assert config["engage.stick_takeover"] == 0.5


BAD: st.SearchStrategy[Any] = st.sampled_from(
    [math.nan, math.inf, -math.inf, 1e9, -1e9, "1", None, []]
)


@given(
    name=st.sampled_from(
        ["hold_s", "leg_s", "turn_deg", "climb_ft", "failsafe_hold_s", "all_silent_s"]
    ),
    value=BAD,
)
def test_an_impossible_autopilot_is_refused_by_name(name: str, value: float) -> None:
    with pytest.raises((TypeError, ValueError), match=f"^{name} is "):
        autopilot_mark(**{name: value})  # type: ignore[arg-type]


@given(name=st.sampled_from(["wind", "turbulence", "seed", "heading"]), value=BAD)
def test_an_impossible_aircraft_is_refused_by_name(name: str, value: float) -> None:
    with pytest.raises((TypeError, ValueError), match=f"^{name} is "):
        aircraft_mark(**{name: value})  # type: ignore[arg-type]


@given(wind=st.tuples(BAD, BAD))
def test_an_impossible_wind_is_refused(wind: tuple[float, float]) -> None:
    with pytest.raises((TypeError, ValueError), match=r"^wind from is "):
        aircraft_mark(wind=wind)


@given(name=st.text().filter(lambda name: name not in AIRCRAFT))
def test_an_unknown_aircraft_is_refused(name: str) -> None:
    with pytest.raises(ValueError, match="choose one of: c172p"):
        aircraft_mark(name)


def test_other_wrong_arguments_are_refused() -> None:
    with pytest.raises(ValueError, match=r"timed-pattern or hold"):
        autopilot_mark("loops")
    with pytest.raises(TypeError, match=r"^config is"):
        autopilot_mark(config=3)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match=r"^noise is"):
        aircraft_mark(noise="much")  # type: ignore[arg-type]
    with pytest.raises(TypeError, match=r"^aircraft is"):
        aircraft_mark(3)  # type: ignore[arg-type]
