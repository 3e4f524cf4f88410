"""The stand-in over real sockets on loopback, frame by frame: no waiting, no clock."""

from __future__ import annotations

import math
import socket
import struct
from collections.abc import Iterator

import pytest
from standin_bench import Bench, Client

from fcc_hil.cockpit import (
    GENERIC_LIGHTS,
    OVERRIDE_JOYSTICK,
    OVERRIDE_THROTTLES,
    THROTTLE_USE,
    YOKE_ROLL,
)
from fcc_hil.sensor_faults import Faults
from fcc_hil.standin import PAUSE_TOGGLE, Mode, Settings, StandIn

TIME = "sim/time/total_flight_time_sec"
PAUSED = "sim/time/paused"
ROLL = "sim/flightmodel/position/phi"
AILERON = "fcs/left-aileron-pos-norm"


@pytest.fixture
def bench() -> Iterator[Bench]:
    made = Bench()
    yield made
    made.close()


def test_subscribed_values_arrive_under_the_senders_index(bench: Bench) -> None:
    bench.client.subscribe(17, TIME)
    bench.client.subscribe(-4, "sim/flightmodel/position/indicated_airspeed")
    values = bench.frames(60)
    assert values[17] == pytest.approx(1.0)
    assert values[-4] == pytest.approx(100.0, abs=0.1)


@pytest.mark.parametrize(("asked_hz", "frames"), [(10, 10), (40, 40), (60, 60), (200, 60)])
def test_frequency_is_kept_up_to_the_frame_rate(bench: Bench, asked_hz: int, frames: int) -> None:
    bench.client.subscribe(1, TIME, asked_hz)
    got = 0
    for _ in range(60):
        bench.simulator.frame()
        got += len(bench.client.datagrams())
    assert got == pytest.approx(frames, abs=1)


def test_frequency_0_ends_it_and_again_changes_nothing(bench: Bench) -> None:
    bench.client.subscribe(1, TIME)
    bench.client.subscribe(2, PAUSED)
    bench.frames(2)
    bench.client.subscribe(1, TIME)
    assert set(bench.frames(2)) == {1, 2}
    bench.client.subscribe(1, TIME, 0)
    assert set(bench.frames(2)) == {2}


def test_unknown_dataref_gets_no_answer_and_is_counted(bench: Bench) -> None:
    bench.client.subscribe(1, "sim/no/such")
    assert bench.frames(3) == {}
    assert bench.simulator.status()["unknown_datarefs"] == {"sim/no/such": 1}


def test_long_replies_are_split_into_datagrams(bench: Bench) -> None:
    for index in range(200):
        bench.client.subscribe(index, TIME)
        if index % 50 == 0:
            bench.simulator.frame()
    bench.simulator.frame()
    bench.client.datagrams()
    bench.simulator.frame()
    datagrams = bench.client.datagrams()
    assert [len(datagram) for datagram in datagrams] == [1469, 5 + 17 * 8]
    order = [index for d in datagrams for index, _ in struct.iter_unpack("<if", d[5:])]
    assert sorted(order) == list(range(200))
    assert order != list(range(200))


def test_controls_reach_the_aircraft_only_under_the_override(bench: Bench) -> None:
    trimmed = bench.simulator.plant.fdm[AILERON]
    bench.client.subscribe(1, ROLL)
    bench.client.write(YOKE_ROLL, 0.5)
    assert abs(bench.frames(60)[1]) < 1.0
    bench.client.write(OVERRIDE_JOYSTICK, 1.0)
    bench.client.write(YOKE_ROLL, 0.5)
    assert bench.frames(60)[1] > 10.0
    # Let go: the pilot has the ailerons back where they were trimmed.
    bench.client.write(OVERRIDE_JOYSTICK, 0.0)
    bench.frames(30)
    assert bench.simulator.plant.fdm[AILERON] == pytest.approx(trimmed)


