"""What comes from outside does not reach the terminal as an escape sequence."""

from __future__ import annotations

import io

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
