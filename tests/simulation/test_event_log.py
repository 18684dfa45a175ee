"""The event log over the API: what happened, who and when, of one mission and of all that fly."""

import base64
import json
from dataclasses import replace
from datetime import timedelta

import pytest
from django.db import connection
from django.test import Client
from django.test.utils import CaptureQueriesContext
from django.utils import timezone

from mavlink.decoding.measurement import Measurement
from missions.models import CommandKind, LinkKind, Mission, MissionState, TargetState, Uav
from missions.services.commands.flight_progress import FlightEnd, mark_flight_ended, mark_started, mark_target
from missions.services.commands.steering import command_uav
from missions.services.replanning import decline_offer, suggest
from missions.services.replanning.offers import settle_offers
from telemetry.models import AlertLevel, FlightEvent, VehicleText
from telemetry.selectors import events as telemetry_events
from telemetry.services import NewRecord, store_records
from telemetry.services.alerts.alerts import acknowledge_alert, close_alert, open_alert
from tests.accounts.users import a_user, client_of
from tests.missions.api import patch, post
from tests.missions.flights import carry, dispatched, fleet
from tests.missions.worlds import world
from tests.simulation.simulations import stand_ins
from workspace.models import Organisation, Role, User

pytestmark = pytest.mark.django_db
LATE = "%(uav)s: no telemetry for %(seconds)s s."


@pytest.fixture
def person() -> User:
    user = a_user()
    user.first_name, user.last_name = "Ada", "Marsh"
    user.save()
    return user


@pytest.fixture
def client(person: User) -> Client:
    return client_of(person)


@pytest.fixture
def mission(person: User) -> Mission:
    """On its way, with its route on board."""
    uavs = fleet("Tern")
    found = dispatched(person, uavs, world().towers[:1])
    carry(*uavs)
    return found


@pytest.fixture
def tern(mission: Mission) -> Uav:
    return Uav.objects.get(name="Tern")


def events(client: Client, mission: Mission, query: str = "", language: str = "en") -> list[dict]:
    answer = client.get(f"/api/v1/missions/{mission.pk}/events{query}", headers={"Accept-Language": language})
    assert answer.status_code == 200, answer.content
    return answer.json()["results"]


def of_kind(client: Client, mission: Mission, kind: str) -> list[dict]:
    return [event for event in events(client, mission) if event["kind"] == kind]


def report(uav: Uav, second: int, *, is_in_air: bool | None, boot: str = "boot", mission: Mission | None = None) -> None:
    at = timezone.now() + timedelta(seconds=second)
    reported = Measurement(longitude_deg=10.0, latitude_deg=55.0, mode="Mission", is_in_air=is_in_air)
    store_records([NewRecord(uav.pk, LinkKind.MAVLINK, boot, second, at, at, reported, mission_id=mission and mission.pk)])


def test_an_injected_fault_names_the_person_and_the_uav(client, mission, person):
    simulation = stand_ins(mission, person)
    (vehicle,) = simulation.vehicles.all()
    assert patch(client, f"simulated-vehicles/{vehicle.pk}", {"faults": {"motor_failed": 1}}).status_code == 200
    (fault,) = of_kind(client, mission, "fault-injected")
    assert (fault["who"], fault["uav"]["name"], fault["is_simulated"]) == ("Ada Marsh", "Tern", True)
    assert fault["values"] == {"faults": {"motor_failed": 1}}
    assert fault["message"] == "Tern: fault injected by Ada Marsh: motor_failed 1"
    patch(client, f"simulations/{simulation.pk}", {"speed": 2})
    client.delete(f"/api/v1/simulations/{simulation.pk}")
    kinds = [event["kind"] for event in events(client, mission) if event["kind"].startswith("simulation")]
    assert kinds == ["simulation-ended", "simulation-changed", "simulation-started"]


def test_take_off_and_landing_are_told_once_each(client, mission, tern):
    for second, is_in_air in enumerate([False, True, True, None, True, False, False]):
        report(tern, second, is_in_air=is_in_air)
    report(tern, 2, is_in_air=True)  # a record that comes again
    reported = [event for event in events(client, mission) if event["kind"] in ("take-off", "landing")]
    assert [(event["kind"], event["message"]) for event in reported] == [("landing", "Tern landed"), ("take-off", "Tern took off")]
    report(tern, 10, is_in_air=True)
    assert len(of_kind(client, mission, "take-off")) == 2


def test_a_landing_is_told_though_a_report_before_it_said_nothing_of_it(client, mission, tern):
    for second, is_in_air in enumerate([False, True, True, None, False]):
        report(tern, second, is_in_air=is_in_air)
    report(tern, 5, is_in_air=True)
    assert [event["kind"] for event in events(client, mission) if event["kind"] in ("take-off", "landing")] == [
        "take-off", "landing", "take-off",
    ]  # fmt: skip


