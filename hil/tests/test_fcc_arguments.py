"""Any argument to the module `fcc` gives a result or an exception with a message."""

from __future__ import annotations

import math
import subprocess
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import fcc
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

HOLD = '[guidance]\nmode = "hold"\n'
WIDTH = len(fcc.MEASUREMENTS)
LEVEL = fcc.BuiltInAircraft().step(None)

numbers = st.one_of(
    st.floats(),
    st.sampled_from([math.nan, math.inf, -math.inf, 0.0, -0.0, -1.0, 1e308, 5e-324]),
    st.integers(-(10**30), 10**30),
)
things = st.one_of(
    numbers,
    st.none(),
    st.booleans(),
    st.text(max_size=8),
    st.binary(max_size=8),
    st.lists(numbers, max_size=12),
    st.lists(st.lists(numbers, max_size=12), max_size=4),
    st.dictionaries(st.text(max_size=4), numbers, max_size=2),
    st.just(object()),
    st.builds(np.zeros, st.tuples(st.integers(0, 3), st.integers(0, 12))),
    st.just(np.array(["a"])),
    st.just(np.array([1 + 2j])),
)

ALLOWED = (fcc.Error, ValueError, TypeError, OverflowError)


def answers(call: Callable[[], Any]) -> None:
    """Return, or raise one of the permitted exceptions with a message."""
    words = "answered"
    try:
        call()
    except ALLOWED as error:
        words = str(error)
    assert words.strip()


def engaged() -> fcc.Autopilot:
    autopilot = fcc.Autopilot(HOLD)
    for _ in range(50):
        autopilot.observe(LEVEL)
    autopilot.engage(LEVEL, throttle=0.6)
    return autopilot


ONE: dict[str, Callable[..., Any]] = {
    "Autopilot": fcc.Autopilot,
    "Autopilot.observe dt": lambda dt: engaged().observe(LEVEL, dt),
    "Autopilot.engage": lambda given: engaged().engage(LEVEL, throttle=given),
    "Autopilot.step dt": lambda dt: engaged().step(LEVEL, dt),
    "Fleet": fcc.Fleet,
    "Machine": fcc.Machine,
    "Machine.step": lambda given: fcc.Machine().step(given),
    "Machine.step missing": lambda given: fcc.Machine().step(LEVEL, missing=given),
    "Machine.step readback": lambda given: fcc.Machine().step(LEVEL, readback=given),
    "Machine.step switch": lambda given: fcc.Machine().step(LEVEL, switch=given),
    "BuiltInAircraft": fcc.BuiltInAircraft,
    "BuiltInAircraft.step dt": lambda dt: fcc.BuiltInAircraft().step(None, dt),
    "Measurements": lambda given: fcc.Measurements(pitch_rad=given),
    "Measurements.from_array": fcc.Measurements.from_array,
    "Config": fcc.Config,
    "Config.load": fcc.Config.load,
    "Config[]": lambda given: fcc.Config()[given],
    "Config.replace gain": lambda given: fcc.Config().replace({"loop.rate_hz": given}),
    "fly seconds": lambda given: fcc.fly(seconds=given if given in (0, None) else math.nan),
    "fly config": lambda given: fcc.fly(given, seconds=0.1),
    "LowPass": fcc.LowPass,
    "LowPass.reset": lambda given: fcc.LowPass(1.0).reset(given),
    "HighPass": fcc.HighPass,
    "RateLimit": fcc.RateLimit,
    "Complementary": fcc.Complementary,
    "SquareRootProfile.speed": lambda given: fcc.SquareRootProfile(1.0, 1.0).speed(given),
    "pressure_pa": fcc.pressure_pa,
    "pressure_altitude_m": fcc.pressure_altitude_m,
    "density_ratio": fcc.density_ratio,
    "wrap_pi": fcc.wrap_pi,
    "wrap_two_pi": fcc.wrap_two_pi,
    "euler_from_quaternion": fcc.euler_from_quaternion,
    "Recording": fcc.Recording,
    "list_recordings": fcc.list_recordings,
    "recover": fcc.recover,
    "report": fcc.report,
    "Watcher": fcc.Watcher,
    "Commander": fcc.Commander,
}
"""Functions of one argument."""
TWO: dict[str, Callable[..., Any]] = {
    "Autopilot.observe": lambda a, b: engaged().observe(a, b),
    "Autopilot.observe_series": lambda a, b: engaged().observe_series(a, b),
    "Autopilot.fly": lambda a, b: engaged().fly(a, b),
    "Autopilot.failsafe": lambda a, b: engaged().failsafe(a, b),
    "Autopilot.command": lambda a, b: engaged().command(airspeed_mps=a, heading_rad=b),
    "Fleet.engage": lambda a, b: fcc.Fleet([HOLD]).engage(a, b),
    "Fleet.observe": lambda a, b: fcc.Fleet([HOLD]).observe(a, b),
    "Fleet.step": lambda a, b: fcc.Fleet([HOLD]).step(a, b),
    "Machine.command": lambda a, b: fcc.Machine().command(altitude_m=a, heading_rad=b),
    "BuiltInAircraft.step": lambda a, b: fcc.BuiltInAircraft().step(a, b),
    "Surfaces": lambda a, b: fcc.Surfaces(throttle=a, elevator=b),
    "Config.replace": lambda a, b: fcc.Config().replace({a: b}),
    "Pid": fcc.Pid,
    "Pid limits": lambda a, b: fcc.Pid(output_min=a, output_max=b),
    "Pid.step": lambda a, b: fcc.Pid(1.0).step(a, 0.0, b),
    "Pid.engage": lambda a, b: fcc.Pid(1.0).engage(a, b, 0.0),
    "LowPass.step": lambda a, b: fcc.LowPass(1.0).step(a, b),
    "LowPass.run": lambda a, b: fcc.LowPass(1.0).run(a, b),
    "HighPass.step": lambda a, b: fcc.HighPass(1.0).step(a, b),
    "HighPass.run": lambda a, b: fcc.HighPass(1.0).run(a, b),
    "RateLimit.step": lambda a, b: fcc.RateLimit(1.0).step(a, b),
    "RateLimit.run": lambda a, b: fcc.RateLimit(1.0).run(a, b),
    "Complementary.predict": lambda a, b: fcc.Complementary(1.0).predict(a, b),
    "Complementary.correct": lambda a, b: fcc.Complementary(1.0).correct(a, b),
    "SquareRootProfile": fcc.SquareRootProfile,
    "true_airspeed_mps": fcc.true_airspeed_mps,
    "quaternion_from_euler": lambda a, b: fcc.quaternion_from_euler(a, b, 0.0),
    "body_to_earth": fcc.body_to_earth,
    "earth_to_body": fcc.earth_to_body,
    "Timer": fcc.Timer,
    "replay": fcc.replay,
}
"""Functions of two arguments."""


