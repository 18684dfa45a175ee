"""A mission is rehearsed by a worker: flown whole, judged, kept; what belongs to another plan says nothing of this one."""

from collections.abc import Iterator
from copy import deepcopy
from dataclasses import replace
from datetime import timedelta
from itertools import pairwise
from unittest import mock

import pytest
from django.utils import timezone

from inspection.geodesy import LonLat
from inspection.selectors.planning import planning_read
from inspection.services import build_graph
from inspection.services.ground import mark_ground_changed
from missions.models import Approval, Mission, MissionState, Uav, UavType
from missions.selectors.missions import mission_of_organisation
from missions.services import TargetRequest, create_mission, plan_mission
from missions.services.approval.approval import approve_mission
from missions.services.commands.refused import Refused
from planning.task import Task, TaskKind
from planning.views.camera import Gimbal, camera_to_json
from simulation.flight.camera import SIMULATED_CAMERA
from simulation.models import Rehearsal, RehearsalRun, RehearsalTrack, SimulatedAirframe
from simulation.rehearsing.flying import RouteToFly
from simulation.serializers.words import reason_of
from simulation.services.plan_to_fly import content_of, plan_to_fly
from simulation.services.rehearsals import cancel_rehearsal, reasons_without_rehearsal, set_rule
from simulation.tasks import rehearse_mission
from tests.accounts.users import client_of
from tests.cases import RowsForAModule
from tests.inspection.ground import tower
from tests.missions import worlds
from tests.missions.api import post
from tests.missions.flights import an_operator, fleet, ground, planned
from tests.missions.worlds import World, zone_around
from tests.simulation.rehearsals.rehearsed import asked, loaded, rehearsed
from workspace.models import AuditEntry, JobState, User

pytestmark = pytest.mark.django_db


@pytest.fixture
def person() -> User:
    return an_operator()


@pytest.fixture(scope="module")
def over_ground(world_of_the_module: World, rows_for_a_module: RowsForAModule, tmp_path_factory: pytest.TempPathFactory) -> Iterator[World]:
    with rows_for_a_module(lambda: ground(tmp_path_factory.mktemp("ground") / "ground.tif")):
        yield world_of_the_module


@pytest.fixture
def here(over_ground: World, db: None) -> World:
    return deepcopy(over_ground)


@pytest.fixture
def mission(here: World, person: User) -> Mission:
    return planned(person, fleet(), [here.towers[0]])


def content(mission: Mission) -> str:
    return plan_to_fly(loaded(mission)).content_sha256


def test_a_planned_mission_of_two_uavs_is_flown_and_judged(here: World, person: User) -> None:
    mission = planned(person, fleet("Tern", "Gull"), [here.towers[0], here.towers[3]])
    rehearsal = rehearsed(mission, person, "calm")
    run = rehearsal.runs.get()
    assert (rehearsal.job.state, rehearsal.level, run.level) == (JobState.DONE, "pass", "pass")
    assert [route["endings"] for route in run.assessment["routes"]] == [["landed"], ["landed"]]
    assert all(target["is_reached"] and target["closest_m"] < 2.0 for route in run.assessment["routes"] for target in route["targets"])
    assert run.assessment["meetings"][0]["beside_m"] == pytest.approx(250.0, abs=10.0)
    tracks = RehearsalTrack.objects.filter(run=run)
    assert [track.uav for track in tracks] == [0, 1]
    assert all(track.flights[0]["altitude_relative_m"][-1] == pytest.approx(0.0, abs=0.3) for track in tracks)
    leaning = [max(map(abs, track.flights[0]["pitch_deg"])) for track in tracks]
    assert all(1.0 < most_deg < 60.0 for most_deg in leaning)  # it leans to move, and never falls over
    assert AuditEntry.objects.filter(action="rehearse", subject_id=str(mission.pk), actor=person).count() == 1


def test_a_line_in_parts_is_flown_part_by_part_and_each_counts(here: World, person: User) -> None:
    """Where a part of one span begins at the end of another, two waypoints are at one place."""
    places = [LonLat(*tower.centre.coords) for tower in here.towers]
    parts = [TargetRequest(here.line.pk, stretch=ends) for ends in pairwise([places[0], places[2], *places[3:]])]
    mission = planned(person, fleet("Tern"), parts)
    flown = plan_to_fly(loaded(mission)).routes[0].route.waypoints
    assert sum(one.position == other.position for one, other in pairwise(flown)) >= 1
    run = rehearsed(mission, person, "calm").runs.get()
    targets = run.assessment["routes"][0]["targets"]
    assert run.level == "pass", run.assessment["findings"]
    assert sorted((target["target"], target["is_reached"], target["closest_m"] < 2.0) for target in targets) == [
        (number, True, True) for number in range(4)
    ]


