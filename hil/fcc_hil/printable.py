"""Prints texts from outside, which may contain what a terminal obeys.

Names of files, messages of a daemon and of a simulator may contain escape sequences, and characters
that change the direction of writing. The daemon's own messages are escaped by the daemon, in the
same way (``fcc_telemetry::printable``).
"""

from __future__ import annotations

import sys
import unicodedata
from typing import TextIO

# Unicode's property Bidi_Control, and its ends of line and of paragraph.
_REORDER = {0x61C, 0x200E, 0x200F, *range(0x2028, 0x202F), *range(0x2066, 0x206A)}


def printable(text: object) -> str:
    r"""Return the text, with what a terminal obeys written as ``\u{1b}``."""
    return "".join(
        f"\\u{{{ord(c):x}}}"
        if c not in "\n\t" and (unicodedata.category(c) == "Cc" or ord(c) in _REORDER)
        else c
        for c in str(text)
    )


def say(text: object, to: TextIO | None = None, end: str = "\n") -> None:
    """Print a text on standard output, or to another file, at once."""
    print(printable(text), end=end, file=sys.stdout if to is None else to, flush=True)
