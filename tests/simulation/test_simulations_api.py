"""Simulated UAVs in real time over the API: who may, what is told, how ground stations are to connect."""

import json
from typing import Any

import pytest
from django.http import HttpResponse
from django.test import Client

from missions.models import CredentialKind, Uav, UavCredential
from simulation.models import Simulation, SimulationChange
from tests.accounts.users import a_user, client_of
from tests.missions.api import patch, post
from tests.missions.flights import approved, fleet
from tests.missions.worlds import world
from tests.simulation.simulations import pool
from workspace.models import Organisation, Role, User

pytestmark = pytest.mark.django_db
HERE = [10.0, 56.0]
MOTOR = {"faults": {"motor_failed": 1}}


@pytest.fixture
def person() -> User:
    return a_user()


@pytest.fixture
def client(person: User) -> Client:
    return client_of(person)


def error(answer: HttpResponse, status: int) -> dict[str, Any]:
    assert answer.status_code == status, answer.content
    return answer.json()["error"]


def test_uavs_of_the_pool_say_how_to_connect(settings, client):
    settings.SIMULATOR_PORTS = "15000-15009"
    body = {"uavs": [{"position": HERE}, {"position": [10.001, 56.0], "name": "Second"}], "lifetime_s": 900, "first_system_id": 11}
    answer = post(client, "simulations", body)
    shown = answer.json()
    assert answer.status_code == 201
    assert client.get(answer["Location"]).json() == shown
    assert (shown["is_simulated"], shown["mission"], shown["state"]) == (True, None, "wanted")
    first, second = shown["vehicles"]
    assert (second["name"], second["system_id"], second["uav"], second["report"]) == ("Second", 12, None, None)
    assert (first["connect"]["protocol"], first["connect"]["host"], first["connect"]["port"]) == ("udp", "127.0.0.1", 15000)
    examples = {example["program"]: example["command"] for example in first["connect"]["examples"]}
    assert examples["MAVSDK"] == "udpout://127.0.0.1:15000"
    assert "--master=udpout:127.0.0.1:15000" in examples["MAVProxy"]
    assert "127.0.0.1:15000" in examples["QGroundControl"]


def test_one_of_several_is_ended_and_is_over_then(client, person):
    simulation = pool(person, 2)
    first, second = simulation.vehicles.all()
    assert client.delete(f"/api/v1/simulated-vehicles/{first.pk}").status_code == 204
    shown = client.get(f"/api/v1/simulations/{simulation.pk}").json()
    assert [(vehicle["state"], vehicle["message"]) for vehicle in shown["vehicles"]] == [("ended", "Somebody ended it."), ("wanted", "")]
    assert error(patch(client, f"simulated-vehicles/{first.pk}", MOTOR), 409)["code"] == "simulation_over"
    viewer = client_of(a_user(Role.VIEWER, person.organisation))
    assert viewer.delete(f"/api/v1/simulated-vehicles/{second.pk}").status_code == 403
    stranger = client_of(a_user(organisation=Organisation.objects.create(name="Others")))
    assert stranger.delete(f"/api/v1/simulated-vehicles/{second.pk}").status_code == 404


def test_a_request_that_is_sent_again_starts_nothing_more(client):
    for _ in range(2):
        answer = post(client, "simulations", {"uavs": [{"position": HERE}]}, **{"Idempotency-Key": "same"})
        assert answer.status_code == 201
    assert Simulation.objects.count() == 1


@pytest.mark.parametrize(
    ("body", "place"),
    [
        ({"uavs": []}, "uavs"),
        ({"uavs": [{"position": [200, 0]}]}, "uavs.0.position"),
        ({"uavs": [{"position": HERE}], "speed": 3}, "speed"),
        ({"uavs": [{"position": HERE}], "airframe": "kite"}, "airframe"),
        ({"uavs": [{"position": HERE}], "lifetime_s": 5}, "lifetime_s"),
        ({"uavs": [{"position": HERE}], "lifetime_s": 86_400}, "lifetime_s"),
        ({"uavs": [{"position": HERE}], "conditions": "hail"}, "conditions"),
        ({"uavs": [{"position": HERE}], "conditions": {"gusts_mps": 90}}, "conditions.gusts_mps"),
        ({"uavs": [{"position": HERE}], "faults": {"motor_failed": 7}}, "faults.motor_failed"),
        ({"uavs": [{"position": HERE}], "faults": {"wings": 1}}, "faults.wings"),
        ({"uavs": [{"position": HERE}] * 2, "first_system_id": 250}, "first_system_id"),
        ({"uavs": [{"position": HERE}], "host": "example"}, "host"),
    ],
)
def test_what_cannot_be_flown_is_told_where_it_stands(client, body, place):
    assert place in error(post(client, "simulations", body), 400)["details"]
    assert not Simulation.objects.exists()


def test_a_uav_of_the_fleet_is_not_of_the_pool_and_the_way_is_told(client):
    (uav,) = fleet("Tern")
    reported = error(post(client, "simulations", {"uavs": [{"position": HERE, "uav": uav.pk}]}), 400)
    assert "start its simulated flight" in json.dumps(reported)


