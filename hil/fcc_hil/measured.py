"""When a result was measured, and what."""

from __future__ import annotations

import subprocess
import time
from pathlib import Path


def measured() -> str:
    """Return the date and the commit of this tree, as results begin."""
    words = ["git", "describe", "--always", "--dirty=, changed", "--exclude=*"]
    found = subprocess.run(
        words, cwd=Path(__file__).parent, capture_output=True, text=True, check=False
    )
    commit = found.stdout.strip() or "unknown"
    return f"Measured on {time.strftime('%d %B %Y').lstrip('0')}, at commit {commit}"
