"""The assessment against flights whose errors are known by hand."""

from dataclasses import replace

import numpy as np
import pytest

from planning.task import Task, TaskKind, View
from simulation.assessment.flown import AssessedRoute, FlownFlight, TrackEnding
from simulation.assessment.following import following_of
from simulation.assessment.judging import Assessment, judge
from simulation.assessment.limits import Level
from simulation.assessment.obstacles import nearest_standing
from simulation.assessment.stored import assessment_to_json, track_to_json
from tests.simulation.flown import LIMITS, UP_M, a_route, a_track, around, flown, rows, standing, zones


def codes(assessment: Assessment) -> list[tuple[str, str]]:
    return [(str(finding.level), finding.code) for finding in assessment.findings]


def judged(*routes: AssessedRoute, **more) -> Assessment:
    return judge(routes, around(**more), LIMITS)


def test_a_flight_as_planned_passes_with_its_figures() -> None:
    assessment = judged(flown())
    (route,) = assessment.routes
    assert assessment.level is Level.PASS and not assessment.findings
    assert route.targets[0].target == 4 and route.targets[0].is_reached
    assert route.targets[0].closest_m == pytest.approx(0.0, abs=0.3)
    assert route.targets[0].late_s == pytest.approx(0.0, abs=0.5)
    assert route.energy[0].left_percent == pytest.approx(50.0)
    assert route.flown_s == pytest.approx(270.0)
    assert route.lowest is not None and route.lowest.away_m == pytest.approx(60.0, abs=7.0)  # the foot of the column's edge


@pytest.mark.parametrize(("off_m", "level"), [(2.0, Level.PASS), (6.0, Level.WARNINGS), (14.0, Level.FAIL)])
def test_what_is_flown_beside_the_line_is_measured_across_it(off_m: float, level: Level) -> None:
    route = flown(a_track(rows(off_m=off_m)))
    error = following_of(route).across
    assert error.max_m == pytest.approx(off_m, abs=0.1)
    # a triangle over half of the way: its root mean square is the height by the root of three, of half of the moments
    assert error.rms_m == pytest.approx(off_m / np.sqrt(3.0) * np.sqrt(0.5), rel=0.02)
    assert judged(route).level is level


def test_what_is_flown_too_high_is_measured_in_height() -> None:
    assessment = judged(flown(a_track(rows(high_m=5.0))))
    assert assessment.routes[0].following.height.max_m == pytest.approx(5.0, abs=0.1)
    assert codes(assessment) == [("warnings", "height")]


def test_a_battery_below_its_reserve_fails_the_route_and_its_last_target() -> None:
    assessment = judged(flown(a_track(rows(left_percent=6.0))))
    (finding,) = assessment.findings
    assert (finding.code, finding.target, finding.facts["percent"], finding.facts["limit_percent"]) == ("reserve", 4, 6.0, 20.0)
    assert assessment.routes[0].targets[0].level is Level.FAIL


def test_a_target_that_is_passed_too_far_off_is_missed() -> None:
    far = [(t_s, east_m + 25.0, north_m, up_m, percent) for t_s, east_m, north_m, up_m, percent in rows()]
    assessment = judged(flown(a_track(far)))
    assert ("fail", "missed") in codes(assessment)
    assert not assessment.routes[0].targets[0].is_reached
    assert assessment.routes[0].targets[0].closest_m == pytest.approx(25.0, abs=0.2)


def test_a_target_that_was_not_stayed_at_fails() -> None:
    assert ("fail", "not-held") in codes(judged(flown(hold_s=30.0)))


def test_whoever_comes_later_than_uavs_are_kept_apart_in_time_is_warned_of() -> None:
    assessment = judged(flown(a_track(rows(late_s=75.0), late_s=75.0)))
    assert ("warnings", "late") in codes(assessment)


@pytest.mark.parametrize("ending", [TrackEnding.CRASHED, TrackEnding.UNFINISHED, TrackEnding.REFUSED])
def test_a_flight_that_did_not_end_well_fails(ending: TrackEnding) -> None:
    assert ("fail", str(ending)) in codes(judged(flown(a_track(rows(), ending=ending))))