def test_the_quota_is_told(settings, client):
    settings.MAX_SIMULATED_UAVS = 1
    reported = error(post(client, "simulations", {"uavs": [{"position": HERE}] * 2}), 429)
    assert reported["code"] == "too_many_simulated_uavs"
    assert "1" in reported["message"]


def test_a_mission_is_flown_in_simulation_changed_and_ended(client, person):
    mission, _ = approved(person, fleet("Tern"), world().towers[:1])
    path = f"missions/{mission.pk}/simulated-flights"
    answer = post(client, path, {"speed": 10, "conditions": "calm"})
    shown = answer.json()
    assert answer.status_code == 201, shown
    (vehicle,) = shown["vehicles"]
    assert (shown["mission"], shown["speed"]) == (str(mission.pk), 10.0)
    assert (vehicle["uav"]["name"], vehicle["connect"], vehicle["is_simulated"]) == ("Tern", None, True)
    assert error(post(client, path, {}), 409)["code"] == "already_simulated"

    wind = {"wind": [{"altitude_agl_m": 10, "speed_mps": 8, "from_deg": 270}]}
    assert patch(client, f"simulations/{shown['id']}", {"speed": 2}).json()["speed"] == 2.0
    changed = patch(client, f"simulated-vehicles/{vehicle['id']}", {"conditions": wind, **MOTOR}).json()
    assert changed["conditions"]["wind"][0]["speed_mps"] == 8
    assert error(patch(client, f"simulated-vehicles/{vehicle['id']}", {"speed": 5}), 400)["details"]["speed"]
    assert error(patch(client, f"simulated-vehicles/{vehicle['id']}", {}), 400)
    assert list(SimulationChange.objects.values_list("speed", "faults")) == [(2.0, None), (None, {"motor_failed": 1})]

    assert client.get(f"/api/v1/{path}").json()["results"][0]["id"] == shown["id"]
    assert client.delete(f"/api/v1/simulations/{shown['id']}").status_code == 204
    assert client.get(f"/api/v1/{path}").json()["results"] == []
    (over,) = client.get(f"/api/v1/{path}?state=all").json()["results"]
    assert (over["state"], over["reason"]) == ("ended", "ended-by-hand")
    assert error(patch(client, f"simulated-vehicles/{vehicle['id']}", MOTOR), 409)["code"] == "simulation_over"


def test_a_real_uav_is_refused_by_name(client, person):
    mission, _ = approved(person, fleet("Tern"), world().towers[:1])
    Uav.objects.update(is_simulated=False)
    reported = error(post(client, f"missions/{mission.pk}/simulated-flights", {}), 409)
    assert reported["code"] == "real_uav"
    assert reported["details"]["reasons"][0]["message"].startswith("Tern is a real UAV.")


def test_a_key_that_is_made_is_shown_nowhere(client, person):
    mission, _ = approved(person, fleet("Tern"), world().towers[:1])
    shown = post(client, f"missions/{mission.pk}/simulated-flights", {}).json()
    credential = UavCredential.objects.get(kind=CredentialKind.MAVLINK_KEY)
    assert credential.key_salt not in json.dumps(shown)
    assert "key" not in json.dumps(shown)


def test_viewers_see_and_others_organisations_do_not(client, person):
    simulation = pool(person)
    vehicle = simulation.vehicles.first()
    viewer = client_of(a_user(Role.VIEWER))
    assert viewer.get(f"/api/v1/simulations/{simulation.pk}").status_code == 200
    assert len(viewer.get("/api/v1/simulations").json()["results"]) == 1
    assert error(post(viewer, "simulations", {"uavs": [{"position": HERE}]}), 403)
    assert error(patch(viewer, f"simulated-vehicles/{vehicle.pk}", MOTOR), 403)
    assert viewer.delete(f"/api/v1/simulations/{simulation.pk}").status_code == 403

    stranger = client_of(a_user(organisation=Organisation.objects.create(name="Other")))
    assert stranger.get("/api/v1/simulations").json()["results"] == []
    for path in (f"simulations/{simulation.pk}", f"simulated-vehicles/{vehicle.pk}"):
        assert error(stranger.get(f"/api/v1/{path}"), 404)
        assert error(patch(stranger, path, MOTOR), 404)
    assert stranger.delete(f"/api/v1/simulations/{simulation.pk}").status_code == 404
    assert Client().get("/api/v1/simulations").status_code == 401


def test_without_the_demo_region_no_demo_missions_can_be_made() -> None:
    administrator = client_of(a_user(role=Role.ADMINISTRATOR))
    assert administrator.get("/api/v1/demo-data").json() == {"can_be_made": False, "job": None, "missions": 0, "uavs": 0}
    assert administrator.post("/api/v1/demo-data", "{}", content_type="application/json", HTTP_IDEMPOTENCY_KEY="1").status_code == 409
