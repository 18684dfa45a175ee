"""Offers of another plan by the API: who may ask, see and decide, and what they are told."""

import json
from typing import Any

import pytest
from django.test import Client

from missions import tasks
from missions.models import MissionState, OfferState, ReplanOffer
from missions.services.commands.flight_progress import FlightEnd, mark_flight_ended
from missions.services.replanning import suggest
from missions.tasks import look_after_offers, replan_mission
from tests.accounts.users import a_user, client_of
from tests.missions.flights import ground
from tests.missions.replanning.in_flight import Flight, two_in_the_air
from workspace.models import Organisation, Role

pytestmark = pytest.mark.django_db


@pytest.fixture
def flight(tmp_path) -> Flight:
    ground(tmp_path / "hill.tif", 100.0)
    return two_in_the_air(a_user())


def post(client: Client, path: str, **headers: str) -> Any:
    return client.post(f"/api/v1{path}", content_type="application/json", headers={"If-Match": "*"} | headers)


def offers_of(client: Client, flight: Flight) -> list[dict[str, Any]]:
    answer = client.get(f"/api/v1/missions/{flight.mission.pk}/replan-offers")
    assert answer.status_code == 200, answer.content
    return json.loads(answer.content)["results"]


def open_offer(client: Client, flight: Flight) -> dict[str, Any]:
    mark_flight_ended(mission_id=flight.mission.pk, uav_id=flight.uavs[0].pk, flight=1, end=FlightEnd.FAILED)
    asked = post(client, f"/missions/{flight.mission.pk}/replan-offers")
    assert asked.status_code == 202, asked.content
    assert asked.json()["job"] in asked.headers["Location"]
    replan_mission(asked.json()["job"])
    (offer,) = offers_of(client, flight)
    assert offer["id"] == asked.json()["offer"]
    return offer


def test_an_offer_is_asked_for_seen_and_accepted(flight):
    client = client_of(flight.author)
    offer = open_offer(client, flight)
    assert (offer["state"], offer["revision"]) == ("open", 2), offer["outcome"]
    assert set(offer["difference"]) == {"computed_at", "valid_until", "departs_at", "uavs", "targets", "unreached", "total"}
    plan = client.get(f"/api/v1/missions/{offer['continuation']}").json()
    assert plan["state"] == MissionState.PLANNED
    accepted = post(client, f"/replan-offers/{offer['id']}/accept", **{"If-Match": '"2"'})
    assert (accepted.status_code, accepted.json()["state"]) == (200, "accepted"), accepted.content
    assert accepted.headers["ETag"] == '"3"'
    assert client.get(f"/api/v1/replan-offers/{offer['id']}").json()["decided_by"] == flight.author.username
    assert client.get(f"/api/v1/missions/{offer['continuation']}").json()["state"] == MissionState.DISPATCHED


def test_an_offer_is_declined_and_another_one_is_asked_for(flight):
    client = client_of(flight.author)
    offer = open_offer(client, flight)
    assert post(client, f"/replan-offers/{offer['id']}/decline").json()["state"] == "declined"
    assert post(client, f"/replan-offers/{offer['id']}/accept").status_code == 409
    assert post(client, f"/missions/{flight.mission.pk}/replan-offers").status_code == 202


def test_an_accept_is_done_once_for_each_key(flight):
    client = client_of(flight.author)
    offer = open_offer(client, flight)
    answers = [post(client, f"/replan-offers/{offer['id']}/accept", **{"Idempotency-Key": "one"}) for _ in range(2)]
    assert [answer.status_code for answer in answers] == [200, 200]
    assert answers[1].headers["Idempotency-Replayed"] == "true"
    assert flight.uavs[1].commands.filter(kind="hold").count() == 1


def test_who_has_seen_an_earlier_state_of_the_offer_is_told(flight):
    client = client_of(flight.author)
    offer = open_offer(client, flight)
    assert post(client, f"/replan-offers/{offer['id']}/accept", **{"If-Match": '"1"'}).status_code == 412
    assert ReplanOffer.objects.get().state == OfferState.OPEN


def test_only_operators_ask_and_decide(flight):
    offer = open_offer(client_of(flight.author), flight)
    for role, may in ((Role.VIEWER, False), (Role.CURATOR, False), (Role.ADMINISTRATOR, True)):
        client = client_of(a_user(role))
        assert offers_of(client, flight)
        for path in (f"/missions/{flight.mission.pk}/replan-offers", f"/replan-offers/{offer['id']}/decline"):
            assert post(client, path).status_code in ((200, 202, 409) if may else (403,))  # asked for again, the first is outdated
    anonymous = Client()
    assert anonymous.get(f"/api/v1/replan-offers/{offer['id']}").status_code in (401, 403)
    stranger = client_of(a_user(organisation=Organisation.objects.create(name="Elsewhere")))
    assert stranger.get(f"/api/v1/replan-offers/{offer['id']}").status_code == 404
    assert post(stranger, f"/replan-offers/{offer['id']}/accept").status_code == 404
    assert post(stranger, f"/missions/{flight.mission.pk}/replan-offers").status_code == 404


def test_the_rest_of_a_mission_that_does_not_fly_is_not_planned_again(flight):
    flight.mission.state = MissionState.PLANNED
    flight.mission.save()
    answer = post(client_of(flight.author), f"/missions/{flight.mission.pk}/replan-offers")
    assert (answer.status_code, answer.json()["error"]["code"]) == (409, "not_flying")


def test_what_services_have_suggested_is_sent_to_the_planners(flight, monkeypatch):
    sent = []
    monkeypatch.setattr(tasks, "send_job", lambda job: sent.append(job.task))
    suggest(mission_id=flight.mission.pk, code="uav-out", cause={"uav": flight.uavs[0].pk})
    look_after_offers()
    assert sent == ["missions.tasks.replan_mission"]
