"""The effect of faults on a sensor, sample by sample."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fcc_hil import airspeed, altitude, climb, heading
from fcc_hil.datarefs import withheld
from fcc_hil.faulty_sensors import FaultySensors
from fcc_hil.plant import Plant
from fcc_hil.quantities import QUANTITIES, SENSORS
from fcc_hil.sensor_faults import Faults
from fcc_hil.state import State

Break = Callable[[Faults], object]


@pytest.fixture(scope="module")
def level() -> State:
    return Plant("c172p").state()


def _said(level: State, break_it: Break, samples: int = 6) -> list[float | None]:
    """Sample an altimeter that shows 0, 1, 2, ... m, once a second; None is nothing."""
    sensors = FaultySensors()
    break_it(Faults(lambda: 0.0, sensors.set_faults))
    said: list[float | None] = []
    for k in range(samples):
        state, missing = sensors.read(float(k), replace(level, altitude_m=float(k)))
        assert state is not None
        assert state.airspeed_mps == level.airspeed_mps, "the others are left alone"
        said.append(None if "altitude_m" in missing else state.altitude_m)
    return said


@pytest.mark.parametrize(
    ("break_it", "said"),
    [
        (lambda f: f.loss(altitude), [None] * 6),
        (lambda f: f.loss(altitude, after=2, lasts=2), [0, 1, None, None, 4, 5]),
        (lambda f: f.freeze(altitude, after=2, lasts=3), [0, 1, 2, 2, 2, 5]),
        (lambda f: f.bias(altitude("m"), by=10, after=4), [0, 1, 2, 3, 14, 15]),
        (lambda f: f.bias(altitude, by=-100, after=5), [0, 1, 2, 3, 4, 5 - 30.48]),
        (lambda f: f.delay(altitude, by=2), [None, None, 0, 1, 2, 3]),
        (lambda f: f.duplicate(altitude, after=1), [0, 1, 1, 2, 3, 4]),
        (lambda f: f.reorder(altitude), [None, 0, None, 2, None, 4]),
        (lambda f: f.noise(altitude, sigma=0), [0, 1, 2, 3, 4, 5]),
        (lambda f: f.round(altitude("m"), to=4), [0, 0, 0, 4, 4, 4]),
        (lambda f: f.slow(altitude, to_hz=0.5), [0, None, 2, None, 4, None]),
        (lambda f: (f.delay(altitude, by=1), f.bias(altitude("m"), by=7)), [None, 7, 8, 9, 10, 11]),
        (lambda f: (f.loss(altitude), f.end()), [0, 1, 2, 3, 4, 5]),
    ],
)
def test_the_effect_on_a_sensor_that_counts(
    level: State, break_it: Break, said: list[float | None]
) -> None:
    assert _said(level, break_it) == pytest.approx(said)


def test_not_a_number(level: State) -> None:
    said = _said(level, lambda f: f.nan(altitude, after=1), samples=2)
    assert said[0] == 0.0
    assert said[1] is not None
    assert math.isnan(said[1])


def test_a_share_of_1_affects_every_sample(level: State) -> None:
    sensors = FaultySensors()
    Faults(lambda: 0.0, sensors.set_faults).loss("everything", after=1)
    assert sensors.read(0.0, level) == (level, frozenset())
    assert sensors.read(1.0, level)[0] is None


def test_a_share_is_met_and_repeatable(level: State) -> None:
    """Of 2,000 draws at 0.3, five standard deviations are 0.051."""
    once = _said(level, lambda f: f.loss(altitude, share=0.3), samples=2_000)
    again = _said(level, lambda f: f.loss(altitude, share=0.3), samples=2_000)
    assert once == again
    assert once.count(None) / len(once) == pytest.approx(0.3, abs=0.051)


def test_noise_is_white_with_its_deviation(level: State) -> None:
    said = _said(level, lambda f: f.noise(altitude, sigma=10), samples=4_000)
    errors = np.array(said, dtype=float) - np.arange(4_000)
    assert np.std(errors) == pytest.approx(10 * 0.3048, rel=0.06)
    assert abs(np.mean(errors)) < 5 * 3.048 / math.sqrt(4_000)
    assert abs(np.corrcoef(errors[1:], errors[:-1])[0, 1]) < 5 / math.sqrt(4_000)


def test_a_heading_stays_a_heading(level: State) -> None:
    sensors = FaultySensors()
    Faults(lambda: 0.0, sensors.set_faults).bias(heading, by=20)
    state, _ = sensors.read(0.0, replace(level, heading_rad=math.radians(350.0)))
    assert state is not None
    assert math.degrees(state.heading_rad) == pytest.approx(10.0)


@pytest.mark.parametrize("sensor", SENSORS)
def test_every_sensor_has_datarefs_to_withhold(sensor: str) -> None:
    assert len(withheld(frozenset(SENSORS[sensor]))) >= len(SENSORS[sensor])


KINDS = ("loss", "delay", "duplicate", "reorder", "freeze", "nan", "bias", "noise")
_NEEDED = {"delay": {"by": 0.1}, "bias": {"by": 1.0}, "noise": {"sigma": 1.0}}


def _make(kind: str, sensor: object = "altitude", **others: object) -> object:
    faults = Faults(lambda: 0.0, lambda _: None)
    arguments: dict[str, object] = {**_NEEDED.get(kind, {}), **others}
    return getattr(faults, kind)(sensor, **arguments)


@given(
    kind=st.sampled_from(KINDS),
    name=st.sampled_from(["after", "lasts", "share", "by", "sigma"]),
    value=st.one_of(
        st.sampled_from([math.nan, math.inf, -math.inf, "1", [], True]),
        st.floats(max_value=-1e-9, allow_nan=False),
    ),
)
def test_bad_amounts_are_refused_by_name(kind: str, name: str, value: object) -> None:
    known = {
        "after": KINDS,
        "lasts": KINDS,
        "share": ("loss", "duplicate", "reorder"),
        "by": ("delay",),
        "sigma": ("noise",),
    }
    if kind not in known[name]:
        return
    with pytest.raises((TypeError, ValueError), match=f"^{name} is "):
        _make(kind, **{name: value})


@given(kind=st.sampled_from(KINDS), name=st.text().filter(lambda name: name not in QUANTITIES))
def test_sensors_that_do_not_exist_are_refused(kind: str, name: str) -> None:
    if name == "everything":
        return
    with pytest.raises(ValueError, match=r"there is no quantity .*heading"):
        _make(kind, name)


def test_quantities_without_a_sensor_have_no_faults() -> None:
    with pytest.raises(ValueError, match="no sensor measures climb"):
        _make("loss", climb)
    with pytest.raises(ValueError, match="only its loss"):
        _make("bias", "everything")
    with pytest.raises(ValueError, match="at most 60 s"):
        _make("delay", airspeed, by=61)
    with pytest.raises(ValueError, match="above 0 and up to 1"):
        _make("loss", airspeed, share=1.5)
