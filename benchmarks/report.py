"""Figures of a run as a section of docs/performance.md or another document, with the machine, the day and the versions."""

import os
import platform
from collections.abc import Sequence
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path

PERFORMANCE = Path(__file__).resolve().parent.parent / "docs" / "performance.md"


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    return "\n".join("| " + " | ".join(cells) + " |" for cells in (head, ["---"] * len(head), *rows))


def machine(*packages: str) -> str:
    """One line: day, processors and their load, Python and packages."""
    load = os.getloadavg()[0]
    versions = ", ".join(f"{name} {version(name)}" for name in packages)
    today = datetime.now(UTC).date().isoformat()
    return f"{today}; {os.cpu_count()} cores, load {load:.1f} at the end; Python {platform.python_version()}, {versions}."


def write_section(title: str, text: str, document: Path = PERFORMANCE) -> None:
    """Put the section in place of the one with this title, or at the end."""
    sections = document.read_text().split("\n## ")
    section = f"{title}\n\n{text.strip()}\n"
    places = [number for number, old in enumerate(sections) if old.split("\n", 1)[0] == title]
    if places:
        sections[places[0]] = section
    else:
        sections[-1] = sections[-1].rstrip("\n") + "\n"
        sections.append(section)
    document.write_text("\n## ".join(sections))