def test_photos_are_kept_with_the_pose_of_the_lens_of_the_types_camera(here: World, person: User) -> None:
    camera = replace(SIMULATED_CAMERA, name="Nadir", gimbal=Gimbal(-90.0, -60.0), offset_m=(0.0, 0.0, -0.3), min_interval_s=1.0)
    kind = UavType.objects.create(organisation=person.organisation, name="Nadir", cameras=[camera_to_json(camera)])
    (uav,) = fleet("Tern")
    mission = planned(person, [uav], [TargetRequest(here.towers[0].pk, task=Task(TaskKind.PHOTO, 6.0))])
    Uav.objects.filter(pk=uav.pk).update(uav_type=kind)
    rehearsal = rehearsed(mission, person, "calm")
    (flight,) = RehearsalTrack.objects.get(run__rehearsal=rehearsal).flights
    target = next(waypoint for waypoint in plan_to_fly(loaded(mission)).routes[0].route.waypoints if waypoint.target is not None)
    photos = flight["photos"]
    assert len(photos) == 2
    for photo in photos:
        assert (photo["waypoint"], photo["pitch_deg"], photo["roll_deg"]) == (target.sequence, -60.0, 0.0)
        assert photo["position"] == pytest.approx(list(target.position), abs=1e-5)
        assert photo["altitude_relative_m"] == pytest.approx(target.altitude_relative_m - 0.3, abs=0.4)
        assert flight["t_s"][0] < photo["t_s"] < flight["t_s"][-1]
    assert rehearsal.uavs[0]["camera"]["name"] == "Nadir"


@pytest.mark.long
def test_the_same_seed_gives_the_same_track(mission: Mission, person: User) -> None:
    first, second = (rehearsed(mission, person, "strong-wind", seed=3, afresh=True) for _ in range(2))
    tracks = [RehearsalTrack.objects.get(run__rehearsal=rehearsal).flights for rehearsal in (first, second)]
    assert tracks[0] == tracks[1]


@pytest.mark.long
def test_wind_that_the_uav_cannot_fly_in_fails_with_its_reason(mission: Mission, person: User) -> None:
    mission.mission_uavs.update(performance={"battery_wh": 56.6, "max_airspeed_mps": 11.0})  # an Iris
    Mission.objects.filter(pk=mission.pk).update(conditions={"wind": [{"altitude_agl_m": 10, "speed_mps": 14.0, "from_deg": 0.0}]})
    rehearsal = rehearsed(mission, person, "as-planned")
    findings = rehearsal.runs.get().assessment["findings"]
    assert rehearsal.level == "fail"
    assert findings[0]["code"] == "wind" and findings[0]["facts"]["wind_mps"] == pytest.approx(14.0)
    assert any(finding["level"] == "fail" for finding in findings[1:])  # and it is seen in what was flown


@pytest.mark.long
def test_wind_that_its_airframe_flies_in_and_the_uav_does_not_fails(mission: Mission, person: User) -> None:
    """What flies for it is as heavy, but stronger."""
    mission.mission_uavs.update(performance={"mass_kg": 3.8, "battery_wh": 260.0, "max_airspeed_mps": 12.0})
    Mission.objects.filter(pk=mission.pk).update(conditions={"wind": [{"altitude_agl_m": 10, "speed_mps": 14.0, "from_deg": 0.0}]})
    rehearsal = rehearsed(mission, person, "as-planned")
    finding = rehearsal.runs.get().assessment["findings"][0]
    assert (rehearsal.uavs[0]["airframe"], rehearsal.level) == ("inspector", "fail")
    assert (finding["code"], finding["facts"]["limit_mps"]) == ("wind", 12.0)


def test_a_battery_that_is_too_small_fails_with_its_reason(here: World, person: User) -> None:
    uav_type = UavType.objects.create(organisation=person.organisation, name="Small", mass_kg=1.545, range_unlimited=True)
    mission = planned(person, fleet(uav_type=uav_type), [here.towers[0]])
    mission.mission_uavs.update(performance={"battery_wh": 10.5})
    rehearsal = rehearsed(mission, person, "calm")
    findings = {finding["code"]: finding for finding in rehearsal.runs.get().assessment["findings"]}
    assert rehearsal.level == "fail"
    assert rehearsal.uavs[0]["battery_wh"] == 10.5
    assert findings["reserve"]["facts"]["percent"] < 20.0


