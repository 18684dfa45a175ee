"""What came back in a run, second by second, and what it says: rates, medians, demand that was served, faults."""

import json
import time
from array import array
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from deploy.load.scenarios import Scenario

SETTLES_S = 2.0  # after a ramp, before a stage's hold is looked at
PLAN = "plan"


@dataclass
class Recorder:
    """Notes every answer while Locust runs, at little cost."""

    scenario: Scenario
    began_s: float = 0.0
    at_s: "array[float]" = field(default_factory=lambda: array("d"))
    took_ms: "array[float]" = field(default_factory=lambda: array("d"))
    is_plan: "array[int]" = field(default_factory=lambda: array("b"))
    is_fault: "array[int]" = field(default_factory=lambda: array("b"))
    faults: Counter[str] = field(default_factory=Counter)
    users: list[tuple[float, int]] = field(default_factory=list)

    def begin(self, at_s: float) -> None:
        self.began_s = at_s

    def note_users(self, users: int) -> None:
        """Before the run has begun there are none: Locust asks the shape once before it says so."""
        if not self.began_s:
            return
        self.users.append((time.time() - self.began_s, users))

    def note_answer(self, name: str, took_ms: float, fault: Exception | None) -> None:
        self.at_s.append(time.time() - self.began_s)
        self.took_ms.append(took_ms)
        self.is_plan.append(name == PLAN)
        self.is_fault.append(fault is not None)
        if fault is not None:
            self.faults[f"{name}: {str(fault)[:120]}"] += 1

    def write(self, path: Path) -> None:
        """As an npz, which `Run.read` reads."""
        users = np.array(self.users or [(0.0, 0)], dtype=np.float64)
        stored = {
            "began_s": self.began_s,
            "at_s": np.array(self.at_s),
            "took_ms": np.array(self.took_ms),
            "is_plan": np.array(self.is_plan, dtype=bool),
            "is_fault": np.array(self.is_fault, dtype=bool),
            "users_at_s": users[:, 0],
            "users": users[:, 1],
            "faults": json.dumps(self.faults),
        }
        np.savez_compressed(path, **stored)  # type: ignore[arg-type]


@dataclass(frozen=True)
class StageFigures:
    """One stage of a run. The hold is the stage once all its users are there.

    Demand is users / (mean wait + mean answer of the first hold). Who waits longer for an answer asks less often: by the answers of its
    own hold, a stage would always be served all of its demand.
    """

    users: int
    users_there: int  # at its end, as Locust has counted them
    hold_s: float
    plans_per_s: float
    demand_per_s: float
    median_ms: float  # of the hold
    p95_ms: float
    ramp_median_ms: float  # while users came or went; NaN where there was no answer
    failures: int  # of the whole stage

    @property
    def served_percent(self) -> float:
        return 100.0 * self.plans_per_s / self.demand_per_s if self.demand_per_s else 100.0


@dataclass(frozen=True)
class Run:
    """Answers of one run, in the order in which they came. at_s [s] since the beginning, took_ms [ms], both shape (n,)."""

    began_s: float
    at_s: NDArray[np.float64]
    took_ms: NDArray[np.float64]
    is_plan: NDArray[np.bool_]
    is_fault: NDArray[np.bool_]
    users_at_s: NDArray[np.float64]
    users: NDArray[np.float64]
    faults: dict[str, int]

    @classmethod
    def read(cls, path: Path) -> "Run":
        with np.load(path, allow_pickle=False) as stored:
            names = ("at_s", "took_ms", "is_plan", "is_fault", "users_at_s", "users")
            return cls(float(stored["began_s"]), *(stored[name] for name in names), json.loads(str(stored["faults"])))

    @property
    def failures(self) -> int:
        return int(self.is_fault.sum())

    def stage(self, scenario: Scenario, index: int) -> StageFigures:
        stage, begins_s = scenario.stages[index], scenario.begins_s()[index]
        hold_begins_s, ends_s = _hold(scenario, index)
        in_ramp = self._is_good & (self.at_s >= begins_s) & (self.at_s < hold_begins_s)
        in_stage = (self.at_s >= begins_s) & (self.at_s < ends_s)
        hold_s, took_ms = max(0.0, ends_s - hold_begins_s), self._took_in_hold_ms(scenario, index)
        unhurried_ms = self._took_in_hold_ms(scenario, 0)
        wait_s = sum(scenario.wait_s) / 2
        return StageFigures(
            users=stage.users,
            users_there=int(np.interp(ends_s - 1.0, self.users_at_s, self.users)),
            hold_s=hold_s,
            plans_per_s=len(took_ms) / hold_s if hold_s else 0.0,
            demand_per_s=stage.users / (wait_s + (unhurried_ms.mean() / 1_000 if len(unhurried_ms) else 0.0)),
            median_ms=float(np.median(took_ms)) if len(took_ms) else float("nan"),
            p95_ms=float(np.percentile(took_ms, 95)) if len(took_ms) else float("nan"),
            ramp_median_ms=float(np.median(self.took_ms[in_ramp])) if in_ramp.any() else float("nan"),
            failures=int((self.is_fault & in_stage).sum()),
        )

    @property
    def _is_good(self) -> NDArray[np.bool_]:
        return self.is_plan & ~self.is_fault

    def _took_in_hold_ms(self, scenario: Scenario, index: int) -> NDArray[np.float64]:
        begins_s, ends_s = _hold(scenario, index)
        return self.took_ms[self._is_good & (self.at_s >= begins_s) & (self.at_s < ends_s)]

    def by_second(self, lasts_s: float, window_s: float = 5.0) -> dict[str, NDArray[np.float64]]:
        """For pictures: at_s, users, answers a second, median and p95 [ms] of windows, each shape (lasts_s / window_s,)."""
        edges = np.arange(0.0, lasts_s + window_s, window_s)
        plans = self._is_good
        place = np.digitize(self.at_s[plans], edges) - 1
        took_ms = self.took_ms[plans]
        windows = [took_ms[place == number] for number in range(len(edges) - 1)]
        middle = (edges[:-1] + edges[1:]) / 2
        return {
            "at_s": middle,
            "users": np.interp(middle, self.users_at_s, self.users),
            "plans_per_s": np.array([len(window) / window_s for window in windows]),
            "median_ms": np.array([np.median(window) if len(window) else np.nan for window in windows]),
            "p95_ms": np.array([np.percentile(window, 95) if len(window) else np.nan for window in windows]),
        }


def _hold(scenario: Scenario, index: int) -> tuple[float, float]:
    """From when to when [s] all users of a stage are there."""
    begins_s = scenario.begins_s()[index]
    return begins_s + scenario.ramp_s(index) + SETTLES_S, begins_s + scenario.stages[index].lasts_s
