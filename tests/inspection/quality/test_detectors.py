"""Each detector on a ground of a few strokes, and what it cuts off by hand."""

import numpy as np
import pytest

from inspection.network.build.edges import component_labels
from inspection.quality.infrastructure import FoundIssue, IssueSearchData
from inspection.quality.network import SupportNetwork
from inspection.quality.repair import search
from inspection.quality.supports import course_of_row
from inspection.serializers.data_issues import sentence, title
from tests.inspection.quality.drawn import at, ground, row


def found(kind: str, drawn: IssueSearchData) -> list[FoundIssue]:
    issues = search(drawn)
    assert len({issue.key for issue in issues}) == len(issues)
    for issue in issues:
        assert title(issue.kind, issue.details)
        assert sentence(issue.kind, issue.details).endswith(".")
    return [issue for issue in issues if issue.kind == kind]


HIGH = (110_000,)


def test_a_span_three_times_the_usual_one_and_over_the_bound_is_long() -> None:
    """o-300-o-300-o ... o----2,400----o-300-o"""
    path = [*row(0, 3_000, 300), *row(5_400, 6_000, 300)]
    (issue,) = found("long_span", ground(path, towers=path, voltages_v=[HIGH]))
    assert issue.details["span_m"] == pytest.approx(2_400, rel=1e-3)
    assert issue.details["usual_span_m"] == pytest.approx(300, rel=1e-3)
    assert issue.details["missing_towers"] == 7
    assert issue.cut_off_m == pytest.approx(2_400 + 600, rel=1e-3)  # the span, and the two legs on its smaller side
    assert not issue.details["is_impossible"]


def test_a_river_crossing_below_the_bound_is_no_issue() -> None:
    path = [*row(0, 3_000, 300), (3_950.0, 0.0)]
    assert found("long_span", ground(path, towers=path, voltages_v=[HIGH])) == []


def test_a_line_of_long_spans_throughout_is_no_issue() -> None:
    path = row(0, 12_000, 1_100)
    assert found("long_span", ground(path, towers=path, voltages_v=[HIGH])) == []


def test_a_line_with_few_spans_is_judged_by_those_of_its_voltage() -> None:
    other = row(0, 6_000, 300, north_m=20_000)
    lone = [(0.0, 0.0), (3_000.0, 0.0)]
    (issue,) = found("long_span", ground(other, lone, towers=[*other, *lone], voltages_v=[HIGH, HIGH]))
    assert (issue.asset, issue.details["missing_towers"]) == (2, 9)


def test_a_pole_line_has_a_lower_bound() -> None:
    path = [*row(0, 1_000, 50), (1_500.0, 0.0)]
    (issue,) = found("long_span", ground(path, towers=path, voltages_v=[(10_000,)], subtypes=["minor_line"]))
    assert issue.details["span_m"] == pytest.approx(500, rel=1e-3)


def test_beyond_a_span_that_a_loop_goes_round_nothing_is_cut_off() -> None:
    """A ring: the long span is one side of it, another line leads round."""
    side = [*row(0, 3_000, 300), (6_000.0, 0.0)]
    round_it = [(6_000.0, 0.0), (6_000.0, 400.0), *reversed(row(0, 6_000, 300, north_m=500)), (0.0, 0.0)]
    (issue,) = found("long_span", ground(side, round_it, towers=[*side, *round_it], voltages_v=[HIGH, HIGH]))
    assert issue.details["beyond_m"] == 0.0
    assert issue.cut_off_m == pytest.approx(3_000, rel=1e-3)


def test_no_span_in_the_world_is_so_long() -> None:
    path = [*row(0, 3_000, 300), (14_400.0, 0.0)]
    (issue,) = found("long_span", ground(path, towers=path, voltages_v=[HIGH]))
    assert issue.details["is_impossible"]
    assert sentence(issue.kind, issue.details) == (
        "Span of 11.4\N{NO-BREAK SPACE}km; the usual one here is 0.30\N{NO-BREAK SPACE}km. About 37 towers are missing. "
        "No span in the world is so long."
    )


def test_vertices_without_a_tower_are_one_issue_for_their_line() -> None:
    path = row(0, 2_000, 200)
    towers = [place for place in path if place[0] not in (400.0, 1_000.0, 1_200.0)]
    (issue,) = found("missing_support", ground(path, towers=towers))
    assert (issue.details["missing_towers"], issue.details["vertices"]) == (3, 11)
    assert issue.details["without_tower_m"] == pytest.approx(1_000, rel=1e-3)
    assert len(issue.geometry.geoms) == 3
    assert issue.cut_off_m == 0.0


def test_a_bare_end_beside_a_cable_is_excused_and_one_beside_nothing_is_not() -> None:
    path = row(0, 2_000, 200)
    inner = path[1:-1]
    (issue,) = found("missing_support", ground(path, towers=inner, off_network=[(2_040.0, 0.0)]))
    assert issue.details["missing_towers"] == 1
    assert issue.position[0] == pytest.approx(10.0, abs=1e-9)


