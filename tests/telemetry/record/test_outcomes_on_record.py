"""What the record says came of each target, and what kept UAVs from the others."""

from datetime import datetime, timedelta
from typing import Any

import pytest
from django.test import Client
from django.utils import timezone

from missions.models import Approval, CommandKind, Mission, MissionState, TargetState, Uav
from missions.services.commands.dispatch import abort_mission
from missions.services.commands.flight_progress import mark_waypoint_reached
from missions.services.commands.outbox import queue_command
from telemetry.models import AlertLevel, TelemetryRecord, VehicleText
from telemetry.services.alerts.alerts import open_alert
from tests.telemetry.flown import fly, record_of, route_of
from workspace.models import User

pytestmark = pytest.mark.django_db
EARLIER = timedelta(minutes=30)


def in_order_of_the_route(reported: dict[str, Any]) -> list[dict[str, Any]]:
    return sorted(reported["targets"], key=lambda target: target["waypoint_sequence"])


def ends_after(mission: Mission, approval: Approval, tern: Uav, target: int) -> datetime:
    """Its flight breaks off 5 s after the target at this place of its route. Returns when."""
    fly(approval, tern, timezone.now() - EARLIER)
    visited = [waypoint for waypoint in route_of(approval, tern).waypoints if waypoint.target is not None]
    on_leg = TelemetryRecord.objects.filter(mission=mission, waypoint_sequence=visited[target].sequence).latest("measured_at")
    over = on_leg.measured_at + timedelta(seconds=5)
    TelemetryRecord.objects.filter(mission=mission, measured_at__gt=over).delete()
    mark_waypoint_reached(mission_id=mission.pk, uav_id=tern.pk, waypoint=visited[target].sequence + 1)
    return over


def test_a_crash_is_why_the_targets_after_it_were_not_inspected(
    client: Client, mission: Mission, approval: Approval, tern: Uav, person: User
) -> None:
    over = ends_after(mission, approval, tern, 0)
    VehicleText.objects.create(uav=tern, severity=2, text="Motor 1 has failed", received_at=over - timedelta(seconds=6))
    VehicleText.objects.create(uav=tern, severity=0, text="Crashed: It hit the ground at 9.3 m/s.", received_at=over)
    details = {"position": [10.01, 56.0], "away_m": 240.0, "flight": 1}
    down = open_alert(uav=tern, level=AlertLevel.CRITICAL, code="down-off-plan", message="down", mission=mission, details=details)
    type(down).objects.filter(pk=down.pk).update(opened_at=over + timedelta(seconds=2))
    abort_mission(mission=mission, actor=person, why="Tern is down")
    reported = record_of(client, mission)
    first, *rest = in_order_of_the_route(reported)
    assert (first["result"], first["reason"]) == ("inspected", None)
    for target in rest:
        assert (target["result"], target["reason"]["code"]) == ("not-inspected", "crashed-cause")
        assert target["reason"]["message"] == "Tern crashed, motor" and target["closest_m"] != 0.0
        assert datetime.fromisoformat(target["reason"]["at"]) == over
    assert reported["summary"]["results"] == {"inspected": 1, "not-confirmed": 0, "not-inspected": 2, "open": 0, "all": 3}
    assert [(one["kind"], one["message"], one["position"]) for one in reported["incidents"]] == [
        ("crashed", "Tern crashed, motor", [10.01, 56.0]),
        ("aborted", f"mission aborted by {person.username}: Tern is down", None),
    ]


def test_after_an_abort_no_target_is_in_progress_and_each_has_the_reason(
    client: Client, mission: Mission, approval: Approval, tern: Uav, person: User
) -> None:
    ends_after(mission, approval, tern, 0)
    visited = [waypoint for waypoint in route_of(approval, tern).waypoints if waypoint.target is not None]
    mark_waypoint_reached(mission_id=mission.pk, uav_id=tern.pk, waypoint=visited[1].sequence)
    assert "in-progress" in {target["state"] for target in record_of(client, mission)["targets"]}
    abort_mission(mission=mission, actor=person, why="thunderstorm")
    _, *rest = in_order_of_the_route(record_of(client, mission))
    assert {target["result"] for target in rest} == {"not-inspected"}
    assert {target["state"] for target in rest} == {TargetState.PENDING}
    assert {target["reason"]["message"] for target in rest} == {f"mission aborted by {person.username}: thunderstorm"}


@pytest.mark.parametrize(
    ("code", "details", "text", "words"),
    [
        ("mode-changed", {"mode": "RTL"}, "Battery 1 low 13.9V", "Tern returned by its failsafe, battery"),
        ("mode-changed", {"mode": "LAND"}, "", "Tern landed by its failsafe or its pilot, not commanded from here"),
        ("battery-short", {}, "", "Tern was critically low on battery"),
        ("link-lost", {}, "", "Tern lost its link"),
    ],
)
def test_a_failsafe_a_battery_and_a_lost_link_are_named(
    client: Client, mission: Mission, approval: Approval, tern: Uav, code: str, details: dict[str, Any], text: str, words: str
) -> None:
    over = ends_after(mission, approval, tern, 1)
    if text:
        VehicleText.objects.create(uav=tern, severity=4, text=text, received_at=over - timedelta(seconds=3))
    alert = open_alert(uav=tern, level=AlertLevel.CRITICAL, code=code, message="…", mission=mission, details=details)
    type(alert).objects.filter(pk=alert.pk).update(opened_at=over)
    Mission.objects.filter(pk=mission.pk).update(state=MissionState.FAILED)
    reported = record_of(client, mission)
    assert [target["reason"]["message"] for target in reported["targets"] if target["reason"]] == [words]
    (incident,) = reported["incidents"]
    assert incident["message"] == words and incident["position"] is not None


