"""`fcc.navigate` says which source of a flight is wrong, and how: axes, units, repeated values."""

from __future__ import annotations

import warnings
from typing import Any

import fcc
import numpy as np
import pytest
from test_fcc_navigate import GRAVITY_MPS2, SPEED_MPS, in_axes


def flown() -> dict[str, Any]:
    """Return 150 s of turns, climbs and sideslip without wind at 47 degrees north."""
    t = np.arange(0.0, 150.0, 0.02)
    noise = np.random.default_rng(2027)
    rate = 0.1 * np.sin(t / 6.0) + 0.08 * np.sin(t / 2.3)
    heading, pitch = np.cumsum(rate) * 0.02, 0.1 * np.sin(t / 7.0)
    roll = np.arctan(SPEED_MPS * rate / GRAVITY_MPS2)
    speed = SPEED_MPS + 3.0 * np.sin(t / 9.0)
    course = heading + 0.02 * np.sin(t / 0.7)
    level = speed * np.cos(pitch)
    velocity = np.array([level * np.cos(course), level * np.sin(course), -speed * np.sin(pitch)])
    force = np.gradient(velocity, 0.02, axis=1) - [[0.0], [0.0], [GRAVITY_MPS2]]
    field = np.array([21.0, 1.0, 43.0])[:, None]
    angles = list(zip(roll, pitch, heading, strict=True))
    quaternions = [fcc.quaternion_from_euler(*each) for each in angles]

    def in_body(vectors: Any, sigma: float) -> Any:
        columns = np.broadcast_to(vectors, velocity.shape).T
        turned = [fcc.earth_to_body(q, v) for q, v in zip(quaternions, columns, strict=True)]
        return np.array(turned) + noise.normal(0.0, sigma, (len(t), 3))

    d_roll, d_pitch = np.gradient(roll, 0.02), np.gradient(pitch, 0.02)
    across = rate * np.cos(pitch)
    rates = np.array(
        [
            d_roll - rate * np.sin(pitch),
            d_pitch * np.cos(roll) + across * np.sin(roll),
            across * np.cos(roll) - d_pitch * np.sin(roll),
        ]
    ).T
    metres = np.cumsum(velocity, axis=1) * 0.02
    place = np.array([0.8203 + metres[0] / 6.37e6, metres[1] / 4.36e6, 500.0 - metres[2]])
    fixes = slice(None, None, 10)
    pressure = 101_325.0 * (1.0 - 2.25577e-5 * place[2]) ** 5.25588
    density = 1.225 * (1.0 - 2.25577e-5 * place[2]) ** 4.25588
    return {
        "gyroscope": (t, rates + noise.normal(0.0, 0.002, rates.shape)),
        "accelerometer": (t, in_body(force, 0.05)),
        "magnetometer": (t, in_body(field, 0.3) + np.array([3.0, -2.0, 1.0])),
        "static_pressure": (t, pressure + noise.normal(0.0, 3.0, len(t))),
        "differential_pressure": (t, 0.5 * density * speed**2),
        "gnss_position": (t[fixes], place.T[fixes]),
        "gnss_velocity": (t[fixes], velocity.T[fixes]),
    }


FLOWN = flown()


@pytest.mark.filterwarnings("error")
def test_of_turns_and_climbs_nothing_is_said() -> None:
    fcc.navigate(**FLOWN)
    fcc.navigate(**{name: source for name, source in FLOWN.items() if name != "magnetometer"})


def told(sources: dict[str, Any]) -> list[str]:
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        fcc.navigate(**sources)
    return [str(one.message) for one in told]


SWAPPED = [(-1, 2, 3), (1, -2, 3), (1, 2, -3), (-1, -2, 3), (2, 1, 3), (-1, -2, -3)]
"""Whoever gives these again has them back."""


@pytest.mark.parametrize("axes", SWAPPED)
@pytest.mark.parametrize("sensor", ["gyroscope", "magnetometer"])
def test_advice_on_axes_is_right(sensor: str, axes: tuple[int, ...]) -> None:
    """Found by an outsider: a gyroscope with y reversed was said to be -x, y, -z."""
    times_s, values = FLOWN[sensor]
    told_of = told(FLOWN | {sensor: (times_s, in_axes(values, axes))})
    of_axes = [words for words in told_of if "axes are" in words]
    if (sensor, axes) == ("magnetometer", (-1, -2, -3)):
        # Such a field turns alike.
        assert not of_axes
        return
    (words,) = of_axes
    advice = ", ".join("-" * (axis < 0) + "xyz"[abs(axis) - 1] for axis in axes)
    if sensor == "gyroscope" and np.linalg.det(in_axes(np.eye(3), axes)) < 0.0:
        assert words.startswith("gyroscope: ")
        assert f" if its axes are {advice}, and not " in words
    else:
        assert f"{sensor} {advice}" in words
    # Its bias is no second fault.
    assert not [words for words in told_of if "a bias of" in words]


def scaled(name: str, by: Any) -> dict[str, Any]:
    times_s, values = FLOWN[name]
    return {name: (times_s, values * by)}


def repeated(name: str) -> dict[str, Any]:
    times_s, values = FLOWN[name]
    return {name: (times_s, np.broadcast_to(values[0], values.shape).copy())}


CONTRADICTED: list[tuple[dict[str, Any], str]] = [
    (scaled("differential_pressure", 0.01), "differential_pressure: .* is it in hPa"),
    (scaled("differential_pressure", 20.0), "differential_pressure: .* is it in another unit"),
    (scaled("gnss_position", [1.0, 1.0, 1.0 / 0.3048]), "gnss_position: .* if they are in ft"),
    *(
        (repeated(name), f"{name}: it repeats one sample to the last bit for 150 s")
        for name in ("gyroscope", "accelerometer", "magnetometer", "static_pressure")
    ),
]


@pytest.mark.parametrize(("source", "words"), CONTRADICTED)
def test_what_other_sources_contradict_is_told(source: dict[str, Any], words: str) -> None:
    with pytest.warns(UserWarning, match=words):
        fcc.navigate(**FLOWN | source)


@pytest.mark.parametrize("other", ["static_pressure", "gnss_velocity"])
def test_altitudes_in_feet_are_told_by_either(other: str) -> None:
    feet = scaled("gnss_position", [1.0, 1.0, 1.0 / 0.3048])
    sources = {name: FLOWN[name] for name in ("gyroscope", "accelerometer", other)} | feet
    assert "in ft" in "".join(told(sources))