@pytest.mark.parametrize("key", ["\ud800", "\0", 7, None])
def test_a_cursor_that_nobody_gave_is_refused(client, mission, key):
    cursor = base64.urlsafe_b64encode(json.dumps(["2026-01-01T00:00:00+00:00", key]).encode()).decode()
    answer = client.get(f"/api/v1/missions/{mission.pk}/events?cursor={cursor}")
    assert (answer.status_code, answer.json()["error"]["code"]) == (400, "invalid_cursor")


def test_reports_in_one_batch_and_late_ones_tell_the_same(client, mission, tern):
    begin = timezone.now()
    reported = [
        NewRecord(
            tern.pk, LinkKind.MAVLINK, "boot", second, begin + timedelta(seconds=second), begin + timedelta(seconds=9),
            Measurement(is_in_air=second in (2, 3, 4)),
        )
        for second in range(8)
    ]  # fmt: skip
    store_records(reported[5:] + reported[:5])
    assert [kind for (kind,) in FlightEvent.objects.order_by("at").values_list("kind")] == ["take-off", "landing"]


def test_a_landing_that_is_stored_after_its_mission_has_ended_belongs_to_it(client, mission, tern):
    report(tern, 0, is_in_air=False)
    report(tern, 1, is_in_air=True)
    mark_started(mission_id=mission.pk, uav_id=tern.pk)
    mark_flight_ended(mission_id=mission.pk, uav_id=tern.pk, flight=1, end=FlightEnd.FLOWN)
    report(tern, 2, is_in_air=True)  # it comes down after its last waypoint
    report(tern, 3, is_in_air=False)
    assert len(of_kind(client, mission, "landing")) == 1
    assert [event["values"]["state"] for event in of_kind(client, mission, "mission-ended")] == ["completed"]


def test_a_uav_that_flies_for_no_mission_is_in_no_log(tern, mission):
    Mission.objects.filter(pk=mission.pk).update(state=MissionState.PLANNED)
    report(tern, 0, is_in_air=False)
    report(tern, 1, is_in_air=True)
    report(tern, 2, is_in_air=False)
    assert not FlightEvent.objects.exists()


def test_commands_are_told_step_by_step_and_who_gave_them(client, mission, tern, person):
    command_uav(uav=tern, kind=CommandKind.START, actor=person, why="Weather is fine")
    carry(tern)
    reported = [event for event in events(client, mission) if event["values"].get("command_kind") == "start"]
    assert [event["kind"] for event in reported] == ["command-done", "command-sent", "command-given"]
    assert (reported[-1]["who"], reported[0]["who"]) == ("Ada Marsh", None)
    assert reported[-1]["message"] == "Tern: Start the mission, given by Ada Marsh: Weather is fine"
    uploads = [event["kind"] for event in events(client, mission) if event["values"].get("command_kind") == "upload-mission"]
    assert uploads == ["command-done", "command-sent", "command-given"]


def test_an_alert_is_opened_raised_acknowledged_and_resolved(client, mission, tern, person):
    about = {"uav": tern, "code": "link-lost", "message": LATE, "mission": mission}
    open_alert(level=AlertLevel.WARNING, values={"uav": "Tern", "seconds": 12}, **about)
    alert = open_alert(level=AlertLevel.CRITICAL, values={"uav": "Tern", "seconds": 30}, **about)
    acknowledge_alert(alert=alert, actor=person)
    close_alert(uav=tern, code="link-lost")
    reported = [event for event in events(client, mission) if event["kind"].startswith("alert-")]
    assert [(event["kind"], event["level"], event["who"]) for event in reported] == [
        ("alert-resolved", None, None),
        ("alert-acknowledged", None, "Ada Marsh"),
        ("alert-raised", "critical", None),
        ("alert-opened", "warning", None),
    ]
    assert reported[0]["message"] == "Resolved: Tern: no telemetry for 30 s."
    german = [event for event in events(client, mission, language="de") if event["kind"] == "alert-resolved"]
    assert german[0]["message"] == reported[0]["message"]
    assert german[0]["values"]["message"] != reported[0]["values"]["message"]


def test_targets_the_mission_and_a_crash_are_told(client, mission, tern):
    mark_started(mission_id=mission.pk, uav_id=tern.pk)
    mark_target(mission_id=mission.pk, target=0, state=TargetState.FAILED)
    VehicleText.objects.create(uav=tern, severity=2, text="Crash: Disarming", received_at=timezone.now() + timedelta(seconds=1))
    VehicleText.objects.create(uav=tern, severity=2, text="Crash: long ago", received_at=timezone.now() - timedelta(hours=1))
    Mission.objects.filter(pk=mission.pk).update(ended_at=timezone.now() + timedelta(seconds=2))
    assert [event["message"] for event in of_kind(client, mission, "crash")] == ["Tern has crashed: Crash: Disarming"]
    assert len(of_kind(client, mission, "mission-started")) == 1
    (approved,) = of_kind(client, mission, "mission-approved")
    assert approved["who"] == "Ada Marsh"
    (failed,) = of_kind(client, mission, "target-failed")
    assert failed["values"]["target"] == 0