def test_what_a_person_told_a_uav_is_why(client: Client, mission: Mission, approval: Approval, tern: Uav, person: User) -> None:
    over = ends_after(mission, approval, tern, 1)
    command = queue_command(uav=tern, kind=CommandKind.RETURN, actor=person, why="rain", mission=mission, approval=approval)
    type(command).objects.filter(pk=command.pk).update(state="applied", sent_at=over)
    Mission.objects.filter(pk=mission.pk).update(state=MissionState.ABORTED)
    reported = record_of(client, mission)
    words = f"{person.username} told Tern to return: rain"
    assert [target["reason"]["message"] for target in reported["targets"] if target["reason"]] == [words]


def test_a_target_that_no_route_reaches_has_the_planners_reason(client: Client, mission: Mission, approval: Approval, tern: Uav) -> None:
    left_out = mission.targets.get(sequence=2)
    for route in approval.document["routes"]:
        for waypoint in route["route"]["waypoints"]:
            waypoint["target"] = None if waypoint["target"] == left_out.sequence else waypoint["target"]
    approval.save(update_fields=["document"])
    mission.targets.filter(pk=left_out.pk).update(unassigned_message="It stands inside Varneck Airfield.")
    Mission.objects.filter(pk=mission.pk).update(state=MissionState.COMPLETED)
    reported = next(target for target in record_of(client, mission)["targets"] if target["place"] == left_out.sequence)
    assert (reported["result"], reported["reason"]["message"]) == ("not-inspected", "It stands inside Varneck Airfield")


def test_while_a_mission_is_under_way_its_targets_are_open(client: Client, mission: Mission, approval: Approval, tern: Uav) -> None:
    ends_after(mission, approval, tern, 0)
    reported = record_of(client, mission)
    assert [target["result"] for target in in_order_of_the_route(reported)] == ["inspected", "open", "open"]


def test_complete_is_not_confirmed_where_no_report_is_near(client: Client, mission: Mission, approval: Approval, tern: Uav) -> None:
    """The reports of 40 s about a target are lost: it can have been there."""
    fly(approval, tern, timezone.now() - EARLIER)
    visited = [waypoint for waypoint in route_of(approval, tern).waypoints if waypoint.target is not None]
    there = TelemetryRecord.objects.filter(mission=mission, waypoint_sequence=visited[1].sequence).latest("measured_at").measured_at
    about = (there - timedelta(seconds=20), there + timedelta(seconds=20))
    TelemetryRecord.objects.filter(mission=mission, measured_at__range=about).delete()
    mark_waypoint_reached(mission_id=mission.pk, uav_id=tern.pk, waypoint=visited[2].sequence + 1)
    _, target, _ = in_order_of_the_route(record_of(client, mission))
    assert (target["state"], target["result"], target["reason"]["code"]) == ("complete", "not-confirmed", "nearest-report")
    assert target["reason"]["message"] == f"nearest report {round(target['closest_m'])} m away" and target["closest_m"] > 15.0


def test_targets_are_in_flown_order(client: Client, mission: Mission, approval: Approval, tern: Uav) -> None:
    fly(approval, tern, timezone.now() - EARLIER)
    targets = record_of(client, mission)["targets"]
    by_flown = sorted(targets, key=lambda target: target["flown_place"])
    times = [target["reached_at"] for target in by_flown]
    assert times == sorted(times) and [target["flown_place"] for target in by_flown] == [1, 2, 3]


def test_times_of_a_simulation_are_compared_by_its_own_clock(client: Client, mission: Mission, approval: Approval, tern: Uav) -> None:
    """Flown at twice real time: the log has half of the seconds, the vehicle's clock all of them."""
    began = timezone.now() - EARLIER
    fly(approval, tern, began)
    real = record_of(client, mission)
    for row in TelemetryRecord.objects.filter(mission=mission):
        row.measured_at = began + (row.measured_at - began) / 2
        row.save(update_fields=["measured_at"])
    reported = record_of(client, mission)
    assert reported["summary"]["clock_rate"] == pytest.approx(2.0, rel=0.01)
    assert reported["summary"]["flown"]["duration_s"] == pytest.approx(real["summary"]["flown"]["duration_s"], rel=0.01)
    for one, other in zip(reported["targets"], real["targets"], strict=True):
        assert one["reached_after_s"] == pytest.approx(other["reached_after_s"], abs=2.0)
        assert one["planned_after_s"] is None or one["planned_after_s"] > 0.0
