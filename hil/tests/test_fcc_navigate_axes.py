"""Innovations of `fcc.navigate` show which source of a flight does not agree with the others."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import fcc
import numpy as np
import pytest
from test_fcc_navigate import GRAVITY_MPS2, SPEED_MPS


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
def test_the_sources_of_turns_and_climbs_agree() -> None:
    for left_out in ("none", "magnetometer"):
        found = fcc.navigate(**{name: one for name, one in FLOWN.items() if name != left_out})
        for source, normalised in found["normalised_innovations"].items():
            assert normalised["accepted"] > 0.9, source
            assert np.max(normalised["rms"]) < 2.0, source


def changed(name: str, change: Callable[[np.ndarray], np.ndarray]) -> dict[str, Any]:
    times_s, values = FLOWN[name]
    return {name: (times_s, change(values))}


KNOT_MPS, KMH_MPS = 1852.0 / 3600.0, 1.0 / 3.6
OTHERS: list[tuple[dict[str, Any], str]] = [
    (changed("gnss_velocity", lambda v: v / KMH_MPS), "gnss_velocity"),
    (changed("gnss_velocity", lambda v: v / KNOT_MPS), "gnss_velocity"),
    (changed("gnss_velocity", lambda v: v[:, [1, 0, 2]]), "gnss_velocity"),
    (changed("gnss_position", lambda v: v[:, [1, 0, 2]]), "gnss_position"),
    (changed("gnss_velocity", lambda v: v * [1.0, 1.0, -1.0]), "static_pressure"),
    (changed("differential_pressure", lambda v: 20.0 * v), "differential_pressure"),
]
"""A velocity up for down contradicts pressure and acceleration, which agree with each other."""


@pytest.mark.parametrize(("source", "named"), OTHERS)
def test_other_units_and_axes_do_not_agree(source: dict[str, Any], named: str) -> None:
    found = fcc.navigate(**FLOWN | source)
    normalised = found["normalised_innovations"][named]
    assert normalised["accepted"] < 0.5
    assert np.max(normalised["rms"]) > 3.0
