"""The Debian package: its content, and the effect of its scripts.

`make test-deb` builds it and sets DEB to its path; for a board with DEB_TARGET.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
from pathlib import Path

import pytest

# Of the ELF header: 1 for 32 bits and 2 for 64, and e_machine (elf(5)).
MACHINES = {"amd64": (2, 62), "arm64": (2, 183), "armhf": (1, 40)}
# Runs a board's program here, with the libraries of Debian's cross compilers.
RUNNERS = {
    "arm64": ["qemu-aarch64", "-L", "/usr/aarch64-linux-gnu"],
    "armhf": ["qemu-arm", "-L", "/usr/arm-linux-gnueabihf"],
}


@pytest.fixture(scope="session")
def package() -> Path:
    path = os.environ.get("DEB", "")
    if not Path(path).is_file():
        pytest.fail("DEB names no package: make test-deb", pytrace=False)
    return Path(path)


@pytest.fixture(scope="session")
def control(package: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of the package's control files."""
    folder = tmp_path_factory.mktemp("control")
    subprocess.run(["dpkg-deb", "--control", package, folder], check=True)
    return folder


@pytest.fixture(scope="session")
def files(package: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder in which the package is unpacked."""
    folder = tmp_path_factory.mktemp("files")
    subprocess.run(["dpkg-deb", "--extract", package, folder], check=True)
    return folder


@pytest.fixture(scope="session")
def architecture(package: Path) -> str:
    """Return its architecture, in Debian's terms."""
    command = ["dpkg-deb", "--field", package, "Architecture"]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout.strip()


def test_the_program_is_for_the_machine_that_the_package_names(
    architecture: str, package: Path, files: Path
) -> None:
    header = (files / "usr/bin/fccd").read_bytes()[:20]
    assert header[:4] == b"\x7fELF"
    assert (header[4], int.from_bytes(header[18:20], "little")) == MACHINES[architecture]
    assert package.stem.endswith(f"_{architecture}")


MOST_INSTALLED_KIB = 16 * 1024
"""Eight times as much with symbols."""


def sections(program: Path) -> str:
    command = ["objdump", "--section-headers", program]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def test_the_symbols_are_a_package_of_their_own(
    architecture: str, package: Path, files: Path, tmp_path: Path
) -> None:
    if architecture != "amd64":
        pytest.skip("objdump reads the programs of this machine alone")
    assert ".debug_line" not in sections(files / "usr/bin/fccd")
    command = ["dpkg-deb", "--field", package, "Installed-Size"]
    installed = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    assert int(installed) < MOST_INSTALLED_KIB

    (symbols,) = package.parent.glob(f"fccd-dbgsym_*_{architecture}.ddeb")
    subprocess.run(["dpkg-deb", "--extract", symbols, tmp_path], check=True)
    (debug,) = (path for path in tmp_path.rglob("*") if path.is_file() and "doc" not in path.parts)
    assert debug.parent.parent == tmp_path / "usr/lib/debug/.build-id"
    assert ".debug_line" in sections(debug)
    # gdb and backtraces find it by this number.
    notes = subprocess.run(
        ["readelf", "--notes", files / "usr/bin/fccd"], check=True, capture_output=True, text=True
    ).stdout
    assert f"Build ID: {debug.parent.name}{debug.stem}" in notes


def test_an_upgrade_neither_starts_nor_stops_the_service(control: Path, tmp_path: Path) -> None:
    """The scripts run as dpkg runs them, with stubs that record calls and do nothing."""
    called = tmp_path / "called"
    tools = tmp_path / "bin"
    tools.mkdir()
    for tool in (
        "systemctl",
        "deb-systemd-invoke",
        "deb-systemd-helper",
        "invoke-rc.d",
        "systemd-sysusers",
        "udevadm",
        "service",
    ):
        (tools / tool).write_text(
            f'#!/bin/sh\necho "{tool} $*" >> {called}\n'
            # Nobody has enabled it.
            'case "$*" in *was-enabled*) exit 1 ;; esac\n'
        )
        (tools / tool).chmod(0o755)
    called.touch()
    steps = [
        ("preinst", "install"),
        ("postinst", "configure", ""),
        ("prerm", "upgrade", "2.0"),
        ("preinst", "upgrade", "1.0"),
        ("postrm", "upgrade", "2.0"),
        ("postinst", "configure", "1.0"),
    ]
    ran = 0
    for name, *words in steps:
        script = control / name
        if not script.exists():
            continue
        # Only the check for a running systemd is changed.
        text = script.read_text().replace("-d /run/systemd/system", "-d /")
        copy = tmp_path / name
        copy.write_text(text)
        environment = {
            "PATH": f"{tools}:/usr/bin:/bin",
            "DPKG_MAINTSCRIPT_NAME": name,
            "DPKG_MAINTSCRIPT_PACKAGE": "fccd",
        }
        subprocess.run(["sh", copy, *words], check=True, env=environment)
        ran += 1
    assert ran >= 2, "there are no scripts"
    meddled = re.findall(
        r".*\b(?:start|stop|restart|try-restart|reload|enable) .*", called.read_text()
    )
    assert meddled == []


def test_a_changed_configuration_is_kept(architecture: str, control: Path, files: Path) -> None:
    assert "/etc/fccd/fccd.toml" in (control / "conffiles").read_text().split()
    here = subprocess.run(
        ["dpkg", "--print-architecture"], capture_output=True, text=True, check=True
    )
    runner = [] if here.stdout.strip() == architecture else RUNNERS[architecture]
    program = [*runner, files / "usr/bin/fccd"]
    checked = subprocess.run([*program, "check", files / "etc/fccd/fccd.toml"], check=False)
    assert checked.returncode == 0


@pytest.mark.parametrize(
    "path",
    [
        "usr/lib/systemd/system/fccd.service|lib/systemd/system/fccd.service",
        "usr/share/man/man1/fccd.1.gz",
        "usr/share/man/man1/fccd-run.1.gz",
        "usr/share/bash-completion/completions/fccd",
        "usr/share/doc/fccd/copyright",
        "usr/share/doc/fccd/deploy.md",
        "usr/share/doc/fccd/guides/add-a-sensor.md",
        "usr/lib/sysusers.d/fccd.conf",
    ],
)
def test_the_package_contains(files: Path, path: str) -> None:
    assert any((files / place).is_file() for place in path.split("|"))


def test_its_manual_can_be_read(files: Path) -> None:
    page = files / "usr/share/man/man1/fccd-run.1.gz"
    text = subprocess.run(["gzip", "-dc", page], check=True, capture_output=True, text=True).stdout
    assert "--config" in text.replace("\\", "")


def test_it_requires_a_new_enough_c_library(control: Path, files: Path) -> None:
    asked = re.search(r"libc6 \(>= ([\d.]+)\)", (control / "control").read_text())
    assert asked is not None
    program = (files / "usr/bin/fccd").read_bytes()
    needed = {
        tuple(map(int, found.split(b".")))
        for found in re.findall(rb"GLIBC_(\d+\.\d+(?:\.\d+)?)", program)
    }
    assert max(needed)[:2] <= tuple(map(int, asked[1].split(".")))


def test_the_bill_of_materials_has_every_crate_with_its_licence(package: Path) -> None:
    text = (package.parent / "fccd.cdx.json").read_text()
    assert str(Path(__file__).parents[2]) not in text
    bill = json.loads(text)
    assert (bill["bomFormat"], bill["metadata"]["component"]["name"]) == ("CycloneDX", "fcc-daemon")
    lock = (Path(__file__).parents[2] / "Cargo.lock").read_text()
    versions = set(re.findall(r'name = "(.+)"\nversion = "(.+)"', lock))
    named = {(part["name"], part["version"]): part for part in bill["components"]}
    assert named.keys() <= versions
    assert {"iceoryx2", "mcap", "toml", "nix", "fcc-core"} <= {name for name, _ in named}
    for name, part in named.items():
        assert part["licenses"], name
