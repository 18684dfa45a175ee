"""What processes take of the machine, as /proc tells it."""

import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

TICKS_PER_S = os.sysconf("SC_CLK_TCK")
PAGE_BYTES = os.sysconf("SC_PAGE_SIZE")


@dataclass(frozen=True)
class Usage:
    """Of a process and those below it. `cpu_s` counts those that have ended and were collected, too; `resident_bytes` counts what
    processes share once for each.
    """

    processes: int
    cpu_s: float
    resident_bytes: int

    def __add__(self, other: "Usage") -> "Usage":
        return Usage(self.processes + other.processes, self.cpu_s + other.cpu_s, self.resident_bytes + other.resident_bytes)


def usage(roots: Mapping[str, Iterable[int]]) -> dict[str, Usage]:
    """By name: what the processes with these ids and all below them have taken so far. One look at /proc for all of them."""
    stats = _stats()
    return {name: sum((_usage(stats[pid]) for pid in pids), Usage(0, 0.0, 0)) for name, pids in _families(roots, stats).items()}


def families(roots: Mapping[str, Iterable[int]]) -> dict[str, list[int]]:
    """By name: each of these processes with all below it. One that stands below two of them belongs to the nearer."""
    return _families(roots, _stats())


def _families(roots: Mapping[str, Iterable[int]], stats: Mapping[int, list[str]]) -> dict[str, list[int]]:
    owner = {pid: name for name, pids in roots.items() for pid in pids}
    found: dict[str, list[int]] = {name: [] for name in roots}
    for pid in stats:
        above = pid
        while above > 1 and above not in owner:
            above = int(stats[above][1]) if above in stats else 0
        if above in owner:
            found[owner[above]].append(pid)
    return found


def _stats() -> dict[int, list[str]]:
    """What /proc tells of each process behind its name."""
    found = {}
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                found[int(entry.name)] = (entry / "stat").read_text().rpartition(")")[2].split()
            except OSError:
                continue
    return found


def _usage(fields: list[str]) -> Usage:
    return Usage(1, sum(map(int, fields[11:15])) / TICKS_PER_S, int(fields[21]) * PAGE_BYTES)


def machine_busy_s() -> float:
    """Seconds that all cores together have not been idle."""
    ticks = [int(part) for part in Path("/proc/stat").read_text().splitlines()[0].split()[1:9]]
    return (sum(ticks) - ticks[3] - ticks[4]) / TICKS_PER_S


def processes_named(*names: str) -> list[int]:
    """Process ids of programs that were there before."""
    found = []
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                if (entry / "comm").read_text().strip() in names:
                    found.append(int(entry.name))
            except OSError:
                continue
    return found
