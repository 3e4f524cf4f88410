"""What the programs are built and tested with is locked, and the locks fit what is required."""

from __future__ import annotations

import re
import shlex
import subprocess
from pathlib import Path

import pytest
import tomlkit
from packaging.requirements import Requirement

ROOT = Path(__file__).parents[2]
HIL = ROOT / "hil"


def locked(name: str) -> list[tuple[Requirement, int]]:
    """Return what a lock installs, and the number of its hashes."""
    text = re.sub(r"\s+#.*", "", (HIL / name).read_text()).replace("\\\n", " ")
    entries = [line.split("--hash=") for line in text.splitlines() if line and line[0].isalnum()]
    return [(Requirement(entry[0].strip()), len(entry) - 1) for entry in entries]


def required(name: str) -> list[str]:
    """Return what a lock is made of."""
    if name == "locked-packaging.txt":
        lines = (HIL / "packaging.in").read_text().splitlines()
        return [line for line in lines if not line.startswith("#")]
    project = tomlkit.parse((HIL / "pyproject.toml").read_text()).unwrap()["project"]
    extras = project["optional-dependencies"]
    return [*project["dependencies"], *extras["build"], *extras["test"]]


@pytest.mark.parametrize("name", ["locked.txt", "locked-packaging.txt"])
def test_the_lock_has_a_hash_and_a_fitting_version_of_each_package(name: str) -> None:
    """After a change of pyproject.toml: `make lock`."""
    entries = locked(name)
    assert entries
    assert all(hashes > 0 for _, hashes in entries)
    for line in required(name):
        wanted = Requirement(line)
        found = [entry for entry, _ in entries if entry.name == wanted.name]
        assert found, line
        for entry in found:
            (version,) = (pinned.version for pinned in entry.specifier)
            assert wanted.specifier.contains(version), line


def test_nothing_is_installed_without_a_hash() -> None:
    makefile = (ROOT / "Makefile").read_text()
    installs = [line for line in makefile.splitlines() if "pip install" in line]
    assert len(installs) == 5
    locked_files = ("hil/locked", "web/tests/locked")
    for line in installs:
        hashed = any(f"--require-hashes -r {name}" in line for name in locked_files)
        assert hashed or "--no-deps" in line, line


def test_a_build_for_others_names_no_folder_of_this_machine() -> None:
    done = subprocess.run(
        [ROOT / "scripts" / "build-flags"], capture_output=True, text=True, check=True
    )
    exported = dict(words[1].split("=", 1) for words in map(shlex.split, done.stdout.splitlines()))
    assert int(exported["SOURCE_DATE_EPOCH"]) > 1_600_000_000
    for flags, option in (("RUSTFLAGS", "--remap-path-prefix="), ("CFLAGS", "-ffile-prefix-map=")):
        maps = [word.removeprefix(option) for word in exported[flags].split() if option in word]
        assert f"{ROOT}=/build/fccd" in maps
        assert all(to.split("=")[1].startswith("/build/") for to in maps)


def test_the_daemon_is_built_from_the_libraries_of_the_python_module() -> None:
    """Else `make build` compiles them once more; pyo3 is the module's alone."""

    def libraries(*words: str) -> set[str]:
        tree = ["cargo", "tree", "--locked", "--prefix=none", "--no-dedupe", "--edges=normal,build"]
        done = subprocess.run(
            [*tree, "--format={p} {f}", *words],
            cwd=ROOT,
            capture_output=True,
            text=True,
            check=True,
        )
        return {line for line in done.stdout.splitlines() if not line.startswith("pyo3")}

    makefile = (ROOT / "Makefile").read_text()
    assert "cargo build --locked --release -p fcc-daemon -p fcc-py --bin fccd" in makefile
    module = libraries("--package=fcc-py", "--features=pyo3/extension-module")
    assert module <= libraries("--package=fcc-py", "--package=fcc-daemon")
