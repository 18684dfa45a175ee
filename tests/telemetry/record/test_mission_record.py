"""The record of a mission that was flown: in the API, in one file, and by the rule that says which targets were done."""

import io
import json
import zipfile
from datetime import datetime, timedelta
from typing import Any

import pytest
from django.contrib.gis.geos import Point
from django.test import Client
from django.utils import timezone

from missions.models import Approval, InspectionTarget, Mission, MissionState, OfferState, ReplanOffer, TargetState, Uav
from missions.services.commands.flight_progress import FlightEnd, mark_flight_ended, mark_waypoint_reached
from missions.services.mission_copies import duplicate_mission
from telemetry.models import AlertLevel, InspectionResult, PositionEstimate, TelemetryRecord, TelemetryStream
from telemetry.services.alerts.alerts import open_alert
from telemetry.services.targets_checked import LOOKBACK_S, TargetChecks, store_missing_visits
from tests.accounts.users import a_user, client_of
from tests.telemetry.flown import fly, record_of, route_of
from workspace.models import Organisation, Role, User

pytestmark = pytest.mark.django_db
EARLIER = timedelta(minutes=30)


def began() -> datetime:
    return timezone.now() - EARLIER


def end(mission: Mission, uav: Uav) -> None:
    mark_flight_ended(mission_id=mission.pk, uav_id=uav.pk, flight=1, end=FlightEnd.FLOWN)


def age_states(mission: Mission) -> None:
    InspectionTarget.objects.filter(mission=mission).update(state_at=timezone.now() - timedelta(seconds=10))


def states(mission: Mission) -> list[tuple[str, str]]:
    return list(mission.targets.order_by("sequence").values_list("state", "state_reason"))


def test_a_flown_mission_is_told_by_leg_and_target(client: Client, mission: Mission, approval: Approval, tern: Uav) -> None:
    over = fly(approval, tern, began())
    end(mission, tern)
    open_alert(uav=tern, level=AlertLevel.WARNING, code="link-lost", message="no report for 12 s", mission=mission)
    reported = record_of(client, mission)
    assert reported["mission"]["state"] == MissionState.COMPLETED
    assert reported["mission"]["approval"]["content_sha256"] == approval.content_sha256
    summary = reported["summary"]
    assert summary["targets"] == {"pending": 0, "in-progress": 0, "complete": 3, "skipped": 0, "failed": 0, "all": 3}
    assert summary["alerts"] == {"critical": 0, "warning": 1, "advisory": 0}
    assert summary["across_rms_m"] < 1.0 and summary["height_rms_m"] < 1.0
    assert summary["flown"]["length_m"] == pytest.approx(summary["planned"]["length_m"], rel=0.02)
    (route,) = reported["routes"]
    assert len(route["legs"]) == len(route["waypoints"]) - 1 and all(leg["reports"] for leg in route["legs"] if leg["length_m"] > 1.0)
    assert datetime.fromisoformat(route["flown"]["ended_at"]) == pytest.approx(over, abs=timedelta(seconds=1))
    for target in reported["targets"]:
        assert target["state"] == TargetState.COMPLETE and target["closest_m"] < 15.0 and target["reached_at"] is not None


def test_the_record_says_how_good_the_estimates_were_and_they_can_be_thinned_out(
    client: Client, mission: Mission, approval: Approval, tern: Uav
) -> None:
    fly(approval, tern, began())
    records = list(TelemetryRecord.objects.filter(mission=mission).order_by("measured_at")[100:140])
    PositionEstimate.objects.bulk_create(
        PositionEstimate(
            uav=tern, mission=mission, estimated_for=record.measured_at, made_at=record.measured_at, speed_mps=12.0,
            position=Point(record.position.x, record.position.y + (0.001 if number < 10 else 0.0), srid=4326),
            bound_along_m=20.0, bound_across_m=20.0, bound_bearing_deg=0.0, bound_height_m=5.0, bound_speed_mps=2.0,
        )
        for number, record in enumerate(records)
    )  # fmt: skip
    reported = record_of(client, mission)["summary"]["estimates"]
    assert (reported["compared"], reported["untold"], reported["share_inside"]) == (40, 0, 0.75)
    assert reported["largest_m"] == pytest.approx(111.0, abs=2.0) and reported["rms_m"] == pytest.approx(55.7, abs=1.5)
    thinned = client.get(f"/api/v1/missions/{mission.pk}/estimates?most=10").json()
    assert 4 <= len(thinned["features"]) <= 11 and thinned["every_s"] > 3.0
    assert len(client.get(f"/api/v1/missions/{mission.pk}/estimates?most=100").json()["features"]) == 40