def test_a_uav_drops_out_once_and_offers_that_are_worked_out_again_are_not_told(client, mission, tern, person):
    mark_started(mission_id=mission.pk, uav_id=tern.pk)
    suggest(mission_id=mission.pk, code="uav-out", cause={"uav": tern.pk, "alert": "link-lost"})
    later = timezone.now() + timedelta(minutes=10)
    assert settle_offers(now=later) == 1
    assert mission.replan_offers.count() == 2
    (out,) = of_kind(client, mission, "drop-out")
    assert (out["uav"]["name"], out["values"], out["message"]) == ("Tern", {"cause": "link-lost"}, "Tern has dropped out")
    (made,) = of_kind(client, mission, "offer-made")
    assert made["values"]["code"] == "uav-out"
    assert of_kind(client, mission, "offer-expired") == []
    decline_offer(offer=mission.replan_offers.get(state="computing"), actor=person)
    (declined,) = of_kind(client, mission, "offer-declined")
    assert declined["who"] == "Ada Marsh"
    post(client, f"missions/{mission.pk}/replan-offers")
    Mission.objects.filter(pk=mission.pk).update(state=MissionState.COMPLETED)
    assert settle_offers(now=later) == 1
    assert len(of_kind(client, mission, "offer-expired")) == 1
    assert len(of_kind(client, mission, "offer-made")) == 2


def test_the_log_is_paged_newest_first_without_a_gap(client, mission, tern, person):
    for number in range(4):
        open_alert(uav=tern, level=AlertLevel.WARNING, code=f"code-{number}", message="Same", mission=mission)
    mission.alerts.update(opened_at=timezone.now())  # equal times, too
    whole = events(client, mission)
    assert [event["at"] for event in whole] == sorted((event["at"] for event in whole), reverse=True)
    assert len({event["key"] for event in whole}) == len(whole)
    paged, address = [], f"/api/v1/missions/{mission.pk}/events?limit=3"
    while address:
        page = client.get(address).json()
        paged += page["results"]
        address = page["next"]
    assert [event["key"] for event in paged] == [event["key"] for event in whole]
    for wrong in ("x", "WzFd", "WyJ5ZXN0ZXJkYXkiLCJrIl0"):
        assert client.get(f"/api/v1/missions/{mission.pk}/events?cursor={wrong}").status_code == 400


def test_rows_that_go_while_a_page_is_read_do_not_end_the_log(client, mission, tern, monkeypatch):
    for number in range(4):
        open_alert(uav=tern, level=AlertLevel.WARNING, code=f"code-{number}", message="Same", mission=mission)
    whole = events(client, mission)
    newest = mission.alerts.order_by("-opened_at").values_list("pk", flat=True)[0]
    (read,) = [source.read for source in telemetry_events.SOURCES if source.name == "alert"]

    def reads_too_late(places):
        mission.alerts.filter(pk=newest).delete()
        return read(places)

    sources = [replace(source, read=reads_too_late) if source.name == "alert" else source for source in telemetry_events.SOURCES]
    monkeypatch.setattr(telemetry_events, "SOURCES", sources)
    page = client.get(f"/api/v1/missions/{mission.pk}/events?limit=2").json()
    assert [event["key"] for event in page["results"]] == [whole[1]["key"]]
    rest = client.get(page["next"]).json()["results"]
    assert rest[0]["key"] == whole[2]["key"]


def test_as_many_queries_for_many_events_as_for_few(client, mission, tern):
    def queries() -> int:
        with CaptureQueriesContext(connection) as found:
            events(client, mission)
        return len(found)

    open_alert(uav=tern, level=AlertLevel.WARNING, code="first", message="Same", mission=mission)
    queries()
    few = queries()
    for number in range(20):
        open_alert(uav=tern, level=AlertLevel.WARNING, code=f"code-{number}", message="Same", mission=mission)
    assert queries() == few


def test_viewers_read_it_and_others_organisations_do_not(client, mission):
    assert client_of(a_user(Role.VIEWER)).get(f"/api/v1/missions/{mission.pk}/events").status_code == 200
    stranger = client_of(a_user(Role.ADMINISTRATOR, organisation=Organisation.objects.create(name="Others")))
    assert stranger.get(f"/api/v1/missions/{mission.pk}/events").status_code == 404
    assert stranger.get("/api/v1/live/events").json()["results"] == []
    assert Client().get(f"/api/v1/missions/{mission.pk}/events").status_code == 401
    live = client.get("/api/v1/live/events").json()["results"]
    assert {event["mission"] for event in live} == {str(mission.pk)}
    Mission.objects.filter(pk=mission.pk).update(deleted_at=timezone.now())
    assert client.get(f"/api/v1/missions/{mission.pk}/events").status_code == 404
