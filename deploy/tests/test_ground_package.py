"""The Debian package of the ground station: its content.

`make test-deb` builds it beside that of the daemon, to whose path it sets DEB.
"""

from __future__ import annotations

import os
import re
import subprocess
from pathlib import Path

import pytest


@pytest.fixture(scope="module")
def package() -> Path:
    (found,) = Path(os.environ["DEB"]).parent.glob("fcc-ground_*.deb")
    return found


def told(*command: str | Path) -> str:
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def test_it_is_installed_beside_the_daemon_and_not_started(package: Path, tmp_path: Path) -> None:
    subprocess.run(["dpkg-deb", "--raw-extract", package, tmp_path], check=True)
    files = {str(path.relative_to(tmp_path)) for path in tmp_path.rglob("*") if path.is_file()}
    installed = {file for file in files if not file.startswith("DEBIAN/")}
    assert installed == {
        "usr/bin/fcc-ground",
        "usr/lib/systemd/system/fcc-ground.service",
        "usr/share/doc/fcc-ground/copyright",
    }
    # Nothing that the other package has.
    with_daemon = told("dpkg-deb", "--contents", os.environ["DEB"])
    assert [file for file in installed if f"./{file}\n" in with_daemon] == []
    assert "fccd" in told("dpkg-deb", "--field", package, "Depends").split(", ")
    # It is started by nobody but its user, and stopped before it is removed.
    scripts = {path.name: path for path in (tmp_path / "DEBIAN").iterdir()}
    assert re.findall("deb-systemd-invoke (.*) fcc", scripts["postinst"].read_text()) == [
        "try-restart"
    ]
    assert "deb-systemd-invoke stop" in scripts["prerm"].read_text()


def test_its_page_is_in_it(package: Path, tmp_path: Path) -> None:
    if told("dpkg-deb", "--field", package, "Architecture").strip() != "amd64":
        pytest.skip("the program is of another machine")
    subprocess.run(["dpkg-deb", "--extract", package, tmp_path], check=True)
    program = tmp_path / "usr/bin/fcc-ground"
    assert ".debug_line" not in told("objdump", "--section-headers", program)
    assert "--listen" in told(program, "--help")
    assert b"<title>" in program.read_bytes()
