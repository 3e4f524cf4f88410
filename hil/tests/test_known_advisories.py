"""The check of Cargo.lock by the advisories that are kept with the sources."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

SCRIPTS = Path(__file__).resolve().parents[2] / "scripts"


def check(root: Path, crate: str, version: str) -> subprocess.CompletedProcess[str]:
    (root / "scripts").mkdir()
    for name in ("known-advisories", "advisories.tsv"):
        shutil.copy(SCRIPTS / name, root / "scripts")
    (root / "Cargo.lock").write_text(
        f'[[package]]\nname = "{crate}"\nversion = "{version}"\n'
        'source = "registry+https://github.com/rust-lang/crates.io-index"\n'
    )
    words: list[str | Path] = [sys.executable, root / "scripts/known-advisories"]
    return subprocess.run(words, capture_output=True, text=True, check=False, timeout=30)


@pytest.mark.parametrize(
    ("crate", "version", "advisory"),
    [
        # rustsec.org/advisories: patched from 0.3.47 on, unaffected below 0.3.6.
        ("time", "0.3.46", "RUSTSEC-2026-0009"),
        ("time", "0.3.47", None),
        ("time", "0.3.5", None),
        # Patched in 0.7.4 and in 0.8.1.
        ("crossbeam-deque", "0.7.3", "RUSTSEC-2021-0093"),
        ("crossbeam-deque", "0.7.4", None),
        ("crossbeam-deque", "0.8.0", "RUSTSEC-2021-0093"),
        ("crossbeam-deque", "0.8.1", None),
    ],
)
def test_an_affected_version_is_found(
    tmp_path: Path, crate: str, version: str, advisory: str | None
) -> None:
    checked = check(tmp_path, crate, version)
    assert checked.returncode == (0 if advisory is None else 1)
    if advisory is not None:
        assert f"{advisory}: {crate} {version}: " in checked.stdout


def test_what_is_not_maintained_and_what_is_not_known_are_said(tmp_path: Path) -> None:
    unmaintained = check(tmp_path, "paste", "1.0.15")
    assert unmaintained.returncode == 0
    assert "RUSTSEC-2024-0436: paste 1.0.15: unmaintained" in unmaintained.stdout
    (tmp_path / "later").mkdir()
    later = check(tmp_path / "later", "of-tomorrow", "0.1.0")
    assert later.returncode == 0
    assert "NOT CHECKED, newer than the copy: of-tomorrow" in later.stdout
