"""The article's four load tests as numbers: how many users there are at each second, and how long they wait between two requests."""

from collections.abc import Sequence
from dataclasses import dataclass, replace


@dataclass(frozen=True)
class Stage:
    """From the users there are to `users`, so many more (or fewer) a second; then held until `lasts_s` of the stage are over."""

    users: int
    users_per_s: float
    lasts_s: float


@dataclass(frozen=True)
class Scenario:
    """A row of the article's table. `wait_s` is the shortest and the longest wait between an answer and the next request."""

    number: int
    wait_s: tuple[float, float]
    stages: tuple[Stage, ...]
    article: str  # what it reports of this scenario

    @property
    def lasts_s(self) -> float:
        return sum(stage.lasts_s for stage in self.stages)

    @property
    def most_users(self) -> int:
        return max(stage.users for stage in self.stages)

    def begins_s(self) -> list[float]:
        """When each stage begins."""
        return [sum(stage.lasts_s for stage in self.stages[:index]) for index in range(len(self.stages))]

    def ramp_s(self, index: int) -> float:
        """How long the users of a stage take to come or to go."""
        before = self.stages[index - 1].users if index else 0
        return abs(self.stages[index].users - before) / self.stages[index].users_per_s

    def stage_at(self, at_s: float) -> Stage | None:
        """The stage of this second; None when the scenario is over."""
        for stage, begins_s in zip(self.stages, self.begins_s(), strict=True):
            if begins_s <= at_s < begins_s + stage.lasts_s:
                return stage
        return None

    def users_at(self, at_s: float) -> float:
        """How many there should be, before the first second and after the last none."""
        before = 0
        for stage, begins_s in zip(self.stages, self.begins_s(), strict=True):
            if begins_s <= at_s < begins_s + stage.lasts_s:
                changed = stage.users_per_s * (at_s - begins_s)
                return min(stage.users, before + changed) if stage.users >= before else max(stage.users, before - changed)
            before = stage.users
        return 0

    def scaled(self, *, users: float = 1.0, seconds: float = 1.0) -> "Scenario":
        """The same shape with a share of the users, a share of the time, or both. Waits stay as they are."""
        stages = (Stage(round(stage.users * users), stage.users_per_s * users / seconds, stage.lasts_s * seconds) for stage in self.stages)
        return replace(self, stages=tuple(stages))


def _stages(lasts_s: float, ramps: Sequence[tuple[float, int]]) -> tuple[Stage, ...]:
    return tuple(Stage(users, users_per_s, lasts_s) for users_per_s, users in ramps)


_UP_TO_1000 = [(10, 100), (20, 300), (20, 500), (20, 700), (50, 1_000)]
SCENARIOS = {
    1: Scenario(
        1,
        (1.0, 5.0),
        _stages(60.0, [(10, 100), (20, 200), (20, 300), (20, 200), (50, 100)]),
        "1 replica against 20. With one, requests a second did not rise with the users, and waiting grew.",
    ),
    2: Scenario(
        2,
        (1.0, 1.0),
        _stages(60.0, _UP_TO_1000),
        "20 replicas against 40. About 75 requests a second with 20, about 95 with 40.",
    ),
    3: Scenario(
        3,
        (10.0, 10.0),
        _stages(60.0, [*_UP_TO_1000, (50, 700), (20, 500), (20, 300), (20, 100), (10, 0)]),
        "20 replicas against 100, users up to 1,000 and down again. No figure is stated.",
    ),
    4: Scenario(
        4,
        (10.0, 10.0),
        _stages(100.0, [(50, 1_000), (50, 2_000), (50, 3_000), (50, 4_000), (50, 5_000)]),
        "100 and 100 replicas: response times oscillated above 3,000 users and 5 % of requests failed. "
        "80 and 120: about 200 requests a second, and no failures.",
    ),
}

# The local scaler's: the article's ramps up and down with a load that web notices, and large plans, which workers make. Both end with a
# hold that is longer than an autoscaler's wait before it takes replicas away, so that the way down is under load, too.
RAMPS_TO_SCALE_BY = {
    5: Scenario(
        5,
        (1.0, 1.0),
        (
            *_stages(60.0, [*_UP_TO_1000, (50, 700), (20, 500), (20, 300), (20, 100)]),
            Stage(100, 20, 480.0),
        ),
        "The users of scenario 3 with the wait of scenario 2.",
    ),
    6: Scenario(
        6,
        (5.0, 5.0),
        (Stage(4, 1, 60.0), Stage(24, 1, 180.0), Stage(12, 1, 60.0), Stage(4, 1, 600.0)),
        "Not among its scenarios: plans of 16 targets for 3 UAVs, each a worker's for some 10 s.",
    ),
}
