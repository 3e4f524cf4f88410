"""The manners of a real X-Plane: ports, frames, queues, axes, surfaces, throttles."""

from __future__ import annotations

import itertools
import math
import socket
import struct
from typing import Any

import numpy as np
import pytest
from standin_bench import Bench

from fcc_hil.cockpit import (
    ARTSTAB_ROLL,
    AUTOTHROTTLE_ENABLED,
    AUTOTHROTTLE_ON,
    GENERIC_LIGHTS,
    OVERRIDE_ARTSTAB,
    OVERRIDE_JOYSTICK,
    OVERRIDE_THROTTLES,
    THROTTLE_USE,
    YOKE_ROLL,
)
from fcc_hil.frames import VaryingRate
from fcc_hil.local_axes import LocalAxes, attitude
from fcc_hil.rows import row_values
from fcc_hil.sensor_faults import Faults
from fcc_hil.standin import Settings, StandIn
from fcc_hil.state import Controls
from fcc_hil.udp import free_port

P = "sim/flightmodel/position/"
TIME = "sim/time/total_flight_time_sec"


def test_replies_come_from_the_next_port() -> None:
    port = free_port()
    bench = Bench(port=port, reply_port="next")
    bench.client.subscribe(1, TIME)
    bench.client.send(b"RPOS\x0060\0")
    bench.simulator.frame()
    assert {len(datagram) for datagram in bench.client.datagrams()} == {13, 69}
    assert bench.client.senders == {port + 1}
    assert bench.simulator.status()["reply_port"] == port + 1
    bench.close()


def test_the_beacon_names_the_port_that_listens_and_comes_from_the_other() -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as listener:
        listener.bind(("127.0.0.1", 0))
        listener.settimeout(1.0)
        bench = Bench(reply_port=0, beacon=listener.getsockname())
        bench.frames(1)
        datagram, sender = listener.recvfrom(2048)
    assert struct.unpack_from("<H", datagram, 19)[0] == bench.simulator.port
    assert sender[1] == bench.simulator.reply_port != bench.simulator.port
    bench.close()


def test_a_taken_next_port_is_replaced_and_a_taken_given_one_is_refused() -> None:
    port = free_port()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
        taken.bind(("127.0.0.1", port + 1))
        simulator = StandIn(Settings.plain(port=port, reply_port="next"))
        assert simulator.reply_port not in (port, port + 1)
        simulator.close()
        with pytest.raises(OSError, match=rf"127\.0\.0\.1:{port + 1} .* --reply-port"):
            StandIn(Settings.plain(port=0, reply_port=port + 1))


def test_a_frame_takes_140_messages_and_the_later_ones_are_lost() -> None:
    bench = Bench(version=121_000)
    for light in range(128):
        bench.client.write(f"{GENERIC_LIGHTS}[{light}]", 1.0)
    for index in range(20):
        bench.client.subscribe(index, TIME)
    assert set(bench.frames(2)) == set(range(12)), "140 less 128"
    assert bench.simulator.status()["overflowed"] == 8
    assert all(bench.read(f"{GENERIC_LIGHTS}[{light}]") == 1.0 for light in range(128))
    bench.close()


def test_a_freeze_loses_what_its_queue_does_not_take() -> None:
    bench = Bench()
    bench.act("freeze:1")
    for _ in range(200):
        bench.client.write(f"{GENERIC_LIGHTS}[0]", 1.0)
        if _ % 50 == 49:
            bench.simulator.frame()
    bench.frames(60)
    status = bench.simulator.status()
    assert status["messages"]["WriteDataref"] == 140
    # The kernel's own queue may have been shorter than 200.
    assert status["overflowed"] <= 60
    bench.close()


def test_frames_vary_between_their_rates_about_the_nominal_one() -> None:
    rate = VaryingRate(60.0, 20.0, 144.0, seed=1)
    periods_s = np.array([rate.draw_s() for _ in range(20_000)])
    assert 1.0 / 144.0 <= periods_s.min() < 1.0 / 130.0
    assert 1.0 / 25.0 < periods_s.max() <= 1.0 / 20.0
    assert len(periods_s) / periods_s.sum() == pytest.approx(60.0, rel=0.2)
    again = VaryingRate(60.0, 20.0, 144.0, seed=1)
    assert [again.draw_s() for _ in range(100)] == list(periods_s[:100])
    with pytest.raises(ValueError, match="the nominal 10 Hz between them"):
        VaryingRate(10.0, 20.0, 144.0, seed=1)


def test_simulated_time_is_the_sum_of_uneven_frames() -> None:
    bench = Bench(frame_rates_hz=(20.0, 144.0))
    bench.client.subscribe(1, TIME, 200)
    times = [bench.frames(1)[1] for _ in range(400)]
    steps_s = [after - before for before, after in itertools.pairwise(times)]
    # JSBSim's own steps are of 1/120 s.
    assert max(steps_s) <= 1.0 / 20.0 + 1.0 / 120.0 + 1e-4
    assert len({round(step * 120.0) for step in steps_s}) > 3
    frames_s = bench.read("sim/time/total_running_time_sec")
    assert times[-1] == pytest.approx(frames_s, abs=1.0 / 120.0 + 1e-4)
    bench.close()


