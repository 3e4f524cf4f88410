"""Several draws of the same flight: the first, and all of them in `make test-seeds`."""

from __future__ import annotations

import os
from typing import TypeVar

Draw = TypeVar("Draw")


def first_of(*draws: Draw) -> tuple[Draw, ...]:
    """Return the first, or all."""
    return draws if "FCC_SEEDS" in os.environ else draws[:1]
