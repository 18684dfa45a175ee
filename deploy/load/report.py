"""What a run of a scenario says, as text, as a section of docs/load-tests.md and as bars that it has to clear."""

from collections.abc import Sequence
from dataclasses import dataclass

from benchmarks.report import machine, table, write_section
from deploy.load.answers import StageFigures
from deploy.load.pictures import Series, scenario_picture
from deploy.load.scenarios import Scenario
from scripts.places import PROJECT_DIR

DOCUMENT = PROJECT_DIR / "docs" / "load-tests.md"
PICTURES = PROJECT_DIR / "docs" / "load-tests"
MIN_SERVED_PERCENT = 97.0  # in the hold of scenario 4's last stage
MAX_MEDIAN_MS = 100.0  # of scenarios 1 to 3: what a person takes for at once
MAX_MISSING = 0.01  # of a stage's users at its end
HEAD = ["users", "answers/s in the hold", "of the demand", "median", "95 %", "median in the ramp", "failures"]


@dataclass(frozen=True)
class RunReport:
    """One scenario with one number of web replicas. Shares are of the article's users and seconds, and of users who sign in."""

    scenario: int
    web_replicas: int
    users_share: float
    seconds_share: float
    sessions: float
    answers: int
    failures: int
    faults: dict[str, int]
    stages: list[StageFigures]
    cores: dict[str, float]  # in the hold with the most users
    resident_mb: dict[str, int]  # at the end
    load_of_machine: float
    series: Series

    @property
    def is_scaled(self) -> bool:
        return (self.users_share, self.seconds_share) != (1.0, 1.0)

    @property
    def title(self) -> str:
        replicas = f"{self.web_replicas} web replica{'s' if self.web_replicas > 1 else ''}"
        scaled = f", scaled to {self.users_share:g} of the users and {self.seconds_share:g} of the time" if self.is_scaled else ""
        return f"{replicas}{scaled}"

    def rows(self) -> list[list[str]]:
        return [
            [
                f"{stage.users:,}",
                f"{stage.plans_per_s:,.1f}",
                f"{stage.served_percent:.1f} %" if stage.users else "–",
                _ms(stage.median_ms),
                _ms(stage.p95_ms),
                _ms(stage.ramp_median_ms),
                f"{stage.failures}",
            ]
            for stage in self.stages
        ]

    def text(self) -> str:
        lines = [f"scenario {self.scenario}, {self.title}: {self.answers:,} answers, {self.failures} failures"]
        lines += ["  ".join(f"{cell:>21}" for cell in row) for row in [HEAD, *self.rows()]]
        lines += [f"  {count:>6} {fault}" for fault, count in self.faults.items()]
        lines.append(f"cores at the peak: {_reported(self.cores)}; load of the machine {self.load_of_machine:.1f}")
        return "\n".join(lines)


def _ms(value: float) -> str:
    return "–" if value != value else f"{value:,.0f} ms"


def _reported(cores: dict[str, float]) -> str:
    return ", ".join(f"{name} {value:.2f}" for name, value in sorted(cores.items(), key=lambda item: -item[1]))


def missed_bars(report: RunReport) -> list[str]:
    """What the run was to show and has not; empty for a good one."""
    name = f"scenario {report.scenario}, {report.title}"
    missed = [f"{name}: {report.failures} of {report.answers:,} failed"] if report.failures else []
    missed += [
        f"{name}: {stage.users_there} users were there, not {stage.users}"
        for stage in report.stages
        if abs(stage.users_there - stage.users) > 1 + MAX_MISSING * stage.users
    ]
    if report.scenario == 4:
        served = report.stages[-1].served_percent
        missed += [f"{name}: {served:.1f} % of the demand was served"] if served < MIN_SERVED_PERCENT else []
    else:
        slowest = max(
            (value for stage in report.stages for value in (stage.median_ms, stage.ramp_median_ms) if value == value), default=0.0
        )
        missed += [f"{name}: a median of {slowest:.0f} ms"] if slowest > MAX_MEDIAN_MS else []
    return missed


def write_scenario(scenario: Scenario, reports: Sequence[RunReport]) -> None:
    """The section of the scenario in docs/load-tests.md, and its picture."""
    picture = PICTURES / f"scenario-{scenario.number}.svg"
    scenario_picture(picture, [(report.title, report.series) for report in reports], f"Scenario {scenario.number}")
    arguments = f"--scenario {scenario.number}"
    first = reports[0]
    if first.is_scaled:
        arguments += f" --users {first.users_share:g} --seconds {first.seconds_share:g}"
    parts = [
        f"`python deploy/load/run.py {arguments} --write`. {machine('granian', 'django', 'psycopg', 'numba', 'locust')}",
        f"The article: {scenario.article}",
        f"![Requests a second, users and time of answers over the run](load-tests/{picture.name})",
    ]
    for report in reports:
        parts.append(
            f"**{report.title}**, {report.sessions:.0%} of the users signed in: {report.answers:,} answers, {report.failures} failures"
            + "".join(f"; {count} × {fault}" for fault, count in report.faults.items())
            + f". Cores at the peak: {_reported(report.cores)}."
        )
        parts.append(table(HEAD, report.rows()))
    write_section(f"Scenario {scenario.number}", "\n\n".join(parts), DOCUMENT)
