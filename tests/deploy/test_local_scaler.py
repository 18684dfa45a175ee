"""The local scaler decides as a HorizontalPodAutoscaler does, by the rules of the shipped objects."""

import struct
from dataclasses import replace

import pytest
import yaml

from deploy.load.scaling.autoscaling import PROGRAMS, Book, Policy, Rules, decide, shipped_rules
from deploy.load.scaling.name_server import answer

RULES = Rules(
    2, 20, 10.0, "planning", up=(Policy(15.0, percent=100),), up_window_s=0.0, down=(Policy(15.0, percent=100),), down_window_s=300.0
)


def follow(rules: Rules, totals: list[float], *, replicas: int = 2, every_s: float = 15.0) -> list[int]:
    book, numbers = Book(), []
    for turn, total in enumerate(totals):
        replicas, book = decide(rules, book, now_s=turn * every_s, replicas=replicas, total=total)
        numbers.append(replicas)
    return numbers


def test_rules_are_those_of_the_shipped_objects() -> None:
    web, workers = shipped_rules("web"), shipped_rules("worker-planning")
    assert (web.least, web.most, web.target, web.queue) == (2, 20, pytest.approx(0.35), "")  # 70 % of the 500m that it requests
    assert (workers.least, workers.most, workers.target, workers.queue) == (2, 40, 2.0, "planning")
    for rules in (web, workers):
        assert (rules.up, rules.up_window_s, rules.down_window_s) == ((Policy(15.0, percent=100),), 0.0, 300.0)


@pytest.mark.parametrize("program", ["worker-data", "worker-flight", "worker-planning", "worker-simulation"])
def test_keda_has_the_same_rules_as_the_metrics_adapter(program: str) -> None:
    text = (PROGRAMS.parents[1] / "components" / "keda" / "scaled-objects.yaml").read_text()
    spec = next(one["spec"] for one in yaml.safe_load_all(text) if one and one["metadata"]["name"] == program)
    (trigger,) = spec["triggers"]
    rules = shipped_rules(program)
    assert (spec["minReplicaCount"], spec["maxReplicaCount"], spec["cooldownPeriod"]) == (rules.least, rules.most, rules.down_window_s)
    assert (trigger["metadata"]["listName"], float(trigger["metadata"]["listLength"])) == (rules.queue, rules.target)


def test_replicas_double_at_most_in_each_period_and_stop_at_the_most() -> None:
    assert follow(RULES, [1_000.0] * 6) == [4, 8, 16, 20, 20, 20]


def test_within_the_tolerance_nothing_changes() -> None:
    assert follow(RULES, [21.9, 18.1]) == [2, 2]
    assert follow(RULES, [22.1]) == [3]


def test_on_the_way_down_the_most_of_five_minutes_counts() -> None:
    totals = [80.0, 80.0] + [10.0] * 25
    numbers = follow(RULES, totals)
    assert numbers[:2] == [4, 8]
    last_high = 1 * 15.0  # when 8 were wanted last
    assert all(number == 8 for turn, number in enumerate(numbers) if 15.0 <= turn * 15.0 <= last_high + 300.0)
    assert all(number == 2 for turn, number in enumerate(numbers) if turn * 15.0 > last_high + 300.0)


def test_a_short_dip_takes_nothing_away() -> None:
    numbers = follow(RULES, [40.0, 40.0, 5.0, 5.0, 40.0])
    assert numbers == [4, 4, 4, 4, 4]


def test_on_the_way_up_the_least_of_the_window_counts() -> None:
    careful = replace(RULES, up_window_s=30.0)
    assert follow(careful, [20.0, 60.0, 60.0, 60.0, 60.0]) == [2, 2, 2, 4, 6]


def test_a_slow_way_down_takes_away_so_many_a_period() -> None:
    slow = replace(RULES, down_window_s=0.0, down=(Policy(60.0, pods=1),))
    assert follow(slow, [5.0] * 9, replicas=5) == [4, 4, 4, 4, 3, 3, 3, 3, 2]


def test_faster_rules_decide_the_same_in_less_time() -> None:
    totals = [80.0, 80.0] + [10.0] * 25
    assert follow(RULES.faster(0.2), totals, every_s=3.0) == follow(RULES, totals)


def question(name: str, kind: int = 1) -> bytes:
    labels = b"".join(bytes([len(label)]) + label.encode() for label in name.split("."))
    return struct.pack(">HHHHHH", 77, 0x0100, 1, 0, 0, 0) + labels + b"\0" + struct.pack(">HH", kind, 1)


def test_the_name_server_names_every_replica() -> None:
    known = {"web.load.test": ("127.77.0.1", "127.77.0.2"), "live.load.test": ()}
    reported = answer(question("web.load.test"), known)
    assert struct.unpack_from(">HHHH", reported) == (77, 0x8580, 1, 2)
    assert reported.endswith(bytes([127, 77, 0, 2])) and bytes([127, 77, 0, 1]) in reported
    assert struct.unpack_from(">HHHH", answer(question("web.load.test", kind=28), known)) == (77, 0x8580, 1, 0)  # no IPv6 address
    assert struct.unpack_from(">HHHH", answer(question("live.load.test"), known)) == (77, 0x8580, 1, 0)
    assert struct.unpack_from(">HHHH", answer(question("no.load.test"), known)) == (77, 0x8583, 1, 0)


@pytest.mark.parametrize("datagram", [b"", b"\0" * 11, question("web.load.test")[:-3], answer(question("a.b"), {})])
def test_what_is_no_question_is_not_answered(datagram: bytes) -> None:
    with pytest.raises(ValueError):
        answer(datagram, {})
