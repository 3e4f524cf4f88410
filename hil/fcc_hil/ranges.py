"""Arguments of a command line, refused before flying: numbers in their range, files to write."""

from __future__ import annotations

import argparse
import os
from collections.abc import Callable
from pathlib import Path

from . import replacement

LARGEST_SEED = 2**32 - 1
_MOST_PROCESSES = 1_024


def whole(least: int, most: int) -> Callable[[str], int]:
    """Return the reader of a whole number; it raises argparse.ArgumentTypeError."""

    def read(text: str) -> int:
        # No number here has more digits.
        is_number = text.isascii() and text.isdigit() and len(text) <= len(str(most)) + 4
        if not is_number or not least <= int(text) <= most:
            raise argparse.ArgumentTypeError(
                f"'{text}': give a whole number from {least} to {most}"
            )
        return int(text)

    return read


def number(least: float, most: float, unit: str = "") -> Callable[[str], float]:
    """Return the reader of a number; it raises argparse.ArgumentTypeError."""

    def read(text: str) -> float:
        try:
            value = float(text)
        except ValueError:
            value = least - 1.0
        # Not a number is in no range.
        if not least <= value <= most:
            raise argparse.ArgumentTypeError(
                f"'{text}': give a number from {least:g} to {most:g} {unit}".rstrip()
            )
        return value

    return read


def numbers(least: float, most: float, unit: str = "") -> Callable[[str], tuple[float, ...]]:
    """Return the reader of numbers with commas in between, each in the range."""
    one = number(least, most, unit)
    return lambda text: tuple(one(part) for part in text.split(","))


def names(of: tuple[str, ...]) -> Callable[[str], tuple[str, ...]]:
    """Return the reader of names with commas in between; it raises argparse.ArgumentTypeError."""

    def read(text: str) -> tuple[str, ...]:
        given = tuple(text.split(","))
        for name in given:
            if name not in of:
                raise argparse.ArgumentTypeError(f"'{name}': choose of {', '.join(of)}")
        return given

    return read


_MCAP_MAGIC = b"\x89MCAP0\r\n"
_PLAN_MAGIC = b"QGC WPL"
"""How the files begin that are not replaced by pictures and figures."""


def file_to_write(text: str) -> Path:
    """Read a path, before flying: a file can be written there, or argparse.ArgumentTypeError."""
    path = Path(text)
    folder = path.parent
    if text == "-":
        raise argparse.ArgumentTypeError("'-' is a file here: give another name, or ./-")
    if why := replacement.refusal(path):
        raise argparse.ArgumentTypeError(f"'{text}' {why}")
    if not folder.is_dir():
        raise argparse.ArgumentTypeError(f"'{text}': there is no folder '{folder}': create it")
    if not os.access(path if path.exists() else folder, os.W_OK):
        raise argparse.ArgumentTypeError(f"'{text}' may not be written: give another file")
    if path.is_file() and os.access(path, os.R_OK):
        with path.open("rb") as file:
            begin = file.read(len(_MCAP_MAGIC))
        for magic, what in ((_MCAP_MAGIC, "a recording"), (_PLAN_MAGIC, "a flight plan")):
            if begin.startswith(magic):
                raise argparse.ArgumentTypeError(
                    f"'{text}' is {what}, which is not replaced: give another file"
                )
    return path


count = whole(1, 1_000_000)
workers = whole(1, _MOST_PROCESSES)


def add_files(parser: argparse.ArgumentParser, **files: str) -> None:
    """Add an option for each file to be written, by its name and its help."""
    for name, words in files.items():
        parser.add_argument(f"--{name}", type=file_to_write, metavar="FILE", help=words)


def add_workers(parser: argparse.ArgumentParser) -> None:
    """Add the option for the number of processes."""
    parser.add_argument("--workers", type=workers, metavar="N", help="processes (all processors)")


def add_seed(parser: argparse.ArgumentParser, words: str = "of all errors (default: 1)") -> None:
    """Add the option for a seed."""
    parser.add_argument("--seed", type=whole(0, LARGEST_SEED), default=1, metavar="N", help=words)


def add_daemon(parser: argparse.ArgumentParser) -> None:
    """Add the required option for the daemon's program."""
    parser.add_argument("--fccd", type=Path, required=True, help="the daemon's program")
