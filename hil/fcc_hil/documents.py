"""Writes figures as JSON."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from . import replacement


def write(path: Path, document: object) -> None:
    """Write a document; what is not finite, as the figure of what never was, is null."""
    text = json.dumps(_finite(document), indent=2, allow_nan=False)
    replacement.write(path, text + "\n")


def _finite(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {key: _finite(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(one) for one in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