def test_a_mission_that_has_not_flown_has_a_record_without_figures(client: Client, mission: Mission) -> None:
    reported = record_of(client, mission)
    assert reported["summary"]["across_rms_m"] is None and reported["summary"]["flown"]["length_m"] == 0.0
    assert {target["closest_m"] for target in reported["targets"]} == {None}


def test_a_draft_has_a_record_that_says_so(client: Client) -> None:
    reported = record_of(client, Mission.objects.create(name="Draft"))
    assert reported["mission"]["approval"] is None and reported["routes"] == []


@pytest.mark.parametrize(("state", "is_named"), [(OfferState.ACCEPTED, True), (OfferState.DECLINED, False)])
def test_the_record_leads_to_the_mission_that_flies_the_rest(client: Client, mission: Mission, state: OfferState, is_named: bool) -> None:
    rest = Mission.objects.create(name="The rest", continues=mission)
    ReplanOffer.objects.create(mission=mission, code="uav-out", state=state, continuation=rest)
    assert record_of(client, mission)["mission"]["continued_by"] == (str(rest.pk) if is_named else None)
    assert record_of(client, rest)["mission"]["continues"] == str(mission.pk)


def test_another_organisations_record_is_not_there(mission: Mission) -> None:
    stranger = client_of(a_user(Role.OPERATOR, Organisation.objects.create(name="Other")))
    assert stranger.get(f"/api/v1/missions/{mission.pk}/record").status_code == 404
    assert stranger.get(f"/api/v1/missions/{mission.pk}/record.zip").status_code == 404


def test_all_data_come_in_one_file(client: Client, mission: Mission, approval: Approval, tern: Uav, person: User) -> None:
    fly(approval, tern, began())
    open_alert(uav=tern, level=AlertLevel.WARNING, code="link-lost", message="no report for 12 s", mission=mission)
    answer = client.get(f"/api/v1/missions/{mission.pk}/record.zip", headers={"Accept": "text/html"})
    assert answer.status_code == 200 and answer["Content-Type"] == "application/zip"
    packed = zipfile.ZipFile(io.BytesIO(b"".join(answer.streaming_content)))  # type: ignore[attr-defined]
    assert packed.testzip() is None
    assert json.loads(packed.read("approval.json"))["content_sha256"] == approval.content_sha256
    assert json.loads(packed.read("record.json"))["mission"]["name"] == mission.name
    assert packed.read("telemetry.csv").count(b"\n") == packed.read("telemetry.geojson").count(b'"Feature"') + 1
    assert [alert["code"] for alert in json.loads(packed.read("alerts.json"))] == ["link-lost"]
    commands = json.loads(packed.read("commands.json"))
    assert [(command["kind"], command["by"]) for command in commands] == [("upload-mission", person.username)]


# Which targets were done


def test_a_target_that_was_left_out_is_skipped_though_the_vehicle_went_on(mission: Mission, approval: Approval, tern: Uav) -> None:
    visited = [waypoint for waypoint in route_of(approval, tern).waypoints if waypoint.target is not None]
    fly(approval, tern, began(), leaves_out=visited[0].sequence)
    mark_waypoint_reached(mission_id=mission.pk, uav_id=tern.pk, waypoint=visited[2].sequence + 1)
    age_states(mission)
    checks = TargetChecks()
    assert checks.check([tern.pk]) == 1
    left_out = visited[0].target
    assert [state for state in states(mission) if state[1]] == [("skipped", "not-reached")]
    assert states(mission)[left_out or 0] == ("skipped", "not-reached")
    assert checks.check([tern.pk]) == 0
    assert TargetChecks().check([tern.pk]) == 0


def test_targets_that_were_reached_stay_complete_however_seldom_it_reports(mission: Mission, approval: Approval, tern: Uav) -> None:
    fly(approval, tern, began(), every_s=10)
    end(mission, tern)
    age_states(mission)
    assert TargetChecks().check([tern.pk]) == 0
    assert {state for state, _ in states(mission)} == {"complete"}


def test_a_watch_forgets_what_it_looked_at_long_ago(mission: Mission, approval: Approval, tern: Uav) -> None:
    fly(approval, tern, began())
    end(mission, tern)
    age_states(mission)
    checks = TargetChecks()
    checks.check([tern.pk])
    assert checks != TargetChecks()
    mission.targets.update(state_at=timezone.now() - 2 * timedelta(seconds=LOOKBACK_S))
    checks.check([tern.pk])
    assert checks == TargetChecks()