def test_throttle_reaches_the_engine_only_under_its_override(bench: Bench) -> None:
    trimmed = bench.simulator.plant.trim.throttle
    bench.client.write(f"{THROTTLE_USE}[0]", 0.0)
    bench.frames(2)
    assert bench.simulator.plant.fdm["fcs/throttle-cmd-norm[0]"] == pytest.approx(trimmed)
    bench.client.write(OVERRIDE_THROTTLES, 1.0)
    bench.client.write(f"{THROTTLE_USE}[0]", 0.0)
    bench.frames(2)
    assert bench.simulator.plant.fdm["fcs/throttle-cmd-norm[0]"] == 0.0


def test_data_row_8_moves_the_surfaces(bench: Bench) -> None:
    bench.client.write(OVERRIDE_JOYSTICK, 1.0)
    bench.client.send(b"DATA\0" + struct.pack("<i8f", 8, 0.0, -0.5, 0.0, *[-999.0] * 5))
    bench.frames(30)
    assert bench.simulator.plant.state().roll_rate_radps < -0.1


def test_engage_switch_is_seen_by_the_client(bench: Bench) -> None:
    bench.client.subscribe(9, f"{GENERIC_LIGHTS}[0]")
    assert bench.frames(2)[9] == 0.0
    bench.simulator.write(f"{GENERIC_LIGHTS}[0]", 1.0)
    assert bench.frames(2)[9] == 1.0


def test_short_write_is_refused_with_the_reason(bench: Bench) -> None:
    bench.client.send(b"DREF\0" + struct.pack("<f", 1.0) + OVERRIDE_JOYSTICK.encode())
    bench.frames(1)
    status = bench.simulator.status()
    assert status["refused"] == 1
    assert "must be 509" in status["last_refusals"][0]
    assert bench.simulator.read(OVERRIDE_JOYSTICK) == 0.0


def test_position(bench: Bench) -> None:
    bench.client.send(b"RPOS\x0060\0")
    bench.simulator.frame()
    (reply,) = bench.client.datagrams()
    assert len(reply) == 69
    assert struct.unpack_from("<d", reply, 21)[0] == pytest.approx(914.4, abs=0.1)
    north_mps = -struct.unpack_from("<f", reply, 53)[0]
    assert north_mps == pytest.approx(53.76, abs=0.05)
    bench.client.send(b"RPOS\x000\0")
    bench.simulator.frame()
    assert bench.client.datagrams() == []


def test_a_pause_is_reported_and_stops_time(bench: Bench) -> None:
    bench.client.subscribe(1, TIME)
    bench.client.subscribe(2, PAUSED)
    before = bench.frames(10)
    bench.client.send(b"CMND\0" + PAUSE_TOGGLE.encode())
    paused = bench.frames(10)
    assert paused[1] == pytest.approx(before[1], abs=1e-6)
    assert paused[2] == 1.0
    bench.simulator.mode = Mode.RUNNING
    assert bench.frames(60)[1] == pytest.approx(before[1] + 1.0, abs=1e-4)


def test_a_stall_is_not_reported_and_a_freeze_sends_nothing(bench: Bench) -> None:
    bench.client.subscribe(1, TIME)
    bench.client.subscribe(2, PAUSED)
    before = bench.frames(10)
    bench.simulator.mode = Mode.STALLED
    assert bench.frames(10) == before
    bench.simulator.mode = Mode.FROZEN
    assert bench.frames(10) == {}
    bench.simulator.mode = Mode.RUNNING
    assert bench.frames(1)[1] > before[1]


@pytest.mark.parametrize(
    ("rate_hz", "simulated_s"),
    # Below 19 frames a second a frame is still worth 1/19 s: time runs slower.
    [(60.0, 1.0), (45.0, 1.0), (20.0, 1.0), (10.0, 10 / 19), (5.0, 5 / 19)],
)
def test_simulated_time_slows_below_19_frames(rate_hz: float, simulated_s: float) -> None:
    bench = Bench(frame_rate_hz=rate_hz)
    bench.client.subscribe(1, TIME)
    assert bench.frames(round(rate_hz))[1] == pytest.approx(simulated_s, abs=0.02)
    bench.close()