def test_a_flight_that_never_began_fails_with_its_targets() -> None:
    route = AssessedRoute(0, "Tern", a_route(), (FlownFlight(a_route().flights[0], None),), 20.0)
    assert set(codes(judged(route))) == {("fail", "not-begun"), ("fail", "not-flown-to")}


def test_a_zone_that_is_flown_into_fails() -> None:
    assessment = judged(flown(), zones=zones((-50.0, 700.0, 50.0, 800.0)))
    assert codes(assessment) == [("fail", "zone-entered")]


@pytest.mark.parametrize(("lower_m", "expected"), [(75.0, []), (65.0, [("warnings", "zone-near")]), (55.0, [("fail", "zone-entered")])])
def test_a_zone_above_counts_from_the_flown_height(lower_m: float, expected: list[tuple[str, str]]) -> None:
    assessment = judged(flown(), zones=zones((-50.0, 700.0, 50.0, 800.0), lower_m=lower_m))
    assert codes(assessment) == expected


def test_a_zone_beside_is_measured_across_the_ground() -> None:
    assessment = judged(flown(), zones=zones((6.0, 700.0, 50.0, 800.0), (40.0, 200.0, 90.0, 300.0)))
    assert [round(zone.beside_m) for zone in assessment.routes[0].zones] == [6, 40]
    assert codes(assessment) == [("warnings", "zone-near")]


def test_a_zone_counts_only_while_it_is_in_force() -> None:
    """In force on the first of May from 10 to 11 in the morning; the UAV is there 70 to 80 s after its departure."""
    period = {"startDateTime": "2027-05-01T10:00:00Z", "endDateTime": "2027-05-01T11:00:00Z", "schedule": []}
    table = zones((-50.0, 700.0, 50.0, 800.0), schedule=[period])
    at_ten = 1_809_165_600.0
    assert not judged(flown(), zones=table, departs_s=at_ten - 3_600.0).findings
    assert judged(flown(), zones=table, departs_s=at_ten - 60.0).level is Level.FAIL
    assert not judged(flown(), zones=table, departs_s=at_ten + 3_600.0).findings


@pytest.mark.parametrize(("top_m", "expected"), [(40.0, []), (53.0, [("warnings", "obstacle")]), (57.0, [("fail", "obstacle")])])
def test_a_wire_that_is_crossed_is_measured_from_above(top_m: float, expected: list[tuple[str, str]]) -> None:
    assessment = judged(flown(), standing=standing(((-100.0, 500.0), (100.0, 520.0), top_m)))
    assert codes(assessment) == expected
    assert assessment.routes[0].obstacle is not None
    assert assessment.routes[0].obstacle.away_m == pytest.approx(60.0 - top_m, abs=0.1)


def test_a_tower_that_is_taller_than_the_flight_is_measured_across() -> None:
    assessment = judged(flown(), standing=standing(((30.0, 500.0), (30.0, 500.0), 90.0)))
    assert assessment.routes[0].obstacle is not None
    assert assessment.routes[0].obstacle.away_m == pytest.approx(30.0, abs=0.1)
    assert not assessment.findings


def test_a_wire_beside_and_below_is_as_far_as_in_space() -> None:
    """Along the second kilometre 6 m beside and 8 m below the flight: 10 m; as high as the flight it is 6 m."""
    below, level = (standing(((6.0, 1_200.0), (6.0, 1_800.0), top_m)) for top_m in (UP_M - 8.0, UP_M + 8.0))
    for wires, away_m in ((below, 10.0), (level, 6.0)):
        on_way = nearest_standing(flown().flights[0], wires, column_m=15.0).way
        assert on_way is not None and on_way.away_m == pytest.approx(away_m, abs=0.05)


def photographing() -> AssessedRoute:
    """The second kilometre is flown through photos of the target, of which the last waypoint is one."""
    route = flown()
    *others, last = route.route.waypoints
    taken = replace(last, target=4, task=Task(TaskKind.PHOTO, 0.0, view=View(0.0, 0.0, 20.0, 21.0, 8.9)))
    planned = replace(route.route, waypoints=(*others, taken))
    return replace(route, route=planned, flights=(FlownFlight(planned.flights[0], route.flights[0].track),))