@pytest.mark.long
def test_a_route_that_ends_in_hovering_ends_there(here: World, person: User) -> None:
    draft = create_mission(
        organisation=person.organisation, author=person, name="Bexley", request=worlds.request(here.towers[0], uavs=(worlds.uav(),))
    )
    mission = plan_mission(mission=draft, actor=person)
    rehearsal = rehearsed(mission, person, "calm")
    assert rehearsal.runs.get().assessment["routes"][0]["endings"] == ["hovering"]
    assert rehearsal.level == "pass"


def test_what_is_approved_is_flown_from_its_document(mission: Mission, person: User) -> None:
    before = plan_to_fly(loaded(mission))
    approve_mission(mission=mission, actor=person)
    after = plan_to_fly(loaded(mission))
    assert after.content_sha256 == before.content_sha256
    assert after.routes[0].items == before.routes[0].items


def test_a_mission_without_a_plan_is_refused(here: World, person: User) -> None:
    mission = planned(person, fleet(), [here.towers[0]])
    Mission.objects.filter(pk=mission.pk).update(state=MissionState.DRAFT)
    mission.routes.all().delete()
    with pytest.raises(Refused) as refused:
        asked(mission, person)
    assert refused.value.reasons[0].code == "not_planned"


def test_another_departure_makes_a_rehearsal_out_of_date(mission: Mission, person: User) -> None:
    known = content(mission)
    Mission.objects.filter(pk=mission.pk).update(departs_at=timezone.now() + timedelta(hours=2))
    assert content(mission) != known


def test_another_plan_makes_a_rehearsal_out_of_date_and_the_same_plan_does_not(mission: Mission, person: User) -> None:
    known = content(mission)
    plan_mission(mission=mission, actor=person)
    assert content(mission) == known
    waypoint = mission.routes.get().waypoints.all()[1]
    mission.routes.get().waypoints.filter(pk=waypoint.pk).update(altitude_relative_m=waypoint.altitude_relative_m + 1.0)
    assert content(mission) != known


def test_another_airframe_makes_a_rehearsal_out_of_date(here: World, person: User) -> None:
    uav_type = UavType.objects.create(organisation=person.organisation, name="Heavy", mass_kg=3.8, battery_wh=260.0)
    mission = planned(person, fleet(uav_type=uav_type), [here.towers[0]])
    known, flown = content(mission), plan_to_fly(loaded(mission)).stand_ins[0].airframe
    SimulatedAirframe.objects.create(uav_type=uav_type, airframe="iris" if flown == "inspector" else "inspector")
    assert content(mission) != known


def test_the_pause_between_flights_is_part_of_what_was_rehearsed_where_there_is_one(mission: Mission) -> None:
    (once, *_) = plan_to_fly(loaded(mission)).routes
    twice = replace(once, items=(*once.items, *once.items), rally=(*once.rally, *once.rally))

    def named(route: RouteToFly, turnaround_s: float) -> str:
        return content_of([route], ["iris"], [None], None, turnaround_s)

    assert named(once, 60.0) == named(once, 300.0)
    assert named(twice, 60.0) != named(twice, 300.0)


def test_a_plan_that_changes_before_a_worker_comes_is_not_flown(mission: Mission, person: User) -> None:
    rehearsal = asked(mission, person)
    Mission.objects.filter(pk=mission.pk).update(departs_at=timezone.now() + timedelta(hours=2))
    rehearse_mission(str(rehearsal.job_id))
    rehearsal.job.refresh_from_db()
    assert (rehearsal.job.state, rehearsal.job.error["code"]) == (JobState.FAILED, "mission_changed")
    assert not RehearsalTrack.objects.exists()


def test_one_that_is_cancelled_before_a_worker_comes_is_not_flown(mission: Mission, person: User) -> None:
    rehearsal = asked(mission, person)
    cancel_rehearsal(rehearsal=rehearsal, actor=person)
    rehearse_mission(str(rehearsal.job_id))
    rehearsal.job.refresh_from_db()
    assert rehearsal.job.state == JobState.CANCELLED
    assert not RehearsalRun.objects.exclude(level="").exists()


@pytest.mark.long
def test_what_was_flown_alike_lately_is_taken_over_and_not_flown_again(mission: Mission, person: User) -> None:
    first = rehearsed(mission, person, "calm").runs.get()
    with mock.patch("simulation.services.rehearsals.fly", side_effect=AssertionError("it is flown")):
        again = rehearsed(mission, person, "calm")
    run = again.runs.get()
    assert (again.job.state, again.level) == (JobState.DONE, "pass")
    assert (run.assessment, run.finished_at) == (first.assessment, first.finished_at)
    assert run.tracks.get().flights == first.tracks.get().flights