def test_jump_and_restart_of_the_flight(bench: Bench) -> None:
    bench.client.subscribe(1, TIME)
    bench.client.write(OVERRIDE_JOYSTICK, 1.0)
    bench.frames(60)
    bench.simulator.jump(100.0)
    assert bench.frames(1)[1] == pytest.approx(101.0, abs=0.1)
    bench.simulator.restart_flight()
    assert bench.frames(1)[1] < 0.1
    assert bench.simulator.read(OVERRIDE_JOYSTICK) == 0.0


def test_truth_is_kept_on_a_40_hz_grid(bench: Bench) -> None:
    bench.frames(60)
    times = [row[0] for row in bench.simulator.truth]
    assert times == pytest.approx([i / 40.0 for i in range(41)])


def test_noise_is_in_replies_and_not_in_the_truth() -> None:
    bench = Bench(noise=True)
    bench.client.subscribe(1, ROLL)
    rolls = [bench.frames(1)[1] for _ in range(60)]
    assert max(rolls) - min(rolls) > 0.3
    assert max(abs(row[5]) for row in bench.simulator.truth) < 0.2
    bench.close()


def test_data_output_goes_to_the_users_target() -> None:
    target = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    target.bind(("127.0.0.1", 0))
    target.settimeout(1.0)
    bench = Bench(data_target=target.getsockname(), data_rows=(17,))
    bench.client.send(b"DSEL\0" + struct.pack("<i", 3))
    bench.frames(1)
    datagram = target.recv(2048)
    assert datagram[:4] == b"DATA"
    assert len(datagram) == 5 + 2 * 36
    assert struct.unpack_from("<i", datagram, 5)[0] == 3
    assert struct.unpack_from("<i", datagram, 41)[0] == 17
    bench.close()
    target.close()


def test_beacon_names_the_port() -> None:
    listener = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    listener.bind(("127.0.0.1", 0))
    listener.settimeout(1.0)
    bench = Bench(beacon=listener.getsockname())
    bench.frames(1)
    datagram = listener.recv(2048)
    assert datagram[:5] == b"BECN\0"
    assert struct.unpack_from("<BBiiIH", datagram, 5) == (
        1,
        2,
        1,
        115_501,
        1,
        bench.simulator.port,
    )
    bench.close()
    listener.close()


def test_a_client_that_has_ended_disturbs_no_other(bench: Bench) -> None:
    gone = Client(bench.simulator.port)
    gone.subscribe(1, TIME)
    bench.client.subscribe(1, TIME)
    bench.frames(2)
    gone.socket.close()
    assert bench.frames(60)[1] == pytest.approx(62.0 / 60.0, abs=1e-3)


def test_a_port_in_use_is_reported(bench: Bench) -> None:
    with pytest.raises(OSError, match=r"cannot listen on 127\.0\.0\.1.*--port"):
        StandIn(Settings(port=bench.simulator.port))


def test_a_sensor_fault_changes_replies_and_not_the_flight(bench: Bench) -> None:
    altimeter = "sim/cockpit2/gauges/indicators/altitude_ft_pilot"
    airspeed = "sim/flightmodel/position/indicated_airspeed"
    bench.client.subscribe(1, altimeter)
    bench.client.subscribe(2, airspeed)
    bench.client.subscribe(3, TIME)
    good = bench.frames(2)
    faults = Faults(lambda: bench.simulator.plant.time_s, bench.simulator.sensors.set_faults)
    faults.loss("airspeed")
    faults.bias("altitude", by=100)
    values = bench.frames(1)
    assert set(values) == {1, 3}
    assert values[1] == pytest.approx(good[1] + 100.0, abs=1.0)
    assert bench.simulator.read(altimeter) == pytest.approx(good[1], abs=1.0), "as it truly is"
    faults.end()
    faults.nan("airspeed")
    values = bench.frames(1)
    assert math.isnan(values[2])
    assert values[1] == pytest.approx(good[1], abs=1.0)
    faults.loss("everything")
    assert bench.frames(3) == {}
    faults.end()
    assert set(bench.frames(1)) == {1, 2, 3}
