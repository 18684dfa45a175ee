"""The mixed working day for half an hour at half of the peak: does anything grow, does anything fail, is anything lost?

    python deploy/load/soak.py --write                        finds the peak first (about 10 min), then 30 min at half of it
    python deploy/load/soak.py --peak 126 --minutes 30        with the peak given: users, of which 46 are fixed (see working_day.py)

Starts the shipped programs with TLS (installation.py) in a folder of its own, prepares the day, plays it, and takes a sample each 10 s.
The peak is the most users with 0 failures and a 95th percentile under --p95-ms over all requests, once everybody has signed in. Half of
it: half of those at desks; what is fixed, the 200 UAVs among it, stays. Memory is what each program has taken for itself (anonymous), its
slope a straight line through the samples after --warm-up-min, in percent an hour, with what it lies within 95 of 100 times. Ends with 1
where

    - a program, or all together, grows by more than 1 % an hour for sure: beyond that bound
    - connections to PostgreSQL, open files or keys of Redis that never expire end above where the warm-up ended (by over 10 % and 4)
    - a request failed for good, or an invariant of invariants.py is violated
"""

import argparse
import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

import numpy as np

from benchmarks.report import machine, table, write_section
from deploy.load.day.looking import Looking
from deploy.load.day.pictures import soak_picture
from deploy.load.day.playing import ALL, Playing, Served, playing
from deploy.load.day.site import Site
from deploy.load.day.slopes import GROWS, Slope, slope
from deploy.load.installation import Installation

ROOT = Path(__file__).resolve().parents[2]
DOCUMENT = ROOT / "docs" / "load-tests.md"
PICTURE = ROOT / "docs" / "load-tests" / "soak.svg"
TITLE = "Half an hour of a working day"
BAR_PERCENT_PER_H = 1.0
STEPS = (30, 60, 100, 160, 240, 340)  # people at desks, while the peak is looked for
STEP_S, SETTLES_S = 75.0, 10.0
PER_S = 2.0  # users that come a second
MIB = 2**20
CACHE = "redis"  # a few MiB, nearly all of it kept for a time that is stated: judged by what never expires
SLACK_SHARE, SLACK = 1.1, 4


def play(
    site: Installation,
    day: Path,
    users: int,
    seconds: float,
    meanwhile: Callable[[], None],
    every_s: float,
    name: str,
    *,
    counts_ramp: bool,
) -> Playing:
    """So long, with a look each so many seconds; returns when both have ended."""
    udp = site.address_for_uavs()
    with playing(day, site.address, site.authority, udp, users=users, spawn_rate=PER_S, name=name, counts_ramp=counts_ramp) as played:
        until_s = time.monotonic() + seconds
        while time.monotonic() < until_s:
            meanwhile()
            time.sleep(min(every_s, max(until_s - time.monotonic(), 0.0)))
    return played


def find_peak(site: Installation, day: Path, fixed: int, p95_ms: float) -> tuple[int, list[list[str]]]:
    """The most users of the steps that all get answers in time; 0 where not even the first do. With a row a step."""
    best, rows = 0, []
    for desks in STEPS:
        users = fixed + desks
        played = play(site, day, users, users / PER_S + STEP_S, lambda: None, 1.0, "peak", counts_ramp=False)
        whole = played.served()[ALL]
        rows.append([str(users), f"{whole.per_s:.1f}", str(whole.failures), f"{whole.p50_ms:.0f}", f"{whole.p95_ms:.0f}"])
        print(" | ".join(rows[-1]), *played.failures()[:3], sep="\n  ", flush=True)
        if whole.failures or whole.p95_ms > p95_ms:
            break
        best = users
        time.sleep(SETTLES_S)
    return best, rows


def flat(values: Sequence[int], after: int) -> bool:
    """Whether the last third is no higher than the first third after the warm-up was."""
    settled = values[after:]
    third = max(len(settled) // 3, 1)
    return max(settled[-third:]) <= SLACK_SHARE * max(settled[:third]) + SLACK


def invariants(site: Installation, day: Path) -> tuple[int, str]:
    command = [sys.executable, str(ROOT / "deploy" / "load" / "invariants.py"), "--day", str(day)]
    done = subprocess.run(command, env=site.environment(), cwd=ROOT, stdout=subprocess.PIPE, text=True, check=False)
    return done.returncode, done.stdout


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--minutes", type=float, default=30.0, help="after the warm-up")
    parser.add_argument("--warm-up-min", type=float, default=12.0)
    parser.add_argument("--peak", type=int, default=0, help="users at the peak; without it, it is looked for")
    parser.add_argument("--p95-ms", type=float, default=1_500.0)
    parser.add_argument("--every-s", type=float, default=10.0)
    parser.add_argument("--osm", type=Path, action="append", default=[], help="a real extract beside the demo region")
    parser.add_argument("--folder", type=Path, help="state folder, kept; without it a temporary one")
    parser.add_argument("--write", action="store_true", help="table and picture into docs/load-tests.md")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="sw-soak-") as temporary:
        return run(options, options.folder or Path(temporary))