@pytest.mark.long
@pytest.mark.parametrize("what", ["another seed", "another air", "another ground", "long ago", "asked for afresh"])
def test_what_differs_is_flown(mission: Mission, person: User, what: str) -> None:
    first = rehearsed(mission, person, "calm")
    if what == "another ground":
        worlds.mark_ground_changed()
    if what == "long ago":
        first.runs.update(finished_at=timezone.now() - timedelta(hours=25))
    flown = mock.Mock(side_effect=Flown)
    with mock.patch("simulation.services.rehearsals.fly", flown), pytest.raises(Flown):
        rehearsed(
            mission,
            person,
            "strong-wind" if what == "another air" else "calm",
            seed=8 if what == "another seed" else 7,
            afresh=what == "asked for afresh",
        )


class Flown(Exception):
    """A flight has begun."""


@pytest.mark.long
def test_a_worker_that_takes_over_flies_only_what_is_left(mission: Mission, person: User) -> None:
    rehearsal = asked(mission, person, "calm", "as-planned")
    kept = {"level": "pass", "findings": [], "routes": [], "meetings": []}
    rehearsal.runs.filter(sequence=0).update(level="pass", assessment=kept, finished_at=timezone.now())
    rehearse_mission(str(rehearsal.job_id))
    assert Rehearsal.objects.get().level == "pass"
    assert rehearsal.runs.get(sequence=0).assessment == kept
    assert list(RehearsalTrack.objects.values_list("run__sequence", flat=True)) == [1]


def reasons(mission: Mission, person: User) -> list[str]:
    try:
        approve_mission(mission=mission, actor=person)
    except Refused as refused:
        return [reason.code for reason in refused.reasons]
    return []


def test_nobody_asks_for_a_rehearsal_unless_told(mission: Mission, person: User) -> None:
    assert reasons(mission, person) == []


def test_a_failed_rehearsal_of_this_plan_is_acknowledged_with_a_reason_that_is_kept(mission: Mission, person: User) -> None:
    rehearsal = rehearsed(mission, person, "as-planned")
    Rehearsal.objects.filter(pk=rehearsal.pk).update(level="fail")
    assert reasons(mission, person) == ["acknowledge_failed_rehearsal"]
    address, client = f"missions/{mission.pk}/approve", client_of(person)
    assert post(client, address, {}).json()["error"]["code"] == "acknowledge_failed_rehearsal"
    body = {"acknowledges_failed_rehearsal": "The strong wind is not forecast"}
    assert post(client, address, body).status_code == 200
    approval = Approval.objects.get(mission=mission)
    assert approval.failed_rehearsal_reason == "The strong wind is not forecast"
    entry = AuditEntry.objects.get(action="approve", subject_id=str(mission.pk))
    assert entry.after["failed_rehearsal_reason"] == "The strong wind is not forecast"


@pytest.mark.long
def test_a_failed_rehearsal_of_another_plan_needs_no_acknowledgement(mission: Mission, person: User) -> None:
    rehearsal = rehearsed(mission, person, "as-planned")
    Rehearsal.objects.filter(pk=rehearsal.pk).update(level="fail", content_sha256="0" * 64)
    assert reasons(mission, person) == []


@pytest.mark.long
def test_no_reason_replaces_a_rehearsal_that_the_organisation_requires(mission: Mission, person: User) -> None:
    set_rule(organisation=person.organisation, actor=person, requires=True)
    rehearsal = rehearsed(mission, person, "as-planned")
    Rehearsal.objects.filter(pk=rehearsal.pk).update(level="fail")
    with pytest.raises(Refused):
        approve_mission(mission=mission, actor=person, failed_rehearsal_reason="It will be fine")


def test_approval_asks_for_a_rehearsal_of_this_very_plan_that_passed(mission: Mission, person: User) -> None:
    set_rule(organisation=person.organisation, actor=person, requires=True)
    assert reasons(mission, person) == ["not_rehearsed"]
    rehearsal = rehearsed(mission, person, "as-planned")
    Rehearsal.objects.filter(pk=rehearsal.pk).update(level="fail")
    assert reasons(mission, person) == ["rehearsal_failed"]
    Rehearsal.objects.filter(pk=rehearsal.pk).update(level="pass", content_sha256="0" * 64)
    assert reasons(mission, person) == ["rehearsal_outdated"]
    Rehearsal.objects.filter(pk=rehearsal.pk).update(content_sha256=content(mission))
    rehearsed(mission, person, "calm")
    assert reasons(mission, person) == ["rehearsal_without_planned_conditions"]
    rehearsed(mission, person, "calm", "as-planned")
    assert reasons(mission, person) == []
    assert mission_of_organisation(person.organisation, mission.pk).state == MissionState.APPROVED


