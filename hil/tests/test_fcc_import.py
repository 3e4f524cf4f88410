"""The module where Python finds no numpy."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path


def imported_after(statement: str, folder: Path) -> str:
    """Return the errors of a Python that imports the module after a statement."""
    command = [sys.executable, "-c", f"import sys; {statement}; import fcc"]
    run = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert run.returncode == 1, run.stderr
    return run.stderr


def test_without_numpy_it_is_an_import_error_with_what_to_do(tmp_path: Path) -> None:
    said = imported_after("sys.modules['numpy'] = None", tmp_path)
    assert "panic" not in said.lower(), said
    last = said.splitlines()[-1]
    assert last.startswith("ImportError: numpy, 1.23 or newer, cannot be imported (import of")
    assert "python -m pip install numpy" in last


def test_a_file_in_the_place_of_numpy_is_named(tmp_path: Path) -> None:
    (tmp_path / "numpy.py").write_text("")
    said = imported_after("sys.path.insert(0, '')", tmp_path)
    assert "panic" not in said.lower(), said
    assert "a file numpy.py of your own needs another name" in said.splitlines()[-1]
