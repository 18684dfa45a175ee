"""How many replicas a HorizontalPodAutoscaler wants: Kubernetes' documented algorithm, with the rules of the shipped objects.

Source: Kubernetes documentation, "Horizontal Pod Autoscaling": algorithm details, and configurable scaling behaviour.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import yaml

TOLERANCE = 0.1  # of the controller, where nothing else is said: so near to the target nothing is changed
POLL_INTERVAL_S = 15.0  # of the controller, where nothing else is said
PROGRAMS = Path(__file__).resolve().parents[2] / "kubernetes" / "base" / "programs"
SHARES = {"m": 1e-3, "": 1.0}


@dataclass(frozen=True)
class Policy:
    """At most `pods`, or `percent` of what there was at its beginning, in a period."""

    period_s: float
    pods: int | None = None
    percent: int | None = None


@dataclass(frozen=True)
class Rules:
    """Of one program. `target` is what a replica should have: cores in use, or messages that wait in its queue."""

    least: int
    most: int
    target: float
    queue: str  # empty: processor time counts
    up: tuple[Policy, ...]
    up_window_s: float
    down: tuple[Policy, ...]
    down_window_s: float
    poll_interval_s: float = POLL_INTERVAL_S

    def faster(self, seconds: float) -> "Rules":
        """The same with all times as a share."""

        def shorter(policies: Iterable[Policy]) -> tuple[Policy, ...]:
            return tuple(replace(policy, period_s=policy.period_s * seconds) for policy in policies)

        return replace(
            self,
            up=shorter(self.up),
            down=shorter(self.down),
            up_window_s=self.up_window_s * seconds,
            down_window_s=self.down_window_s * seconds,
            poll_interval_s=self.poll_interval_s * seconds,
        )


@dataclass(frozen=True)
class Book:
    """What was wanted and what was done, each with its time; as long as a rule asks for it."""

    wanted: tuple[tuple[float, int], ...] = ()
    changes: tuple[tuple[float, int], ...] = field(default=())


def shipped_rules(program: str) -> Rules:
    """Of the program's Deployment and HorizontalPodAutoscaler in deploy/kubernetes. Raises StopIteration where it has none."""
    documents = [document for document in yaml.safe_load_all((PROGRAMS / f"{program}.yaml").read_text()) if document]
    deployment = next(one for one in documents if one["kind"] == "Deployment")
    spec = next(one for one in documents if one["kind"] == "HorizontalPodAutoscaler")["spec"]
    (metric,) = spec["metrics"]
    if metric["type"] == "Resource":
        requested = _cores(deployment["spec"]["template"]["spec"]["containers"][0]["resources"]["requests"]["cpu"])
        target, queue = requested * metric["resource"]["target"]["averageUtilization"] / 100, ""
    else:
        external = metric["external"]
        target, queue = float(external["target"]["averageValue"]), external["metric"]["selector"]["matchLabels"]["queue"]
    up, down = (spec["behavior"].get(name, {}) for name in ("scaleUp", "scaleDown"))
    return Rules(
        least=spec["minReplicas"],
        most=spec["maxReplicas"],
        target=target,
        queue=queue,
        up=_policies(up) or (Policy(15.0, pods=4), Policy(15.0, percent=100)),
        up_window_s=float(up.get("stabilizationWindowSeconds", 0)),
        down=_policies(down) or (Policy(15.0, percent=100),),
        down_window_s=float(down.get("stabilizationWindowSeconds", 300)),
    )


def decide(rules: Rules, book: Book, *, now_s: float, replicas: int, total: float) -> tuple[int, Book]:
    """How many replicas there should be now, where `replicas` together have `total` of what the target is in; and the book after it.

    Wanted is ceil(total / target), unless it is within the tolerance; upwards the least that was wanted in the window counts, downwards
    the most; no step is larger than the most generous policy allows.
    """
    ratio = total / (rules.target * replicas) if replicas else math.inf
    wanted = replicas if abs(ratio - 1.0) <= TOLERANCE else math.ceil(total / rules.target - 1e-9)
    kept_s = max(rules.up_window_s, rules.down_window_s)
    seen = (*(entry for entry in book.wanted if now_s - entry[0] <= kept_s), (now_s, wanted))
    least_of_late = min(number for at_s, number in seen if now_s - at_s <= rules.up_window_s)
    most_of_late = max(number for at_s, number in seen if now_s - at_s <= rules.down_window_s)
    stable = replicas
    if replicas < least_of_late:
        stable = least_of_late
    if replicas > most_of_late:
        stable = most_of_late
    longest_s = max(policy.period_s for policy in (*rules.up, *rules.down))
    changes = tuple(entry for entry in book.changes if now_s - entry[0] < longest_s)
    if stable > replicas:
        stable = min(stable, max(_limit(policy, changes, now_s, replicas, 1) for policy in rules.up))
    elif stable < replicas:
        stable = max(stable, min(_limit(policy, changes, now_s, replicas, -1) for policy in rules.down))
    stable = min(max(stable, rules.least), rules.most)
    if stable != replicas:
        changes = (*changes, (now_s, stable - replicas))
    return stable, Book(seen, changes)


def _limit(policy: Policy, changes: Iterable[tuple[float, int]], now_s: float, replicas: int, direction: int) -> int:
    """As far as the policy lets the number go: what was done in its period already counts."""
    done = sum(change for at_s, change in changes if now_s - at_s < policy.period_s and change * direction > 0)
    before = replicas - done
    if policy.pods is not None:
        return before + direction * policy.pods
    share = 1 + direction * (policy.percent or 0) / 100
    return math.ceil(before * share) if direction > 0 else math.floor(before * share)


def _policies(behaviour: dict[str, Any]) -> tuple[Policy, ...]:
    kinds = {"Pods": "pods", "Percent": "percent"}
    return tuple(Policy(float(one["periodSeconds"]), **{kinds[one["type"]]: one["value"]}) for one in behaviour.get("policies", []))


def _cores(quantity: str | int) -> float:
    text = str(quantity)
    unit = "m" if text.endswith("m") else ""
    return float(text.removesuffix("m")) * SHARES[unit]
