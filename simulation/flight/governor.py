"""How fast the reference may go: slower while the UAV cannot keep up, or has its hands full with the wind."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class GovernorRules:
    """The reference slows from `lag_m` behind it on and waits at `most_lag_m`; likewise beside it.

    `effort` is the share of the horizontal acceleration that is asked for; above `high_effort` the speed falls by up to `fall_per_s` of
    itself a second, below `low_effort` it comes back by `rise_per_s`.
    """

    lag_m: float = 0.8
    most_lag_m: float = 3.0
    beside_m: float = 0.4
    most_beside_m: float = 1.5
    high_effort: float = 0.85
    low_effort: float = 0.7
    fall_per_s: float = 1.5
    rise_per_s: float = 0.15
    effort_time_s: float = 0.4


class Governor:
    def __init__(self, rules: GovernorRules) -> None:
        self._rules = rules
        self._effort = 0.0
        self._share = 1.0

    def step(self, dt_s: float, *, lag_m: float, beside_m: float, effort: float) -> float:
        """The share of its speed that the reference may go, 0 to 1."""
        rules = self._rules
        self._effort += min(dt_s / rules.effort_time_s, 1.0) * (min(effort, 2.0) - self._effort)
        if self._effort > rules.high_effort:
            self._share -= rules.fall_per_s * dt_s * min((self._effort - rules.high_effort) / 0.15, 1.0) * max(self._share, 0.1)
        elif self._effort < rules.low_effort:
            self._share += rules.rise_per_s * dt_s
        self._share = min(max(self._share, 0.05), 1.0)
        behind = _falling(lag_m, rules.lag_m, rules.most_lag_m)
        return self._share * behind * _falling(abs(beside_m), rules.beside_m, rules.most_beside_m)


def _falling(value: float, begins: float, ends: float) -> float:
    """1 up to `begins`, 0 from `ends` on."""
    return min(max((ends - value) / (ends - begins), 0.0), 1.0)
