"""A local scaler in a cluster's place: starts and stops replicas by the rules of the shipped autoscalers, while a ramp of users goes on.

    python deploy/load/scaling/scaler.py --write     plans in web (17 min) and large plans in workers (15 min):
    docs/load-tests.md
    python deploy/load/scaling/scaler.py --ramp 6 --seconds 0.2   five times as fast, autoscalers included, to develop with

The proxy asks a name server for the replicas of web, as in Kubernetes. A new one is named once it says that it is ready; one that goes is
first forgotten, has the seconds of its Deployment's preStop, and is then stopped softly. Ends with 1 if a request failed, or if replicas
did not follow up and down again.
"""

import argparse
import json
import resource
import sys
import time
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import asdict, replace
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[3]))

import numpy as np
import yaml
from redis import Redis

from benchmarks.report import machine, write_section
from config.private_servers import state_directory
from deploy.load.ground import bring_ground
from deploy.load.installation import Installation
from deploy.load.pictures import replicas_picture
from deploy.load.report import DOCUMENT, PICTURES, RunReport
from deploy.load.run import run_scenario, warm_up
from deploy.load.scaling.autoscaling import PROGRAMS, Book, Rules, decide, shipped_rules
from deploy.load.scenarios import RAMPS_TO_SCALE_BY

MAX_HERE = {"web": 8, "worker-planning": 12}  # what the machine's memory has room for
KINDS = {5: "web", 6: "worker-planning"}
READY_S = 300.0
FORGETS_S = 3.0  # the proxy asks for names every two seconds


class LocalScaler:
    """Looks at one program as often as its autoscaler would, and brings its replicas to the number that is wanted."""

    def __init__(self, installation: Installation, kind: str, rules: Rules, *, drains_s: float) -> None:
        self.installation, self.kind, self.rules, self.drains_s = installation, kind, rules, drains_s
        self.steps: list[tuple[float, int]] = []  # when, how many serve
        self.signals: list[tuple[float, float]] = []  # when, of what each should have a share of 1
        self._book = Book()
        self._wanted = len(installation.names(kind))
        self._serving = set(installation.names(kind))
        self._starting: set[str] = set()
        self._leaving: set[str] = set()
        self._next_poll_s = 0.0
        self._last: tuple[float, dict[str, float]] = (0.0, {})
        self._queue = Redis.from_url(installation.settings["REDIS_URL"])
        self._threads = ThreadPoolExecutor(4)
        self._actions: list[Future[None]] = []

    def look(self, at_s: float) -> None:
        """Once a second with the run's time; does something when the rules say that it is time."""
        if not self.steps or self.steps[-1][1] != len(self._serving):
            self.steps.append((at_s, len(self._serving)))
        if at_s < self._next_poll_s:
            return
        self._next_poll_s = at_s + self.rules.poll_interval_s
        total = float(self._queue.llen(self.rules.queue)) if self.rules.queue else self._cores()  # type: ignore[arg-type]
        self.signals.append((at_s, total / (self.rules.target * self._wanted)))
        wanted, self._book = decide(self.rules, self._book, now_s=at_s, replicas=self._wanted, total=total)
        self._wanted = wanted
        missing = wanted - len(self._serving) - len(self._starting)
        free = [name for name in self.installation.spare_names(self.kind) if name not in self._leaving | self._starting]
        for name in free[: max(0, missing)]:
            self._starting.add(name)
            self._actions.append(self._threads.submit(self._bring, name))
        serving = sorted(self._serving, key=_number)  # the newest go first; what is still starting does not serve in their place
        for name in serving[max(wanted, len(serving) + min(0, missing)) :]:
            self._serving.discard(name)
            self._leaving.add(name)
            self._actions.append(self._threads.submit(self._take_away, name))

    def close(self) -> list[str]:
        """Waits for what is being done; what has gone wrong in it."""
        self._threads.shutdown(wait=True)
        return [f"{action.exception()!r}" for action in self._actions if action.exception()]

    def _cores(self) -> float:
        """Cores in use by those that serve, since the last look. What a replica takes to start does not count, as with the autoscaler."""
        usage, now_s = self.installation.usage(), time.monotonic()
        spent = {name: usage[name].cpu_s for name in list(self._serving) if name in usage}
        before_s, before = self._last
        self._last = now_s, spent
        common = spent.keys() & before.keys()
        return sum(spent[name] - before[name] for name in common) / (now_s - before_s) * len(spent) / len(common) if common else 0.0

    def _bring(self, name: str) -> None:
        try:
            self.installation.start(name)
            if self.kind == "web":
                end_s = time.monotonic() + READY_S
                while not self.installation.is_ready(name):
                    if time.monotonic() > end_s:
                        raise TimeoutError(f"{name} was not ready in {READY_S:.0f} s")
                    time.sleep(0.2)
                self.installation.let_in(name)
            self._serving.add(name)
        finally:
            self._starting.discard(name)

    def _take_away(self, name: str) -> None:
        try:
            if self.kind == "web":
                self.installation.keep_out(name)
                time.sleep(self.drains_s)
            self.installation.stop(name)
        finally:
            self._leaving.discard(name)


def _number(name: str) -> int:
    number = name.rpartition("-")[2]
    return int(number) if number.isdigit() else 1


