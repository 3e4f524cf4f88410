"""The guided calibration in the page, of sensors that a simulated person handles."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from ground_station import Station

from air import Visit

RAW = """
[built-in]
raw_sensors = "phone"
[navigation]
method = "kalman"
[telemetry]
instance = "raw"
[recording]
folder = "{folder}/recordings"
"""


class Alone(Station):
    """A station whose daemon does not run."""

    def daemon(self) -> bool:
        return True


@pytest.fixture
def alone(tmp_path: Path, fccd: Path, station_program: Path) -> Iterator[Station]:
    config = tmp_path / "fccd.toml"
    config.write_text(RAW.format(folder=tmp_path))
    words: list[str | Path] = [station_program, "--config", config, "--fccd", fccd]
    station = Alone([*words, "--state", tmp_path / "state"], fccd, "raw")
    yield station
    station.end()


def test_a_pitot_tube_is_calibrated_and_another_calibration_ended(
    alone: Station, visit: Visit, tmp_path: Path
) -> None:
    visitor = visit(alone)
    page = visitor.page
    page.goto(alone.link)
    visitor.go("health")
    panel = page.get_by_label("Calibration", exact=True)
    panel.get_by_label("Kind").select_option("accelerometer")
    panel.get_by_role("button", name="Begin").click()
    panel.get_by_text("keep it still").wait_for()
    panel.get_by_role("button", name="End").click()
    panel.get_by_text("nothing was changed").wait_for()
    assert alone.ask("GET", "/api/calibration")[1]["exit_code"] == 1
    panel.get_by_label("Kind").select_option("airspeed")
    panel.get_by_role("button", name="Begin").click()
    panel.get_by_text("The airspeed is calibrated").wait_for()
    assert "an error of" in panel.inner_text()
    stored = list(tmp_path.rglob("raw.calibration.toml"))
    assert len(stored) == 1
