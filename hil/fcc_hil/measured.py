"""Pages of results: each section is written by the command that measured it."""

from __future__ import annotations

import os
import platform
import re
import subprocess
import time
from pathlib import Path

from . import replacement


def machine() -> str:
    """Return processors and kernel."""
    return f"{os.cpu_count()} processors, {platform.machine()}, kernel {platform.release()}"


def write(page: Path, title: str, command: str, text: str, seeds: str = "") -> None:
    """Replace the section with this title, or add it; the rest of the page stays."""
    words = ["git", "describe", "--always", "--dirty=, changed", "--exclude=*"]
    found = subprocess.run(
        words, cwd=Path(__file__).parent, capture_output=True, text=True, check=False
    )
    at = f"{time.strftime('%d %B %Y').lstrip('0')}, at commit {found.stdout.strip() or 'unknown'}"
    head = f"Measured on {at}. {machine()}{'; ' if seeds else ''}{seeds}."
    section = f"## {title}\n\n    {command}\n\n{head}\n\n{text}\n"
    parts = re.split(r"^(?=## )", page.read_text() if page.exists() else "", flags=re.MULTILINE)
    own = [n for n, part in enumerate(parts) if part.startswith(f"## {title}\n")] or [len(parts)]
    parts[own[0] : own[0] + 1] = [section]
    replacement.write(page, "\n".join(part.strip("\n") + "\n" for part in parts if part.strip()))