def pre_stop_s(program: str) -> float:
    """What the Deployment waits before it ends a replica."""
    documents = yaml.safe_load_all((PROGRAMS / f"{program}.yaml").read_text())
    deployment = next(one for one in documents if one and one["kind"] == "Deployment")
    container = deployment["spec"]["template"]["spec"]["containers"][0]
    return float(container["lifecycle"]["preStop"]["exec"]["command"][1]) if "lifecycle" in container else 0.0


def run_ramp(number: int, *, users: float, seconds: float, sessions: float) -> tuple[RunReport, LocalScaler, list[str]]:
    """One ramp on an installation that begins with as few replicas as its autoscalers allow."""
    kind = KINDS[number]
    rules = {name: shipped_rules(name).faster(seconds) for name in MAX_HERE}
    least = {name: rule.least for name, rule in rules.items()}
    spare = {kind: MAX_HERE[kind] - rules[kind].least}
    limited = {name: replace(rule, most=min(rule.most, MAX_HERE[name])) for name, rule in rules.items()}
    with Installation(state_directory() / "load", least, spare=spare, by_name=True) as installation:
        ground = bring_ground(installation)
        warm_up(installation, ground)
        scaler = LocalScaler(installation, kind, limited[kind], drains_s=max(FORGETS_S, pre_stop_s(kind) * seconds))
        report = run_scenario(
            installation,
            ground,
            RAMPS_TO_SCALE_BY[number],
            users=users,
            seconds=seconds,
            sessions=sessions,
            bodies="missions.json" if kind == "web" else "large_missions.json",
            meanwhile=scaler.look,
        )
        faults = scaler.close()
    return report, scaler, faults


def missed(report: RunReport, scaler: LocalScaler, faults: list[str]) -> list[str]:
    """What the ramp was to show and has not."""
    numbers = [number for _, number in scaler.steps]
    found = [f"{report.failures} of {report.answers:,} requests failed"] if report.failures else []
    if max(numbers) <= scaler.rules.least:
        found.append("no replica was added")
    if numbers[-1] != scaler.rules.least:
        found.append(f"{numbers[-1]} replicas are left at the end, not {scaler.rules.least}")
    return [*found, *faults]


def write(number: int, report: RunReport, scaler: LocalScaler) -> None:
    picture = PICTURES / f"scaler-{scaler.kind}.svg"
    series = dict(report.series) | {
        "signal_at_s": np.array([at_s for at_s, _ in scaler.signals]),
        "signal": np.array([signal for _, signal in scaler.signals]),
    }
    replicas_picture(
        picture,
        series,
        f"{scaler.kind} follows its autoscaler's rules",
        replicas={scaler.kind: np.array([*scaler.steps, (series["at_s"][-1], scaler.steps[-1][1])], dtype=float)},
        signal="load a replica / target",
    )
    scaled = f" --users {report.users_share:g} --seconds {report.seconds_share:g}" if report.is_scaled else ""
    steps = ", ".join(f"{count} from {at_s:.0f} s" for at_s, count in scaler.steps)
    target = f"{scaler.rules.target:g} messages of its queue" if scaler.rules.queue else f"{scaler.rules.target:g} cores"
    text = "\n\n".join(
        [
            f"`python deploy/load/scaling/scaler.py --ramp {number}{scaled} --write`. {machine('granian', 'celery', 'django', 'locust')}",
            f"{RAMPS_TO_SCALE_BY[number].article} A replica should have {target}; {report.answers:,} answers, {report.failures} failures"
            + "".join(f"; {count} × {fault}" for fault, count in report.faults.items())
            + f". Replicas of {scaler.kind}: {steps}.",
            f"![Users, the signal, replicas and time of answers over the ramp](load-tests/{picture.name})",
        ]
    )
    write_section(f"Replicas follow load: {scaler.kind}", text, DOCUMENT)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument(
        "--ramp", type=int, nargs="+", choices=KINDS, default=list(KINDS), help="5: plans in web; 6: large plans in workers"
    )
    parser.add_argument("--users", type=float, default=1.0, help="share of the ramp's users")
    parser.add_argument("--seconds", type=float, default=1.0, help="share of the ramp's time and of the autoscalers' own")
    parser.add_argument("--sessions", type=float, default=0.05, help="share of users who sign in with a password")
    parser.add_argument("--json", type=Path)
    parser.add_argument("--write", action="store_true", help="put text and pictures into docs/load-tests.md")
    options = parser.parse_args()

    _, most_files = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (most_files, most_files))
    reported, problems = [], []
    for number in options.ramp:
        report, scaler, faults = run_ramp(number, users=options.users, seconds=options.seconds, sessions=options.sessions)
        print(report.text())
        print(f"replicas of {scaler.kind}: {', '.join(f'{count} from {at_s:.0f} s' for at_s, count in scaler.steps)}", flush=True)
        problems += [f"ramp {number}: {problem}" for problem in missed(report, scaler, faults)]
        reported.append(asdict(report) | {"series": None, "steps": scaler.steps, "signals": scaler.signals})
        if options.write:
            write(number, report, scaler)
    if options.json:
        options.json.write_text(json.dumps(reported, indent=1))
    for problem in problems:
        print(f"MISSED {problem}")
    return int(bool(problems))


if __name__ == "__main__":
    sys.exit(main())
