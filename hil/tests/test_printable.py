"""What is printed: what comes from outside as text, and not without being written."""

from __future__ import annotations

import io
import subprocess
import sys
from pathlib import Path

import pytest

from fcc_hil.printable import printable, say

HOSTILE = "a\x1b]0;title\x07\x9b31m\u202eb"
SHOWN = "a\\u{1b}]0;title\\u{7}\\u{9b}31m\\u{202e}b"


def test_what_a_terminal_obeys_is_escaped_as_the_daemon_does_it() -> None:
    assert printable(HOSTILE) == SHOWN
    plain = "°C → ½ m/s²\n\tΔ 漢字"
    assert printable(plain) == plain
    printed = io.StringIO()
    say(HOSTILE, to=printed)
    assert printed.getvalue() == SHOWN + "\n"


@pytest.mark.parametrize("words", [["--help"], ["fly", "--help"]])
def test_help_that_cannot_be_written_is_an_error(words: list[str]) -> None:
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(
            [sys.executable, "-m", "fcc_hil", *words],
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            check=False,
        )
    assert done.returncode == 1
    assert "the output could not be written: " in done.stderr


def test_the_commands_that_fly_the_daemon_need_no_module_of_it() -> None:
    # `make fly-jsbsim` installs none. A module that is None cannot be imported.
    script = "import sys; sys.modules['fcc'] = None; from fcc_hil import __main__"
    done = subprocess.run([sys.executable, "-c", script], stderr=subprocess.PIPE, check=False)
    assert done.returncode == 0, done.stderr.decode()
