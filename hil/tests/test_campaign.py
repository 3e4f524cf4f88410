"""The campaign: its draws, its flights, its verdicts and its command."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import fcc
import numpy as np
import pytest
from distributed import LocalCluster

from fcc_hil import __main__ as commands
from fcc_hil.actuation import Actuation, Servos
from fcc_hil.aircraft import by_name
from fcc_hil.campaign.air import strength
from fcc_hil.campaign.aircraft import AIRCRAFT
from fcc_hil.campaign.draw import HOLD_S, LEG_S, Bounds, Fault, Flight, Gust, draw
from fcc_hil.campaign.faults import RawFaults
from fcc_hil.campaign.flying import Task, fly_task
from fcc_hil.campaign.verdict import HELD, Flown, judge, largest_rate_sd_degps
from fcc_hil.loading import Loading
from fcc_hil.motion import longest_s
from fcc_hil.plant import Plant, Weather
from fcc_hil.state import Controls
from fcc_hil.truth import COLUMNS, TRUTH_HZ, Truth
from fcc_hil.units import KT_TO_MPS
from fcc_hil.workers import local_workers, on_dask

USUAL = Bounds()
USAGE = 2


def _calm(**changes: object) -> Flight:
    """Return a flight of the c172p without gusts, noise and fault."""
    plain = replace(
        draw(0, 1, USUAL), gusts=(), noise=0.0, weather=Weather(), fault=None, seconds=20.0
    )
    return replace(plain, **changes)  # type: ignore[arg-type]


def _truth(seconds: float, **columns: float) -> Truth:
    """Return level flight at 100 kt and 3,000 ft, with some columns at another value."""
    level = {"altitude_ft": 3_000.0, "airspeed_kt": 100.0, "load_g": 1.0, "throttle": 0.6}
    values = level | {"height_ft": 3_000.0} | columns
    return Truth(
        [
            tuple({**values, "time_s": tick / TRUTH_HZ}.get(name, 0.0) for name in COLUMNS)
            for tick in range(round(seconds * TRUTH_HZ) + 1)
        ]
    )


def _broken(flight: Flight, truth: Truth, refused: tuple[str, ...] = ()) -> set[str]:
    """Return what is broken in a flight with ideal sensors."""
    shown = [truth[name][1:] for name in ("heading_deg", "altitude_ft", "airspeed_kt")]
    ordered = [np.full_like(shown[0], value) for value in (0.0, 3_000.0, 100.0)]
    flown = Flown(
        dict(zip(HELD, shown, strict=True)), dict(zip(HELD, ordered, strict=True)), (), refused, ()
    )
    return set(judge(flight, truth, flown).broken)


def test_stalling_speeds_are_those_of_the_handbooks() -> None:
    for name, weight_lb, handbook_kt in (
        ("c172p", 2_400.0, 51.0),
        ("c172r", 2_450.0, 51.0),
        ("J3Cub", 1_220.0, 33.0),
    ):
        assert AIRCRAFT[name].stall_kt(weight_lb) == pytest.approx(handbook_kt, abs=2.5)
    light, heavy = (AIRCRAFT["c172p"].stall_kt(weight_lb) for weight_lb in (1_200.0, 2_400.0))
    assert heavy / light == pytest.approx(2.0**0.5)


def test_the_same_draw_is_the_same_flight_and_bounds_are_kept() -> None:
    flights = [draw(number, 3, USUAL) for number in range(200)]
    assert flights == [draw(number, 3, USUAL) for number in range(200)]
    assert flights[0] != draw(0, 4, USUAL)
    assert {flight.aircraft for flight in flights} == set(AIRCRAFT)
    assert {flight.weather.turbulence_severity for flight in flights} == {0, 1, 2, 3, 4}
    assert 60.0 < max(flight.delay_ms for flight in flights) <= 75.0
    for flight in flights:
        assert flight.airspeed_kt >= 1.3 * flight.stall_kt
        assert flight.loading.weight_lb <= flight.limits.most_lb
    slow = sum(
        flight.airspeed_kt < max(1.301 * flight.stall_kt, flight.limits.floor_kt + 4.01)
        for flight in flights
    )
    assert slow / len(flights) == pytest.approx(1 / 3, abs=0.1)


def test_a_loaded_aircraft_has_that_weight_and_centre_of_gravity() -> None:
    plain = Plant("c172r").fdm
    loading = Loading(weight_lb=2_100.0, fuel_lb=100.0, aft_in=1.5)
    plant = Plant(replace(by_name("c172r"), loading=loading))
    assert plant.trimmed_by_jsbsim
    assert plant.fdm["inertia/weight-lbs"] == pytest.approx(2_100.0, abs=0.1)
    assert plant.fdm["propulsion/total-fuel-lbs"] == pytest.approx(100.0, abs=0.1)
    moved_in = plant.fdm["inertia/cg-x-in"] - plain["inertia/cg-x-in"]
    assert moved_in == pytest.approx(1.5, abs=0.01)
    with pytest.raises(ValueError, match="too little"):
        Plant(replace(by_name("c172r"), loading=Loading(1_600.0, 100.0)))


def test_late_commands_and_slow_servos() -> None:
    late = Servos(Actuation(latency_steps=9), Controls())
    moved = [late.step(Controls(elevator=1.0)).elevator for _ in range(12)]
    assert moved == [0.0] * 9 + [1.0] * 3
    # A first-order lag of 3 Hz is at 1 - 1/e after 1 / (2 pi 3) s, 6.4 steps.
    slow = Servos(Actuation(servo_hz=3.0), Controls())
    moved = [slow.step(Controls(elevator=1.0)).elevator for _ in range(7)]
    assert moved[5] < 0.632 < moved[6]


def test_a_gust_comes_and_goes() -> None:
    gust = Gust(begins_s=0.0, ramp_s=2.0, steady_s=5.0, down_mps=3.0)
    shares = [strength(gust, since_s) for since_s in (-1.0, 1.0, 2.0, 6.9, 8.0, 9.5)]
    assert shares == pytest.approx([0.0, 0.5, 1.0, 1.0, 0.5, 0.0])
    plant = Plant("c172p")
    plant.set_gust(north_mps=0.0, east_mps=0.0, down_mps=3.0)
    plant.step()
    assert plant.state().wind_down_mps == pytest.approx(3.0)


@pytest.mark.parametrize(
    ("column", "value", "kind"),
    [
        ("angle_of_attack_deg", 16.1, "stall"),
        ("airspeed_kt", 40.0, "below Vs"),
        ("roll_deg", 61.0, "bank"),
        ("load_g", 3.9, "load"),
        ("height_ft", 40.0, "ground"),
        ("heading_deg", 4.0, "heading"),
        ("altitude_ft", 2_979.0, "altitude"),
    ],
)
def test_what_is_broken_is_found(column: str, value: float, kind: str) -> None:
    assert _broken(_calm(), _truth(20.0)) == set()
    assert _broken(_calm(), _truth(20.0, **{column: value})) == {kind}


def test_a_refused_order_breaks_and_what_a_lost_quantity_delays_does_not() -> None:
    assert _broken(_calm(), _truth(20.0), ("15 s: too fast",)) == {"refused"}
    late = _truth(20.0, heading_deg=4.0)
    briefly = Fault("heading lost briefly", 16.0, 0.5)
    assert _broken(_calm(), late) == {"heading"}
    # The leg that ends at 15 s was flown before.
    assert _broken(_calm(fault=briefly), late) == {"heading"}
    assert _broken(_calm(fault=replace(briefly, begins_s=5.0)), late) == set()


def test_a_second_without_interruption_counts() -> None:
    holds = np.array([True] * 39 + [False] + [True] * 39)
    assert longest_s(holds) == pytest.approx(39 / 40)
    assert longest_s(np.array([False])) == 0.0


def test_the_limit_of_an_oscillation_follows_air_and_noise() -> None:
    assert largest_rate_sd_degps(_calm()) == 2.0
    rough = _calm(noise=1.0, weather=Weather(turbulence_severity=3))
    assert largest_rate_sd_degps(rough) == pytest.approx((4.0 + 4.0 + 9.0) ** 0.5)


def test_processes_and_a_cluster_fly_the_same() -> None:
    tasks = [Task(number, 5, USUAL) for number in (1, 3)]
    with local_workers(fly_task, 1) as fly_all:
        here = [outcome.digest for outcome in fly_all(tasks)]
    with (
        LocalCluster(
            n_workers=1, threads_per_worker=1, processes=False, dashboard_address=None
        ) as cluster,
        on_dask(fly_task, cluster.scheduler_address) as fly_all,
    ):
        there = [outcome.digest for outcome in fly_all(tasks)]
    assert here == there
    assert len(set(here)) == 2


def test_the_command_names_what_flies_a_flight_again(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    figures, picture = tmp_path / "campaign.json", tmp_path / "campaign.png"
    asked = ["campaign", "--flights", "1", "--seed", "5", "--workers", "1", "--turbulence", "2"]
    written = ["--json", str(figures), "--picture", str(picture), "--least-clean", "0"]
    assert commands.main([*asked, *written]) == 0
    assert "clean, all" in capsys.readouterr().out
    assert picture.read_bytes().startswith(b"\x89PNG")
    flown = json.loads(figures.read_text(encoding="utf-8"))["flights"]
    command = flown[0]["command"].split()
    assert command == ["fcc", *["campaign", "--flight", "0", "--seed", "5", "--turbulence", "2"]]
    assert flown[0]["simulated_s"] <= HOLD_S + 3 * LEG_S + 20.0

    commands.main([*command[1:], "--picture", str(picture)])
    assert f"digest {flown[0]['digest']}" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("wrong", "match"),
    [
        (["--seed", "-1"], "--seed"),
        (["--seed", "one"], "--seed"),
        (["--seed", "9" * 5_000], "from 0 to 4294967295"),
        (["--flights", "\u00b2"], "from 1 to 1000000"),
        (["--workers", "999999"], "from 1 to 1024"),
        (["--least-clean", "nan"], "from 0 to 100 %"),
        (["--least-clean", "101"], "from 0 to 100 %"),
        (["--delay-ms", "-1"], "from 0 to 1000 ms"),
        (["--delay-ms", "nan"], "from 0 to 1000 ms"),
        (["--flight", "-2"], "--flight"),
        (["--record", "flight.mcap"], "--flight"),
        (["--flight", "1", "--record", "/none/x.mcap"], "there is no folder '/none'"),
        (["--flight", "1", "--picture", "/none/x.png"], "there is no folder '/none'"),
        (["--json", "/"], "is a folder"),
        (["--healthy", "--airspeed"], "not allowed with argument"),
        (["--airspeed", "--raw", "board"], "not with --airspeed"),
        (["--healthy", "--first", "-1"], "--first"),
    ],
)
def test_wrong_arguments_are_refused_before_flying(
    wrong: list[str], match: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as ended:
        commands.main(["campaign", *wrong])
    assert ended.value.code == USAGE
    assert match in capsys.readouterr().err
    assert not Path("/none").exists()


@pytest.mark.parametrize(
    ("wrong", "match"),
    [
        (["--airspeeds", "85,nan"], "'nan': give a number from 20 to 500 kt"),
        (["--airspeeds", "-70"], "from 20 to 500 kt"),
        (["--airspeeds", ""], "from 20 to 500 kt"),
        (["--delays", "25,inf"], "from 0 to 1000 ms"),
        (["--servo", "-3"], "from 0 to 100 Hz"),
        (["--axes", "elevator,flaps"], "'flaps': choose of elevator, aileron, rudder, throttle"),
        (["--weights", "light,empty"], "'empty': choose of light, heavy, file"),
        (["--aircraft", "c172p,c999"], "'c999': choose of c172p"),
    ],
)
def test_margins_are_not_measured_where_there_are_none(
    wrong: list[str], match: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as ended:
        commands.main(["margins", *wrong])
    assert ended.value.code == USAGE
    assert match in capsys.readouterr().err


def test_a_reader_that_leaves_ends_it_silently() -> None:
    words = [sys.executable, "-m", "fcc_hil", "peer", "--legs", "1"]
    read, write = os.pipe()
    os.close(read)
    ended = subprocess.run(words, stdout=write, stderr=subprocess.PIPE, text=True, check=False)
    os.close(write)
    assert ended.stderr == ""


def test_by_raw_sensors_it_is_the_same_flight_without_what_they_bring_themselves() -> None:
    for number in range(40):
        measured, raw = draw(number, 3, USUAL), draw(number, 3, Bounds(raw_sensors="phone"))
        assert (raw.noise, raw.biases, raw.sensor_delay_ticks) == (1.0, {}, 0)
        assert raw.delay_ms == pytest.approx(measured.delay_ms, abs=10.0)
        assert raw.has_receiver == measured.has_receiver
        same = ("loading", "airspeed_kt", "weather", "gusts", "fault", "orders", "pattern")
        assert [getattr(raw, name) for name in same] == [getattr(measured, name) for name in same]


def test_a_flight_by_raw_sensors_is_judged_and_can_be_flown_again() -> None:
    # A pitot tube that is off, in the aircraft with a configuration of its own.
    bounds = Bounds(raw_sensors="board")
    task = next(
        Task(number, 31, bounds)
        for number in range(3, 2_000, 5)
        if (fault := draw(number, 31, bounds).fault) and fault.what == "airspeed frozen"
    )
    outcome = fly_task(task)
    assert not {"ground", "stall", "below Vs", "not flown", "not engaged"} & set(
        outcome.verdict.broken
    )
    assert outcome.command.endswith(f"--flight {task.number} --seed 31 --raw board")


def test_of_a_raw_sensor_fails_what_the_quantity_comes_from() -> None:
    values = fcc.Measurements()
    values.static_pressure_pa, values.differential_pressure_pa = 101_325.0, 1_000.0
    since_s = [4.0]
    faults = RawFaults(Fault("altitude lost briefly", 5.0, 0.5), lambda: since_s[0])
    for since_s[0], is_lost in ((4.0, False), (5.2, True)):
        values.static_pressure_pa = 101_325.0
        faults(values, 0.0)
        assert np.isnan(values.static_pressure_pa) == is_lost
    # 20 m/s more than 40.4 m/s (q = V^2 rho / 2) of a standard atmosphere.
    RawFaults(Fault("airspeed biased", 0.0, None, 20.0 / KT_TO_MPS), lambda: 1.0)(values, 0.0)
    assert values.differential_pressure_pa == pytest.approx(0.5 * 1.225 * 60.4**2, rel=0.02)