@pytest.mark.long
def test_what_was_rehearsed_in_other_wind_than_is_planned_by_now_is_not_approved(mission: Mission, person: User) -> None:
    """A UAV with airspeed to spare flies the same route, to the last item."""
    set_rule(organisation=person.organisation, actor=person, requires=True)
    mission.mission_uavs.update(performance={"max_airspeed_mps": 22.0})
    plan_mission(mission=loaded(mission), actor=person)
    rehearsed(mission, person, "as-planned")
    known = content(mission)
    Mission.objects.update(conditions={"wind": [{"altitude_agl_m": 10, "speed_mps": 6.0, "from_deg": 90.0}]})
    plan_mission(mission=loaded(mission), actor=person)
    assert content(mission) == known
    assert [reason.code for reason in reasons_without_rehearsal(loaded(mission))] == ["rehearsal_in_other_air"]
    rehearsed(mission, person, "as-planned")
    assert reasons_without_rehearsal(loaded(mission)) == []


@pytest.mark.long
def test_what_was_rehearsed_without_a_mast_that_the_network_has_by_now_is_not_approved(mission: Mission, person: User, here: World) -> None:
    """The network follows the ground some minutes later, under the same revision."""
    set_rule(organisation=person.organisation, actor=person, requires=True)
    lon, lat = here.towers[0].centre.coords[:2]
    worlds.power_line([tower((lon + 0.002, lat + 0.003 * place)) for place in (1, 2)])
    mark_ground_changed()
    rehearsed(mission, person, "as-planned")
    revision = planning_read().dataset_version
    build_graph()
    assert planning_read().dataset_version == revision
    assert [reason.code for reason in reasons_without_rehearsal(loaded(mission))] == ["rehearsal_on_other_ground"]
    with mock.patch("simulation.services.rehearsals.fly", side_effect=Flown), pytest.raises(Flown):
        rehearsed(mission, person, "as-planned")


@pytest.mark.long
def test_a_rehearsal_speaks_of_the_ground_that_it_was_flown_over(mission: Mission, person: User, here: World) -> None:
    """A zone that was away while it was flown, and is back, was not looked at."""
    set_rule(organisation=person.organisation, actor=person, requires=True)
    lon, lat = here.towers[0].centre.coords[:2]
    beside = zone_around((lon, lat + 0.01), with_graph=False, name="Beside")
    rehearsal = asked(mission, person, "as-planned")
    beside.delete()
    mark_ground_changed()
    rehearse_mission(str(rehearsal.job_id))
    zone_around((lon, lat + 0.01), with_graph=False, name="Beside")
    assert [reason.code for reason in reasons_without_rehearsal(loaded(mission))] == ["rehearsal_on_other_ground"]


def test_what_was_rehearsed_on_other_ground_is_not_approved(mission: Mission, person: User, here: World) -> None:
    """A new zone beside the routes counts, one far away does not, and one that is taken away again never was."""
    set_rule(organisation=person.organisation, actor=person, requires=True)
    rehearsed(mission, person, "as-planned")
    lon, lat = here.towers[0].centre.coords[:2]
    zone_around((lon, lat + 0.7), with_graph=False, name="Far away")
    assert reasons_without_rehearsal(loaded(mission)) == []
    beside = zone_around((lon, lat + 0.01), with_graph=False, name="Beside")
    assert [reason.code for reason in reasons_without_rehearsal(loaded(mission))] == ["rehearsal_on_other_ground"]
    assert "rehearsal_on_other_ground" in reasons(mission, person)
    beside.delete()
    mark_ground_changed()
    assert reasons(mission, person) == []


@pytest.mark.long
def test_a_route_that_begins_in_the_air_says_that_its_rehearsal_took_off(mission: Mission, person: User) -> None:
    plan = plan_to_fly(loaded(mission))
    begun = replace(plan, routes=tuple(replace(route, route=replace(route.route, begun_by=0)) for route in plan.routes))
    with mock.patch("simulation.services.rehearsals.plan_to_fly", return_value=begun):
        reported = rehearsed(mission, person, "calm")
    assert reported.level == "warnings"
    (finding,) = reported.runs.get().assessment["findings"]
    assert (finding["level"], finding["code"]) == ("warnings", "begun-in-air")
    assert "took off by itself first" in reason_of(finding, {}, {})