@pytest.mark.parametrize("name", ONE)
@settings(max_examples=60, deadline=None)
@given(thing=things)
def test_any_argument_gives_a_result_or_an_error(name: str, thing: object) -> None:
    answers(lambda: ONE[name](thing))


@pytest.mark.parametrize("name", TWO)
@settings(max_examples=60, deadline=None)
@given(a=things, b=things)
def test_any_two_arguments_give_a_result_or_an_error(name: str, a: object, b: object) -> None:
    answers(lambda: TWO[name](a, b))


FINITE = ["LowPass.step", "Pid.step", "RateLimit.step", "wrap_pi", "pressure_pa", "density_ratio"]


@pytest.mark.parametrize("name", FINITE)
@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_an_argument_that_is_not_finite_is_named(name: str, value: float) -> None:
    with pytest.raises(ValueError, match=r"is (NaN|-?inf)"):
        ONE[name](value) if name in ONE else TWO[name](value, 0.025)


@given(
    shape=st.tuples(st.integers(0, 5), st.integers(0, 20)).filter(lambda shape: shape[1] != WIDTH)
)
def test_a_wrong_shape_is_reported_with_the_right_one(shape: tuple[int, int]) -> None:
    words = rf"measurements is of shape \({shape[0]}, {shape[1]}\): give \(n, {WIDTH}\)"
    with pytest.raises(ValueError, match=words):
        engaged().fly(np.zeros(shape))
    with pytest.raises(ValueError, match="one for each of the 2 autopilots"):
        fcc.Fleet([HOLD, HOLD]).step(np.zeros((3, WIDTH)))


@given(dt=numbers.filter(lambda dt: not 0 < dt <= 1))
def test_a_wrong_step_is_refused(dt: float) -> None:
    for call in (engaged().step, engaged().observe):
        with pytest.raises((ValueError, OverflowError)):
            call(LEVEL, dt)