def test_a_line_without_any_tower_counts_whole() -> None:
    (issue,) = found("line_without_towers", ground(row(0, 2_000, 200)))
    assert issue.cut_off_m == pytest.approx(2_000, rel=1e-3)
    assert found("missing_support", ground(row(0, 2_000, 200))) == []


def test_a_short_line_between_portals_needs_no_tower() -> None:
    assert found("line_without_towers", ground([(0.0, 0.0), (60.0, 0.0)])) == []


def test_lone_towers_in_a_row_are_one_issue_and_a_single_one_cuts_off_nothing() -> None:
    issues = found("tower_on_no_line", ground(towers=[*row(0, 1_200, 300), (9_000.0, 9_000.0)]))
    assert [issue.details["towers"] for issue in issues] == [5, 1]
    assert [issue.cut_off_m for issue in issues] == [pytest.approx(1_200, rel=1e-3), 0.0]
    assert issues[0].details["assets"] == [101, 102, 103, 104, 105]


def test_towers_that_branch_are_no_path() -> None:
    """o-o-o-o with a branch of two at the third."""
    path = row(0, 1_200, 300)
    assert found("tower_on_no_line", ground(towers=path))[0].details["is_path"]
    assert not found("tower_on_no_line", ground(towers=[*path, (600.0, 300.0), (600.0, 600.0)]))[0].details["is_path"]


def test_a_row_is_put_in_order_wherever_its_towers_come_in_the_list() -> None:
    order = course_of_row(at((600.0, 0.0), (0.0, 0.0), (900.0, 40.0), (300.0, 0.0)))
    assert order is not None
    assert order.tolist() in ([1, 3, 0, 2], [2, 0, 3, 1])
    assert course_of_row(at((0.0, 0.0), (300.0, 0.0), (5_000.0, 0.0))) is None


def test_a_lone_tower_knows_the_line_beside_it() -> None:
    path = row(0, 2_000, 200)
    (issue,) = found("tower_on_no_line", ground(path, towers=[*path, (500.0, 35.0)]))
    assert issue.other_asset == 1
    assert issue.details["nearest_line_m"] == pytest.approx(35, rel=0.01)


def test_ends_a_few_metres_apart_should_join_and_cut_off_the_smaller_part() -> None:
    """o----2,000----o 3 m o--600--o"""
    long, short = row(0, 2_000, 200), row(2_003, 2_603, 200)
    (issue,) = found("ends_apart", ground(long, short, towers=[*long, *short]))
    assert issue.details["apart_m"] == pytest.approx(3, rel=0.01)
    assert issue.details["is_at_end"]
    assert issue.cut_off_m == pytest.approx(600, rel=1e-3)
    assert {issue.asset, issue.other_asset} == {1, 2}


def test_an_end_beside_the_middle_of_a_span_should_join() -> None:
    through, branch = row(0, 2_000, 200), [(1_100.0, 4.0), (1_100.0, 300.0)]
    (issue,) = found("ends_apart", ground(through, branch, towers=[*through, *branch]))
    assert (issue.asset, issue.other_asset, issue.details["is_at_end"]) == (2, 1, False)


def test_joined_lines_have_no_issue_between_them() -> None:
    one, two = row(0, 2_000, 200), [(2_000.0, 0.0), (2_000.0, 300.0)]
    assert found("ends_apart", ground(one, two, towers=[*one, *two])) == []


def test_two_gantries_ten_metres_apart_are_a_substation() -> None:
    one, two = row(0, 2_000, 200), row(2_010, 2_610, 200)
    drawn = ground(one, two, towers=[*one, *two])
    assert found("ends_apart", drawn) == []
    assert len(found("dead_end", drawn)) == 2  # the outer ends alone


@pytest.mark.parametrize("meant", ["terminal", "cable", "other line"])
def test_an_end_that_is_meant_is_no_dead_end(meant: str) -> None:
    path = row(0, 2_000, 200)
    others = [[(2_100.0, -50.0), (2_100.0, 50.0)]] if meant == "other line" else []
    off = [(2_080.0, 20.0)] if meant == "cable" else []
    drawn = ground(path, *others, towers=path, terminals=[10] if meant == "terminal" else [], off_network=off)
    ends = [issue.position for issue in found("dead_end", drawn) if issue.asset == 1]
    assert ends == [(pytest.approx(10.0), pytest.approx(56.0))]


def test_a_dead_end_cuts_off_the_smaller_part_within_reach() -> None:
    """o----2,000----o   800   o--600--o: the ends that face each other could join, the outer ones reach nothing else."""
    one, two = row(0, 2_000, 200), row(2_800, 3_400, 200)
    issues = found("dead_end", ground(one, two, towers=[*one, *two]))
    facing = [issue for issue in issues if issue.details["nearest_m"] == pytest.approx(800, rel=1e-3)]
    assert len(facing) == 2
    assert all(issue.cut_off_m == pytest.approx(600, rel=1e-3) for issue in facing)


