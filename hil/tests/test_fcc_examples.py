"""The examples in the documentation of the module `fcc`, run."""

from __future__ import annotations

import doctest
import inspect
from pathlib import Path

import fcc
import numpy as np
import pytest
from daemon_under_test import DaemonUnderTest

PARSER = doctest.DocTestParser()
LIVE = {"Commander", "Watcher"}
DOCUMENTED = {
    name: thing
    for name, thing in vars(fcc).items()
    if not name.startswith("_") and callable(thing) and name != "conformance"
}


def is_error(thing: object) -> bool:
    return inspect.isclass(thing) and issubclass(thing, BaseException)


EXAMPLES = sorted(name for name, thing in DOCUMENTED.items() if not is_error(thing))


def run(name: str) -> None:
    """Run the examples of a class or function: there has to be one."""
    words = {"fcc": fcc, "np": np}
    test = PARSER.get_doctest(str(DOCUMENTED[name].__doc__), words, name, name, 0)
    assert test.examples
    printed: list[str] = []
    found = doctest.DocTestRunner(verbose=False).run(test, out=printed.append)
    assert found.failed == 0, "".join(printed)


@pytest.fixture
def recorded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Go where `recordings/flight.mcap` is."""
    monkeypatch.chdir(tmp_path)
    machine, aircraft = fcc.Machine(), fcc.BuiltInAircraft()
    for _ in range(400):
        machine.step(aircraft.step(None))
    folder = tmp_path / "recordings"
    (path,) = machine.record_to(folder)
    path.rename(folder / "flight.mcap")


@pytest.mark.usefixtures("recorded")
@pytest.mark.parametrize("name", sorted(set(EXAMPLES) - LIVE))
def test_an_example_gives_what_it_says(name: str) -> None:
    run(name)


def test_examples_with_a_daemon_give_what_they_say(fccd: Path, tmp_path: Path) -> None:
    path = tmp_path / "fccd.toml"
    path.write_text('[built-in]\nengage_at_s = 1.5\n[guidance]\nmode = "hold"\n')
    words: list[str | Path] = [fccd, "fly", "--config", path, "--instance", "lab", "--json"]
    words += ["--recordings", tmp_path, "--seconds", "600"]
    with DaemonUnderTest(words, tmp_path) as daemon:
        daemon.wait_for("standby -> engaged")
        for name in sorted(LIVE):
            run(name)


@pytest.mark.parametrize("name", sorted(DOCUMENTED))
def test_every_public_method_is_documented(name: str) -> None:
    thing = DOCUMENTED[name]
    assert inspect.getdoc(thing)
    for method, of in inspect.getmembers(thing, callable):
        if not method.startswith("_") and not is_error(thing):
            assert inspect.getdoc(of), method