def test_ranges_are_reported() -> None:
    log: dict[Callable[[], object], str] = {
        (lambda: fcc.pressure_pa(30_000.0)): "altitude_m is 30000: choose -500 to 20000",
        (lambda: fcc.pressure_altitude_m(-1.0)): "pressure_pa is -1: choose 1000 to 120000",
        (lambda: fcc.Timer(0.0)): "period_s is 0: choose 0.00001 to 3600",
        (lambda: fcc.Timer(0.01, "hpet")): "choose timerfd, posix or nanosleep",
        (lambda: fcc.Surfaces(throttle=1.2)): "throttle is 1.2: choose 0 to 1",
        (lambda: engaged().command(altitude_m=9e9)): "altitude_m is 9000000000: choose",
        (lambda: engaged().command(heading_rad=1e308)): "heading_rad is 1e308: choose -12.57",
        (lambda: fcc.Machine().command(heading_rad=13.0)): "heading_rad is 13: choose -12.57",
        (lambda: fcc.fly(seconds=-1.0)): "seconds is -1",
        (lambda: fcc.Pid(output_min=1.0, output_max=0.0)): "the first must be less",
        (lambda: fcc.euler_from_quaternion([0, 0, 0, 0])): "has the length 0",
        (lambda: fcc.Machine().step(None, missing=["tail"])): "there is no reading 'tail'",
        (lambda: fcc.Machine().step(None, missing="airspeed")): r"give a list .* \['airspeed'\]",
        (lambda: setattr(LEVEL, "pitch_rad", "up")): "pitch_rad: must be real number, not str",
        (lambda: fcc.Surfaces(slats=1.0)): "has no 'slats': choose of throttle, elevator",  # type: ignore[call-arg]
    }
    for call, words in log.items():
        with pytest.raises((ValueError, TypeError), match=words):
            call()


def test_an_invalid_configuration_gives_the_daemons_message(fccd: Path, tmp_path: Path) -> None:
    bad = tmp_path / "bad.toml"
    for text in (
        "[built-in]\nseed = -1\n",
        "[autopilot]\nbank = 3\n[built-in]\n",
        "[built-in\n",
        "[loop]\nrate_hz = nan\n",
        "",
    ):
        bad.write_text(text)
        log = subprocess.run([fccd, "check", bad], capture_output=True, text=True, check=False)
        with pytest.raises(fcc.ConfigError) as refused:
            fcc.Config.load(bad)
        assert str(refused.value) == log.stderr.strip()
    with pytest.raises(fcc.ConfigError, match="cannot be read"):
        fcc.Config.load(tmp_path / "none.toml")
    assert issubclass(fcc.ConfigError, ValueError)


@settings(max_examples=60, deadline=None)
@given(head=st.sampled_from([b"", b"\x89MCAP0\r\n"]), tail=st.binary(max_size=200))
def test_any_bytes_are_refused_without_a_crash(head: bytes, tail: bytes) -> None:
    content = head + tail
    with tempfile.NamedTemporaryFile(suffix=".mcap") as file:
        file.write(content)
        file.flush()
        for read in (fcc.Recording, fcc.report, fcc.replay, fcc.recover):
            # With the magic number it may be a recording that was cut.
            with pytest.raises(fcc.RecordingError, match=r"not a recording of fccd|cut off after"):
                read(file.name)


def test_a_file_that_cannot_be_read_is_refused(tmp_path: Path) -> None:
    for call in (fcc.Recording, fcc.recover, fcc.report, fcc.replay):
        with pytest.raises(fcc.RecordingError, match="cannot be read"):
            call(tmp_path / "none.mcap")
    with pytest.raises(fcc.RecordingError, match="cannot be listed"):
        fcc.list_recordings(tmp_path / "none")


def test_a_name_given_for_a_text_is_told() -> None:
    with pytest.raises(fcc.ConfigError, match=r"'config/a\.toml' is the name of a file"):
        fcc.fly("config/a.toml")
    with pytest.raises(fcc.PlanError, match=r"'a\.plan' is the name of a file"):
        fcc.Plan("a.plan")


def test_every_exception_is_an_error_of_the_module() -> None:
    for name in ("Config", "Engage", "Flight", "Recording", "Telemetry", "Command", "Timer"):
        assert issubclass(getattr(fcc, f"{name}Error"), fcc.Error)
    assert fcc.Error.__module__ == "fcc"


def test_a_plan_that_cannot_be_read_is_an_os_error_with_its_name(tmp_path: Path) -> None:
    missing = tmp_path / "none.waypoints"
    for call in (fcc.Plan.read, fcc.Machine("").replace_plan):
        with pytest.raises(FileNotFoundError) as raised:
            call(missing)
        assert str(raised.value.filename) == str(missing)
        assert "(os error" not in str(raised.value)