def test_surfaces_move_at_their_rate() -> None:
    bench = Bench(surface_rate=2.0)
    bench.client.write(OVERRIDE_JOYSTICK, 1.0)
    bench.client.write(YOKE_ROLL, 1.0)
    bench.frames(15)
    assert bench.simulator.surfaces.aileron == pytest.approx(0.5, abs=0.04), "after 0.25 s"
    readout = bench.simulator.readout(bench.simulator.shown())
    commanded, moved = row_values(8, readout), row_values(11, readout)
    assert commanded is not None
    assert moved is not None
    assert commanded[1] == 1.0
    assert moved[1] == pytest.approx(bench.simulator.surfaces.aileron)
    bench.frames(30)
    assert bench.simulator.surfaces.aileron == 1.0
    bench.close()


def test_throttles_go_from_full_reverse_to_beyond_full() -> None:
    bench = Bench()
    bench.client.write(OVERRIDE_THROTTLES, 1.0)
    for value, expected in ((1.5, 1.2), (-2.0, -1.0)):
        bench.client.write(f"{THROTTLE_USE}[0]", value)
        bench.frames(1)
        assert bench.read(f"{THROTTLE_USE}[0]") == pytest.approx(expected)
    bench.close()


def test_the_axial_load_of_row_4_has_the_sign_that_was_chosen() -> None:
    axial = {}
    for sign in (1.0, -1.0):
        bench = Bench(axial_sign=sign)
        values = row_values(4, bench.simulator.readout(bench.simulator.shown()))
        assert values is not None
        axial[sign] = values[5]
        bench.close()
    assert axial[1.0] == -axial[-1.0] != 0.0


def test_artificial_stability_is_written_only_under_its_override() -> None:
    bench = Bench()
    bench.client.write(ARTSTAB_ROLL, 0.4)
    bench.frames(1)
    assert bench.read(ARTSTAB_ROLL) == 0.0
    bench.client.write(OVERRIDE_ARTSTAB, 1.0)
    bench.client.write(ARTSTAB_ROLL, 0.4)
    bench.frames(1)
    assert bench.read("sim/cockpit2/controls/total_roll_ratio") == pytest.approx(0.4)
    assert bench.read("sim/joystick/FC_roll") == pytest.approx(0.4)
    assert bench.read(YOKE_ROLL) == 0.0
    bench.client.write(AUTOTHROTTLE_ENABLED, 1.0)
    bench.frames(1)
    assert bench.read(AUTOTHROTTLE_ON) == 1.0
    bench.close()


def test_the_altimeter_shows_the_height_above_the_sea_at_any_pressure() -> None:
    bench = Bench(version=121_000, qnh_inhg=30.42)
    # Set to the pressure at sea level: the aircraft was put at 3,000 ft.
    assert bench.read("sim/cockpit2/gauges/indicators/altitude_ft_pilot") == pytest.approx(
        3_000.0, abs=15.0
    )
    # 14 CFR 43, appendix E, table IV: 0.5 inHg above 29.92 is about 454 ft.
    pressure_ft = bench.read("sim/flightmodel2/position/pressure_altitude")
    assert pressure_ft == pytest.approx(3_000.0 - 456.0, abs=10.0)
    assert bench.read("sim/weather/barometer_sealevel_inhg") == pytest.approx(30.42)
    bench.close()


@pytest.mark.parametrize(("version", "found"), [(115_501, None), (121_000, 1.0)])
def test_pressure_altitude_came_with_version_12(version: int, found: float | None) -> None:
    bench = Bench(version=version)
    value = bench.simulator.read("sim/flightmodel2/position/pressure_altitude")
    assert (value is None) == (found is None)
    bench.close()


@pytest.mark.parametrize(
    ("offset_deg", "pitch_deg", "roll_deg"),
    # Northbound and level. An origin 1 degree south of the aircraft: its up leans south against
    # the aircraft's, so the nose, which points along the curve of the earth, is 1 degree down.
    [((-1.0, 0.0), -1.0, 0.0), ((1.0, 0.0), 1.0, 0.0), ((0.0, 1.0), 0.0, -1.0), ((0, -1), 0, 1)],
)
def test_local_attitude_is_about_the_level_at_the_origin(
    offset_deg: tuple[float, float], pitch_deg: float, roll_deg: float
) -> None:
    axes = LocalAxes(math.radians(offset_deg[0]), math.radians(offset_deg[1]))
    pitch, roll, heading = attitude(axes.turn(0.0, 0.0), 0.0, 0.0, 0.0)
    assert math.degrees(pitch) == pytest.approx(pitch_deg, abs=1e-6)
    assert math.degrees(roll) == pytest.approx(roll_deg, abs=1e-6)
    assert math.sin(heading) == pytest.approx(0.0, abs=1e-3)