def test_a_dead_end_does_not_lead_on_to_a_line_of_another_voltage() -> None:
    one, two = row(0, 2_000, 200), row(2_800, 3_400, 200)
    issues = found("dead_end", ground(one, two, towers=[*one, *two], voltages_v=[(400_000,), (132_000,)]))
    assert [issue.details["nearest_m"] for issue in issues] == [None] * 4
    issues = found("dead_end", ground(one, two, towers=[*one, *two], voltages_v=[(400_000,), ()]))
    assert sum(issue.details["nearest_m"] is not None for issue in issues) == 3  # all but the one that is 2,800 m away


def test_an_end_in_reach_of_its_own_network_alone_cuts_off_nothing() -> None:
    path = row(0, 2_000, 200)
    issues = found("dead_end", ground(path, towers=path))
    assert [(issue.cut_off_m, issue.details["nearest_m"]) for issue in issues] == [(0.0, None), (0.0, None)]


def test_a_bridge_that_carries_nothing_is_an_issue() -> None:
    (issue,) = found("bridge_without_way", ground(bridges=[(0.0, 0.0)]))
    assert (issue.asset, issue.key) == (201, "bridge_without_way a201")


@pytest.mark.parametrize(
    ("volts", "subtype", "fault", "offered"),
    [
        ((110,), "line", "too_low", [110_000]),
        ((380, 110_000), "line", "too_low", [380_000, 110_000]),
        ((1_320_000,), "line", "too_high", [132_000]),
        ((1_999_999,), "line", "too_high", []),
        ((111_111,), "line", "unusual", []),
        (tuple(range(60_000, 67_000, 1_000)), "line", "too_many", []),
    ],
)
def test_a_voltage_that_cannot_be(volts: tuple[int, ...], subtype: str, fault: str, offered: list[int]) -> None:
    (issue,) = found("impossible_voltage", ground(row(0, 600, 200), towers=row(0, 600, 200), voltages_v=[volts], subtypes=[subtype]))
    assert (issue.details["fault"], issue.details["offered_v"], issue.details["is_advisory"]) == (fault, offered, fault == "unusual")


@pytest.mark.parametrize(("volts", "subtype"), [((400,), "minor_line"), ((110_000, 20_000), "line"), ((1_150_000,), "line"), ((), "line")])
def test_a_voltage_in_use_is_no_issue(volts: tuple[int, ...], subtype: str) -> None:
    assert found("impossible_voltage", ground(row(0, 600, 200), voltages_v=[volts], subtypes=[subtype])) == []


def test_a_voltage_that_cannot_be_read_is_an_issue_and_an_unknown_one_is_not() -> None:
    lines = [row(0, 600, 200), row(0, 600, 200, north_m=5_000)]
    (issue,) = found("impossible_voltage", ground(*lines, voltage_text=["high", "unknown"]))
    assert (issue.asset, issue.details["fault"]) == (1, "unread")


def test_a_railway_may_have_few_volts() -> None:
    assert found("impossible_voltage", ground(railway_volts=[(750,), (15_000,)])) == []


def test_an_empty_ground_has_no_issues() -> None:
    assert search(ground()) == []


def test_the_list_is_sorted_by_what_each_issue_cuts_off() -> None:
    path = [*row(0, 3_000, 300), *row(5_400, 6_000, 300)]
    drawn = ground(path, row(0, 2_000, 200, north_m=4_000), towers=path, voltages_v=[HIGH, HIGH], bridges=[(0.0, 0.0)])
    cut_off = [issue.cut_off_m for issue in search(drawn)]
    assert cut_off == sorted(cut_off, reverse=True)
    assert cut_off[0] > 0


def test_equal_grounds_have_equal_issues() -> None:
    path = [*row(0, 3_000, 300), *row(5_400, 6_000, 300)]
    assert search(ground(path, towers=path[:-1])) == search(ground(path, towers=path[:-1]))


def test_the_smaller_side_of_each_leg_agrees_with_taking_it_away() -> None:
    """A seeded tangle: for every leg the sides are counted again without it."""
    chance = np.random.default_rng(5)
    places = [tuple(place) for place in chance.uniform(0, 20_000, (40, 2)).round(0).tolist()]
    lines = [[places[index], places[chance.integers(0, index)]] for index in range(1, 40)]
    lines += [[places[one], places[other]] for one, other in chance.integers(0, 40, (6, 2)).tolist() if one != other]
    network = SupportNetwork(ground(*lines, towers=places))
    pair, metres, _ = network.pairs
    for index in range(len(pair)):
        rest = np.arange(len(pair)) != index
        _, label = component_labels(network.node_count, pair[rest])
        sides = np.bincount(label[pair[rest][:, 0]], weights=metres[rest], minlength=label.max() + 1)
        one, other = label[pair[index]]
        expected = 0.0 if one == other else min(sides[one], sides[other])
        assert network.smaller_side_m[index] == pytest.approx(expected, abs=1e-6)
