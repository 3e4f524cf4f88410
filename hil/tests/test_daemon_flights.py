"""Flights of the daemon under bad conditions, scored from JSBSim's true state."""

from __future__ import annotations

import signal
from pathlib import Path

from daemon_under_test import assert_released, engage, flight, write_config

from fcc_hil.daemon import command
from fcc_hil.faults import Faults
from fcc_hil.fly import Plan, fly
from fcc_hil.pattern import TimedPattern
from fcc_hil.standin import Settings
from fcc_hil.udp import free_port

HARSH = Faults(loss=0.02, duplicate=0.01, reorder=0.01)
# Twice the limits for a good network; a leg has at most 20 s to settle.
WORST_HEADING_OVERSHOOT_DEG = 2 * 1.5
WORST_ALTITUDE_OVERSHOOT_FT = 2 * 4.0
WORST_ALTITUDE_RMS_FT = 2 * 2.0
WORST_AIRSPEED_ERROR_KT = 2 * 5.0

ROWS = (1, 3, 4, 16, 17, 18, 20, 21)
HOLD_S = 10.0


def test_a_harsh_network_and_noisy_sensors(fccd: Path, tmp_path: Path) -> None:
    port = free_port()
    pattern = TimedPattern(hold_s=5.0)
    config = write_config(
        tmp_path, port, guidance=f'mode = "timed-pattern"\nhold_s = {pattern.hold_s}'
    )
    settings = Settings(port=port, noise=True, inbound=HARSH, outbound=HARSH)
    flown = fly(Plan(command(fccd, config), settings, legs=2, pattern=pattern), print)
    # A busy machine makes the loop miss some; `fccd` and the score judge the flight with them.
    assert [failure for failure in flown.failures if "missed" not in failure] == []
    assert flown.report is not None
    events = [event["text"] for event in flown.report["events"]]
    states = [text for text in events if " -> " in text]
    assert states == ["standby -> engaged", "engaged -> standby", "standby -> stopped"]
    assert "missed" in flown.report["timing"]
    # The faults occurred.
    assert flown.standin["inbound"]["lost"] > 0
    assert flown.standin["outbound"]["reordered"] > 0
    for leg in flown.figures["legs"]:
        assert leg["heading_settle_s"] is not None
        assert leg["heading_overshoot_deg"] <= WORST_HEADING_OVERSHOOT_DEG
        assert leg["altitude_settle_s"] is not None
        assert leg["altitude_overshoot_ft"] <= WORST_ALTITUDE_OVERSHOOT_FT
        assert leg["altitude_rms_ft"] <= WORST_ALTITUDE_RMS_FT
        assert leg["airspeed_error_kt"] <= WORST_AIRSPEED_ERROR_KT


def test_data_output_rows_in_and_rows_out(fccd: Path, tmp_path: Path) -> None:
    local_port = free_port()
    settings = Settings(port=0, data_target=("127.0.0.1", local_port), data_rows=ROWS)
    rows = f"""
        input = "data"
        output = "data"
        local_port = {local_port}
        data_version = 11
    """
    with flight(fccd, tmp_path, settings, x_plane=rows) as (simulator, daemon):
        engage(simulator, daemon)
        engaged_at_s = simulator.progress().time_s
        while simulator.progress().time_s < engaged_at_s + HOLD_S:
            daemon.next_state()
        truth = simulator.truth()
        received = simulator.status()["messages"]
        ending = daemon.end(signal.SIGTERM)
        assert_released(simulator)
    assert ending.exit_code == 0
    assert ending.states == ["standby -> engaged", "engaged -> stopped"]
    assert received["WriteRows"] > HOLD_S * 10
    held = truth["time_s"] >= engaged_at_s
    captured_ft = truth.captured_at(engaged_at_s).altitude_ft
    assert abs(truth["altitude_ft"][held] - captured_ft).max() < WORST_ALTITUDE_OVERSHOOT_FT