def test_meridians_converge_towards_the_pole() -> None:
    # Convergence is the difference in longitude times the sine of the latitude.
    axes = LocalAxes(math.radians(60.0), 0.0)
    turn = axes.turn(math.radians(60.0), math.radians(1.0))
    heading = attitude(turn, 0.0, 0.0, 0.0)[2]
    assert math.degrees(heading) == pytest.approx(360.0 - math.sin(math.radians(60.0)), abs=0.01)


def test_positions_velocities_and_accelerations_share_the_local_axes() -> None:
    """The derivative of each is the next, along the axes of an origin that is far away."""
    bench = Bench(origin_offset_deg=(0.7, -0.6), heading_deg=60.0)
    bench.simulator.cockpit.hold(Controls(aileron=0.2, throttle=0.7))
    bench.frames(60)
    for axis in "xyz":
        assert bench.read(P + f"local_{axis}") != 0.0
    before = {name: bench.read(P + f"local_{name}") for name in ("x", "y", "z", "vx", "vy", "vz")}
    a_before = {axis: bench.read(P + f"local_a{axis}") for axis in "xyz"}
    bench.frames(6)
    for axis in "xyz":
        moved_m = bench.read(P + f"local_{axis}") - before[axis]
        mean_mps = (bench.read(P + f"local_v{axis}") + before[f"v{axis}"]) / 2.0
        # The ellipsoid's curvature at the equator differs north to south by 0.7 %.
        assert moved_m / 0.1 == pytest.approx(mean_mps, abs=0.4)
        gained_mps = bench.read(P + f"local_v{axis}") - before[f"v{axis}"]
        mean_mps2 = (bench.read(P + f"local_a{axis}") + a_before[axis]) / 2.0
        assert gained_mps / 0.1 == pytest.approx(mean_mps2, abs=0.4)
    bench.close()


def test_the_true_attitude_is_not_about_the_local_axes() -> None:
    bench = Bench(origin_offset_deg=(0.5, 0.5))
    assert bench.read(P + "theta") - bench.read(P + "true_theta") == pytest.approx(0.5, abs=0.01)
    assert bench.read(P + "phi") - bench.read(P + "true_phi") == pytest.approx(-0.5, abs=0.01)
    assert bench.read("sim/flightmodel2/position/true_theta") == bench.read(P + "true_theta")
    bench.close()


@pytest.mark.parametrize(
    ("changes", "why"),
    [
        ({"qnh_inhg": 1013.25}, "qnh_inhg = 1013.25: give 25 to 32"),
        ({"surface_rate": 0.0}, "surface_rate = 0: give 0.01"),
        ({"queue": 0}, "queue = 0: give 1"),
        ({"origin_offset_deg": (0.0, 90.0)}, "at most 5 degrees"),
        ({"axial_sign": 0.5}, "give 1 or -1"),
    ],
)
def test_settings_that_no_simulator_has_are_refused(changes: dict[str, Any], why: str) -> None:
    with pytest.raises(ValueError, match=why):
        Settings(**changes)


def test_the_origin_moves_by_itself_once() -> None:
    bench = Bench(origin_offset_deg=(0.5, 0.5), origin_moves_after_s=0.5)
    before_deg = bench.read(P + "phi")
    bench.frames(29)
    assert bench.read(P + "phi") == pytest.approx(before_deg, abs=0.1)
    bench.frames(2)
    moved_deg = bench.read(P + "phi")
    assert moved_deg - before_deg == pytest.approx(1.0, abs=0.1)
    bench.frames(60)
    assert bench.read(P + "phi") == pytest.approx(moved_deg, abs=0.1)
    bench.close()


def test_a_frozen_or_broken_angle_is_so_about_the_local_axes_too() -> None:
    bench = Bench(origin_offset_deg=(0.5, 0.5))
    names = ("theta", "phi", "psi", "true_phi")
    for index, name in enumerate(names):
        bench.client.subscribe(index, P + name)
    bench.simulator.cockpit.hold(Controls(aileron=0.3, throttle=0.7))
    frozen = bench.frames(30)
    faults = Faults(lambda: bench.simulator.plant.time_s, bench.simulator.sensors.set_faults)
    faults.freeze("attitude")
    first = bench.frames(1)
    last = bench.frames(60)
    assert (last[0], last[1], last[3]) == (first[0], first[1], first[3])
    assert last[2] != frozen[2], "the heading is not frozen"
    faults.end()
    faults.nan("heading")
    values = bench.frames(1)
    assert math.isnan(values[2])
    assert math.isfinite(values[0] + values[1])
    bench.close()


def test_an_aircrafts_name_is_read_by_character() -> None:
    bench = Bench(aircraft="c172x")
    name = "".join(chr(int(bench.read(f"sim/aircraft/view/acf_ICAO[{i}]"))) for i in range(6))
    assert name == "c172x\0"
    bench.close()
