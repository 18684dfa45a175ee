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
    owner = {pid: name for name, pids in roots.items() for pid in pids}
    parents, found = {}, {}
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                fields = (entry / "stat").read_text().rpartition(")")[2].split()
            except OSError:
                continue
            pid = int(entry.name)
            parents[pid] = int(fields[1])
            found[pid] = Usage(1, sum(map(int, fields[11:15])) / TICKS_PER_S, int(fields[21]) * PAGE_BYTES)

    total = dict.fromkeys(roots, Usage(0, 0.0, 0))
    for pid, taken in found.items():
        above = pid
        while above > 1 and above not in owner:
            above = parents.get(above, 0)
        if above in owner:
            total[owner[above]] += taken
    return total


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
