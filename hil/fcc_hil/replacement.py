"""Writes files whole: beside what was there, which they replace at the end."""

from __future__ import annotations

import os
import stat
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO, TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def refusal(path: Path) -> str | None:
    """Say why nothing is written there: a link, a folder, a pipe, or another user's file."""
    try:
        there = path.lstat()
    except OSError:
        return None
    if stat.S_ISDIR(there.st_mode):
        return "is a folder: give a file"
    if stat.S_ISLNK(there.st_mode):
        return "is a link: give the name of a file that it leads to, or another one"
    if not stat.S_ISREG(there.st_mode):
        return "is a pipe or a device: give a file"
    if there.st_uid != os.geteuid():
        return "belongs to another user: give another name, or remove it"
    return None


@contextmanager
def replacing(path: Path) -> Iterator[IO[bytes]]:
    """Open a file for writing that takes the place of `path` once it is whole.

    Raises OSError, and what was there is kept then.
    """
    if why := refusal(path):
        raise OSError(f"{path} {why}")
    number, beside = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    try:
        with os.fdopen(number, "wb") as file:
            yield file
        mask = os.umask(0)
        os.umask(mask)
        Path(beside).chmod(0o666 & ~mask)
        Path(beside).replace(path)
    except BaseException:
        with suppress(OSError):
            Path(beside).unlink()
        raise


def write(path: Path, text: str) -> None:
    """Write a text."""
    with replacing(path) as file:
        file.write(text.encode())


def draw(path: Path, figure: Figure, dpi: int) -> None:
    """Write a picture, of the kind that the name ends with, or PNG."""
    with replacing(path) as file:
        figure.savefig(file, format=path.suffix.removeprefix(".") or "png", dpi=dpi)
