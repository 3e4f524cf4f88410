"""Datagrams of another host, as many as a fast network carries: the kernel drops them."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import time
from pathlib import Path

import pytest
from daemon_under_test import assert_released, engage, flight

from fcc_hil.flood import disturbed, flood
from fcc_hil.udp import free_port

SUCCESS = 0
SECONDS = 3.0
PER_SECOND = 100_000.0
AT_LEAST = 20_000.0
"""On a busy machine; without a filter 5,000 ended a flight."""


def test_datagrams_of_another_host_do_not_disturb_a_flight(fccd: Path, tmp_path: Path) -> None:
    port = free_port()
    with flight(fccd, tmp_path, x_plane=f"local_port = {port}") as (simulator, daemon):
        engage(simulator, daemon)
        with flood(("127.0.0.1", port), PER_SECOND) as sent:
            time.sleep(SECONDS)
        assert daemon.next_state() == "engaged"
        ending = daemon.end(signal.SIGTERM)
        assert_released(simulator)
    assert sent.per_second > AT_LEAST
    assert ending.exit_code == SUCCESS
    assert ending.states == ["standby -> engaged", "engaged -> stopped"]
    assert disturbed(ending.events) == []


@pytest.mark.skipif(
    shutil.which("nft") is None or os.geteuid() != 0, reason="nft checks rules for root only"
)
def test_the_rules_of_the_page_are_valid() -> None:
    page = (Path(__file__).parents[2] / "docs/security.md").read_text("utf-8")
    blocks = [block for block in page.split("\n\n") if block.startswith("    table inet ")]
    assert len(blocks) == 2
    for rules in blocks:
        subprocess.run(["nft", "--check", "--file", "-"], input=rules, text=True, check=True)