def test_what_a_uav_reports_of_a_target_itself_is_not_overruled(mission: Mission, approval: Approval, tern: Uav) -> None:
    visited = [waypoint for waypoint in route_of(approval, tern).waypoints if waypoint.target is not None]
    fly(approval, tern, began(), leaves_out=visited[0].sequence)
    target = mission.targets.get(sequence=visited[0].target)
    InspectionResult.objects.create(
        stream=TelemetryStream.objects.create(uav=tern, link="http", key="results"), sequence=1, uav=tern, mission=mission,
        approval=approval, place=target.sequence, target=target, measured_at=timezone.now(), outcome="complete",
    )  # fmt: skip
    end(mission, tern)
    age_states(mission)
    assert TargetChecks().check([tern.pk]) == 0


def test_without_a_single_report_nothing_is_overruled(mission: Mission, tern: Uav) -> None:
    end(mission, tern)
    age_states(mission)
    assert TargetChecks().check([tern.pk]) == 0


def results_by_place(client: Client, **asked: Any) -> dict[int, dict[str, Any]]:
    rows = client.get("/api/v1/results", asked).json()["results"]
    return {row["place"]: row for row in rows}


def test_results_say_when_a_target_was_reached_and_how_long_it_was_held(
    client: Client, mission: Mission, approval: Approval, tern: Uav
) -> None:
    fly(approval, tern, began())
    end(mission, tern)
    age_states(mission)
    assert {(row["reached_at"], row["held_s"]) for row in results_by_place(client).values()} == {(None, None)}
    before = timezone.now()
    TargetChecks().check([tern.pk])
    reported = results_by_place(client)
    on_record = record_of(client, mission)["targets"]
    assert [(reported[row["place"]]["reached_at"], reported[row["place"]]["held_s"]) for row in on_record] == [
        (row["reached_at"], row["held_s"]) for row in on_record
    ]
    times = sorted(row["reached_at"] for row in reported.values())
    assert None not in times
    assert len(results_by_place(client, reached_from=times[1])) == len(times) - 1
    assert len(results_by_place(client, reached_before=times[1])) == 1
    assert set(results_by_place(client, changed_since=before.isoformat())) == set(reported), "a visit that is stored later is a change"
    stored_at = set(mission.targets.values_list("visit_stored_at", flat=True))
    TargetChecks().check([tern.pk])
    assert set(mission.targets.values_list("visit_stored_at", flat=True)) == stored_at, "the same again is no change"


def test_a_target_that_was_passed_far_off_has_a_stay_of_nothing_and_no_time(
    client: Client, mission: Mission, approval: Approval, tern: Uav
) -> None:
    visited = [waypoint for waypoint in route_of(approval, tern).waypoints if waypoint.target is not None]
    fly(approval, tern, began(), leaves_out=visited[0].sequence)
    end(mission, tern)
    age_states(mission)
    TargetChecks().check([tern.pk])
    missed = results_by_place(client)[visited[0].target or 0]
    assert (missed["state"], missed["reached_at"], missed["held_s"]) == ("skipped", None, 0.0)


def test_visits_that_no_watch_has_seen_are_stored_by_the_clock_once_the_mission_has_ended(
    mission: Mission, approval: Approval, tern: Uav
) -> None:
    fly(approval, tern, began())
    assert store_missing_visits() == 0
    end(mission, tern)
    assert store_missing_visits() == 0, "the watch looks first"
    Mission.objects.filter(pk=mission.pk).update(ended_at=timezone.now() - timedelta(seconds=2 * LOOKBACK_S))
    assert store_missing_visits() == mission.targets.count()
    assert not mission.targets.filter(reached_at=None).exists()
    assert store_missing_visits() == 0


def test_targets_that_a_uav_reported_itself_have_their_visit_too(client: Client, mission: Mission, approval: Approval, tern: Uav) -> None:
    fly(approval, tern, began())
    stream = TelemetryStream.objects.create(uav=tern, link="http", key="results")
    for target in mission.targets.all():
        InspectionResult.objects.create(
            stream=stream, sequence=target.sequence, uav=tern, mission=mission, approval=approval, place=target.sequence, target=target,
            measured_at=timezone.now(), outcome="complete",
        )  # fmt: skip
    end(mission, tern)
    age_states(mission)
    assert TargetChecks().check([tern.pk]) == 0
    assert all(row["reached_at"] for row in results_by_place(client).values())


def test_a_copy_has_no_visits(mission: Mission, approval: Approval, tern: Uav, person: User) -> None:
    fly(approval, tern, began())
    end(mission, tern)
    age_states(mission)
    TargetChecks().check([tern.pk])
    assert mission.targets.exclude(reached_at=None).exists()
    copy = duplicate_mission(mission=mission, author=person)
    assert set(copy.targets.values_list("reached_at", "held_s", "visit_stored_at")) == {(None, None, None)}
