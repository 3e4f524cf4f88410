"""The multicopter's controller on JSBSim's F450, a plant that nobody here wrote."""

from __future__ import annotations

import math
import random
import struct
import subprocess
from collections import deque
from collections.abc import Iterator
from pathlib import Path

import jsbsim
import pytest

FOOT_M = 0.3048
EARTH_M = 6.378e6
PERIOD_S = 0.0025
ENGAGES_S = 4.0
# Front right, then clockwise.
MOTORS = ("FR", "AR", "AL", "FL")
# Those of the built-in aircraft: attitude, heading, rates, force, position, velocity.
NOISE = [
    *[math.radians(0.2)] * 2,
    math.radians(0.4),
    *[math.radians(0.3)] * 3,
    *[0.18] * 3,
    *[2.0 / EARTH_M, 2.0 / EARTH_M / math.cos(math.radians(47)), 2.0],
    *[0.1] * 3,
]
READ = [
    *[(f"attitude/{angle}-rad", 1.0) for angle in ("phi", "theta", "psi")],
    *[(f"velocities/{axis}-rad_sec", 1.0) for axis in "pqr"],
    *[(f"accelerations/a-pilot-{axis}-ft_sec2", FOOT_M) for axis in "xyz"],
    ("position/lat-geod-rad", 1.0),
    ("position/long-gc-rad", 1.0),
    ("position/h-sl-meters", 1.0),
    *[(f"velocities/v-{axis}-fps", FOOT_M) for axis in ("north", "east", "down")],
]

Place = tuple[float, float, float]


def fly(
    program: Path, *, latency_s: float, step_s: float, seconds: float, noisy: bool, wind_mps: float
) -> Iterator[tuple[float, Place]]:
    """Fly in lockstep; yield time and place, north, east and up of where it began."""
    plant = jsbsim.FGFDMExec(None)
    plant.set_debug_level(0)
    plant.set_dt(PERIOD_S / 5)
    plant.load_model("F450")
    plant["ic/h-agl-ft"] = 0.3
    plant["ic/lat-geod-deg"] = 47.0
    plant["ic/long-gc-deg"] = 8.0
    plant.run_ic()
    plant["propulsion/set-running"] = -1
    plant["fcs/ScasEngage"] = 0
    noise = random.Random(301)
    delayed: deque[list[float]] = deque(maxlen=1 + round(latency_s / PERIOD_S))
    begin: list[float] = []
    with subprocess.Popen(
        [str(program), str(latency_s), str(step_s)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
    ) as controller:
        assert controller.stdin is not None
        assert controller.stdout is not None
        for tick in range(round(seconds / PERIOD_S)):
            for _ in range(5):
                plant.run()
            true = [plant[name] * scale for name, scale in READ]
            delayed.append(true)
            measured = delayed[0]
            if noisy:
                pairs = zip(measured, NOISE, strict=True)
                measured = [value + noise.gauss(0.0, sigma) for value, sigma in pairs]
            controller.stdin.write(struct.pack("<15d", *measured))
            controller.stdin.flush()
            speeds = struct.unpack("<4d", controller.stdout.read(32))
            for motor, speed in zip(MOTORS, speeds, strict=True):
                plant[f"fcs/cmd{motor}_ext_nd"] = speed
            time_s = tick * PERIOD_S
            if time_s < ENGAGES_S - 1.0:
                begin = true
                continue
            plant["atmosphere/wind-east-fps"] = wind_mps / FOOT_M
            north_m = (true[9] - begin[9]) * EARTH_M
            east_m = (true[10] - begin[10]) * EARTH_M * math.cos(true[9])
            yield time_s, (north_m, east_m, true[11] - begin[11])
        controller.stdin.close()


def rms(values: list[float]) -> float:
    return math.sqrt(sum(value * value for value in values) / len(values))


@pytest.mark.parametrize(("latency_s", "noisy"), [(0.01, True), (0.025, True)])
def test_it_hovers_in_wind(lockstep: Path, latency_s: float, noisy: bool) -> None:
    """Wanted: 0.5 m and 0.15 m in height, RMS, with noisy sensors; 25 ms are still flown."""
    flight = fly(lockstep, latency_s=latency_s, step_s=1e9, seconds=80, noisy=noisy, wind_mps=8.0)
    places = [place for time_s, place in flight if time_s > 20]
    assert rms([math.hypot(north, east) for north, east, _ in places]) < 0.5
    assert rms([up - 10 for _, _, up in places]) < 0.15


def test_a_step_of_five_metres(lockstep: Path) -> None:
    """Wanted: within 0.3 m in 3 s, overshoot below 0.1 m; PX4 asserts 10 s."""
    flight = fly(lockstep, latency_s=0.01, step_s=15.0, seconds=20, noisy=False, wind_mps=8.0)
    stepped = [(time_s - 15.0, place) for time_s, place in flight if time_s >= 15.0]
    outside = [since_s for since_s, place in stepped if math.dist(place, (5.0, 0.0, 10.0)) > 0.3]
    assert outside[-1] < 3.0
    assert max(north for _, (north, _, _) in stepped) < 5.1