@pytest.mark.parametrize(("beside_m", "expected"), [(9.5, []), (8.0, [("fail", "obstacle")])])
def test_a_flight_through_photos_keeps_its_own_clearance(beside_m: float, expected: list[tuple[str, str]]) -> None:
    wires = standing(((beside_m, 1_200.0), (beside_m, 1_800.0), UP_M + 8.0))
    assessment = judged(photographing(), standing=wires)
    assert codes(assessment) == expected
    if expected:
        assert assessment.findings[0].facts["limit_m"] == 8.9
    assert codes(judged(flown(), standing=wires)) == [("warnings", "obstacle")], "any other flight is warned of at 10 m"


def test_wires_beside_the_rest_of_the_way_count_as_ever() -> None:
    wires = standing(((4.0, 400.0), (4.0, 600.0), UP_M + 8.0))
    assert codes(judged(photographing(), standing=wires)) == [("fail", "obstacle")]


@pytest.mark.parametrize(("ground_m", "expected"), [(156.0, []), (157.5, [("warnings", "low")]), (159.0, [("fail", "low")])])
def test_photos_may_be_low_over_the_ground_but_not_any_height(ground_m: float, expected: list[tuple[str, str]]) -> None:
    hill = lambda positions: np.where(positions[:, 1] > 56.0105, ground_m, 100.0)  # noqa: E731
    landing = [finding for finding in codes(judged(photographing(), ground_amsl_m=hill)) if finding[1] == "low"]
    assert landing == expected


def test_what_stands_beside_the_take_off_is_worth_a_warning_alone() -> None:
    assert codes(judged(flown(), standing=standing(((3.0, 0.0), (3.0, 0.0), 30.0)))) == [("warnings", "obstacle-column")]


@pytest.mark.parametrize(("ground_m", "level"), [(140.0, Level.PASS), (152.0, Level.WARNINGS), (157.0, Level.FAIL)])
def test_a_hill_under_the_way_is_measured_from_the_flight(ground_m: float, level: Level) -> None:
    assessment = judged(flown(), ground_amsl_m=lambda positions: np.where(positions[:, 1] > 56.004, ground_m, 100.0))
    assert assessment.level is level
    assert assessment.routes[0].lowest is not None and assessment.routes[0].lowest.away_m == pytest.approx(160.0 - ground_m, abs=0.1)


@pytest.mark.parametrize(("east_m", "expected"), [(40.0, Level.PASS), (20.0, Level.WARNINGS), (6.0, Level.FAIL)])
def test_two_uavs_at_the_same_time_are_measured_from_each_other(east_m: float, expected: Level) -> None:
    other = flown(uav=1, name="Gull", east_m=east_m)
    assessment = judged(flown(), other)
    assert assessment.level is expected
    assert assessment.closest_approaches[0].away_m == pytest.approx(east_m, abs=0.1)
    assert {finding.uav for finding in assessment.findings} == ({0, 1} if expected is not Level.PASS else set())


def test_two_uavs_at_one_place_one_after_the_other_do_not_meet() -> None:
    later = [(t_s + 600.0, *rest) for t_s, *rest in rows()]
    other = flown(a_track(later), uav=1, name="Gull")
    assert not judged(flown(), other).closest_approaches


def test_a_verdict_and_a_track_are_plain_values_to_the_digits_that_are_shown() -> None:
    stored = assessment_to_json(judged(flown(a_track(rows(left_percent=6.0)))))
    assert stored["findings"][0]["facts"]["percent"] == 6.0
    assert stored["routes"][0]["energy"] == [{"flight": 1, "used_wh": 47.0, "left_percent": 6.0, "lowest_percent": 6.0}]
    (track,) = track_to_json([a_track(rows())])
    assert len(track["t_s"]) == len(track["position"]) == 271
    assert track["t_s"][0] == 0.0 and track["t_s"][-1] == 270.0
    assert [track[name][-1] for name in ("roll_deg", "pitch_deg", "heading_deg")] == [0.0, -4.0, 0.0]