def run(options: argparse.Namespace, folder: Path) -> int:
    day = folder / "day"
    with Installation(folder / "installation", {"web": 2}) as site:
        prepare = [sys.executable, str(ROOT / "deploy" / "load" / "prepare_day.py"), "--out", str(day)]
        prepare += [part for extract in options.osm for part in ("--osm", str(extract.resolve()))]
        if not (day / "day.json").exists():
            subprocess.run(prepare, env=site.environment(), cwd=ROOT, check=True)
        fixed = Site.read(day).fixed_users
        peak, steps = (options.peak, []) if options.peak else find_peak(site, day, fixed, options.p95_ms)
        if not peak:
            print("not even the least load was served in time", file=sys.stderr)
            return 1
        users = max(fixed + (peak - fixed) // 2, fixed)
        looking = Looking(site)
        warm_up_s = 60.0 * options.warm_up_min
        played = play(site, day, users, warm_up_s + 60.0 * options.minutes, looking.look, options.every_s, "soak", counts_ramp=True)
        code, reported = invariants(site, day)
    (folder / "samples.json").write_text(json.dumps([asdict(one) for one in looking.samples]))
    return report(options, looking, played, steps, (peak, users), (code, reported))


def report(
    options: argparse.Namespace, looking: Looking, played: Playing, steps: list[list[str]], users: tuple[int, int], held: tuple[int, str]
) -> int:
    samples, warm_up_s = looking.samples, 60.0 * options.warm_up_min
    after = next((number for number, one in enumerate(samples) if one.at_s - samples[0].at_s >= warm_up_s), len(samples) - 4)
    at_s = np.array([one.at_s for one in samples[after:]])
    names = sorted(samples[-1].own_bytes)
    slopes = {name: slope(at_s, np.array([float(one.own_bytes.get(name, 0)) for one in samples[after:]])) for name in names}
    slopes["all programs"] = slope(at_s, np.array([float(one.all_bytes) for one in samples[after:]]))
    whole = played.served()[ALL]
    grown = [name for name, found in slopes.items() if found.verdict(BAR_PERCENT_PER_H) == GROWS and name != CACHE]
    missed = [f"{name} grows: {slopes[name]} % an hour" for name in grown]
    if not flat([one.redis_lasting for one in samples], after):
        missed.append("keys of Redis that never expire are not flat")
    if not flat([one.connections for one in samples], after):
        missed.append("connections to PostgreSQL are not flat")
    missed += [f"open files of {name} are not flat" for name in names if not flat([one.files.get(name, 0) for one in samples], after)]
    missed += [f"{whole.failures} requests failed: {'; '.join(played.failures()[:3])}"] if whole.failures else []
    missed += ["an invariant is violated"] if held[0] else []
    missed += [f"{looking.restarts} programs were started again"] if looking.restarts else []
    text = section(options, looking, whole, slopes, steps, users, held[1], missed)
    print(text)
    if options.write:
        soak_picture(PICTURE, samples, warm_up_s, f"{users[1]} users and 200 UAVs, half of the peak")
        write_section(TITLE, text, DOCUMENT)
    for words in missed:
        print(f"MISSED: {words}", file=sys.stderr)
    return 1 if missed else 0


def section(
    options: argparse.Namespace,
    looking: Looking,
    whole: Served,
    slopes: dict[str, Slope],
    steps: list[list[str]],
    users: tuple[int, int],
    reported: str,
    missed: list[str],
) -> str:
    first, last = looking.samples[0], looking.samples[-1]
    grown = sorted(last.tables, key=lambda name: first.tables.get(name, (0, 0))[0] - last.tables[name][0])[:4]
    rows = [
        [name, f"{found.mean / MIB:.0f}", str(found), found.verdict(BAR_PERCENT_PER_H), str(last.files.get(name, ""))]
        for name, found in sorted(slopes.items(), key=lambda item: item[0] == "all programs")
    ]
    peak = table(["users", "requests/s", "failures", "p50 ms", "p95 ms"], steps) + "\n\n" if steps else ""
    asked = f"--peak {users[0]} --minutes {options.minutes:g} --warm-up-min {options.warm_up_min:g}"
    return f"""`python deploy/load/soak.py {asked} --write`: {users[1]} users and 200 UAVs at 1 Hz
for {options.minutes:g} min after {options.warm_up_min:g} min of warm-up, half of the peak of {users[0]} users (0 failures, p95 under
{options.p95_ms:g} ms). {whole.requests:,} requests, {whole.per_s:.1f} a second, {whole.failures} failures, p50 {whole.p50_ms:.0f} ms,
p95 {whole.p95_ms:.0f} ms. {"Every bar was held." if not missed else "Missed: " + "; ".join(missed) + "."}
{machine("granian", "django", "channels", "celery", "psycopg", "locust")}

![Memory, connections and Redis over the run](load-tests/soak.svg)

{peak}{table(["program", "memory, MiB", "slope, % an hour, 95 %", "verdict", "files open"], rows)}

Connections to PostgreSQL {first.connections} to {last.connections}; Redis {first.redis_bytes / MIB:.1f} to {last.redis_bytes / MIB:.1f}
MiB, {first.redis_keys} to {last.redis_keys} keys, of which
{last.redis_lasting} never expire; waiting in queues at most {max(one.waiting for one in looking.samples)}; dead rows
{last.dead_rows:,} of tables that grew from {first.tables_bytes / MIB:.0f} to {last.tables_bytes / MIB:.0f} MiB, most of it
{", ".join(grown)}.

{reported.strip()}"""


if __name__ == "__main__":
    sys.exit(main())
