"""Approving, sending, aborting and commanding over the API."""

from typing import Any

import pytest
from django.http import HttpResponse
from django.test import Client

from missions.models import Mission, Uav, UavCommand
from missions.services.commands.commands import is_wanted, note_failed, note_released, note_sent, note_sent_unacknowledged
from tests.accounts.users import a_user, client_of
from tests.missions.api import patch, post
from tests.missions.commands.outbox import a_uav, claim, fence
from tests.missions.flights import approved, carry, dispatched, fleet, planned
from tests.missions.worlds import World
from workspace.models import Organisation, Role, User

pytestmark = pytest.mark.django_db


@pytest.fixture
def person() -> User:
    return a_user()


@pytest.fixture
def client(person: User) -> Client:
    return client_of(person)


def get(client: Client, path: str) -> HttpResponse:
    return client.get(f"/api/v1/{path}")


def error(answer: HttpResponse, status: int) -> dict[str, Any]:
    assert answer.status_code == status, answer.content
    return answer.json()["error"]


def test_a_mission_from_its_plan_to_its_upload(client: Client, here: World, person: User) -> None:
    uavs = fleet("Tern", "Kite")
    mission = planned(person, uavs, here.towers[1:3])
    path = f"missions/{mission.pk}"
    shown = get(client, path).json()
    assert shown["approval"] is None

    answer = post(client, f"{path}/approve", **{"If-Match": f'"{mission.revision}"'})
    body = answer.json()
    assert (answer.status_code, body["state"]) == (200, "approved")
    assert answer["ETag"] == f'"{body["revision"]}"'
    assert body["approval"]["approved_by"] == person.username
    assert error(patch(client, path, {"name": "Other"}), 409)["code"] == "mission_frozen"

    document = get(client, f"{path}/approval").json()
    assert document["content_sha256"] == body["approval"]["content_sha256"]
    assert [route["name"] for route in document["document"]["routes"]] == ["Tern", "Kite"]

    sent = post(client, f"{path}/dispatch", {"why": "Go"})
    assert (sent.status_code, sent.json()["state"]) == (200, "dispatched")
    commands = sent.json()["commands"]
    assert [(command["uav"]["name"], command["kind"], command["state"], command["why"]) for command in commands] == [
        ("Tern", "upload-mission", "queued", "Go"), ("Kite", "upload-mission", "queued", "Go"),
    ]  # fmt: skip
    carry(*uavs)
    listed = get(client, f"{path}/commands").json()["results"]
    assert {command["state"] for command in listed} == {"applied"}
    detail = get(client, f"commands/{commands[0]['id']}").json()
    assert [(event["state"], event["attempt"]) for event in detail["events"]] == [("queued", 0), ("sent", 1), ("applied", 1)]

    started = post(client, f"uavs/{uavs[0].pk}/commands", {"kind": "start"})
    assert started.status_code == 201
    carry(uavs[0])
    assert get(client, path).json()["state"] == "active"
    aborted = post(client, f"{path}/abort", {"why": "Storm"}).json()
    assert (aborted["state"], [command["kind"] for command in aborted["commands"]]) == ("aborted", ["abort", "abort"])
    actions = [entry["action"] for entry in get(client, f"{path}/history").json()["results"]]
    assert actions[:4] == ["abort", "start", "dispatch", "approve"]


def test_every_reason_against_an_approval_is_told(client: Client, here: World, person: User) -> None:
    mission = planned(person, fleet("Tern", "Kite", is_simulated=False), here.towers[1:3])
    fault = error(post(client, f"missions/{mission.pk}/approve"), 409)
    assert fault["code"] == "flat_ground"
    assert [(reason["code"], reason["uav"]) for reason in fault["details"]["reasons"]] == [("flat_ground", 0), ("flat_ground", 1)]
    assert "Tern would fly as over flat ground" in fault["message"]


def test_a_plan_that_reaches_no_target_is_not_approved(client: Client, here: World, person: User) -> None:
    mission = planned(person, fleet("Tern", "Kite"), here.towers[1:3])
    asked = get(client, f"missions/{mission.pk}").json()["uavs"]
    uavs = [{"name": uav["name"], "position": uav["position"], "max_range_m": 20.0} for uav in asked]
    shown = patch(client, f"missions/{mission.pk}", {"uavs": uavs, "plan": True}).json()
    assert (shown["state"], len(shown["plan"]["unassigned"])) == ("planned", 2)
    fault = error(post(client, f"missions/{mission.pk}/approve"), 409)
    assert (fault["code"], fault["message"]) == ("no_routes", "The plan reaches no target, so no UAV flies.")


def test_what_was_not_seen_is_not_approved(client: Client, here: World, person: User) -> None:
    mission = planned(person, fleet(), here.towers[:2])
    assert error(post(client, f"missions/{mission.pk}/approve", **{"If-Match": '"1"'}), 412)["code"] == "mission_changed"
    assert error(post(client, f"missions/{mission.pk}/approve", **{"If-Match": "nonsense"}), 412)["code"] == "mission_changed"


def test_an_approval_may_ask_for_points_on_long_legs(client: Client, here: World, person: User) -> None:
    mission = planned(person, fleet(), here.towers[:2])
    for body in ({"longest_leg_m": 49}, {"longest_leg_m": 5001}, {"longest_leg_m": "far"}, {"longest_leg": 900}):
        assert list(error(post(client, f"missions/{mission.pk}/approve", body), 400)["details"]) == list(body)
    assert post(client, f"missions/{mission.pk}/approve", {"longest_leg_m": 60}).status_code == 200
    assert get(client, f"missions/{mission.pk}/approval").json()["document"]["longest_leg_m"] == 60
    (entry, *_) = get(client, f"missions/{mission.pk}/history").json()["results"]
    assert entry["action"] == "approve"


def test_revoking_needs_a_reason_which_is_kept(client: Client, here: World, person: User) -> None:
    mission, _approval = approved(person, fleet(), here.towers[:2])
    assert error(post(client, f"missions/{mission.pk}/revoke"), 400)["details"] == {"reason": ["This field is required."]}
    body = post(client, f"missions/{mission.pk}/revoke", {"reason": "Wrong day"}).json()
    assert (body["state"], body["approval"]) == ("planned", None)
    assert get(client, f"missions/{mission.pk}/approval").status_code == 404


def test_a_revocation_that_waits_says_so(client: Client, here: World, person: User) -> None:
    (tern,) = uavs = fleet()
    mission = dispatched(person, uavs, here.towers[:2])
    carry(tern)
    body = post(client, f"missions/{mission.pk}/revoke", {"reason": "Wrong day"}).json()
    assert (body["state"], body["approval"]["revoke_reason"]) == ("dispatched", "Wrong day")
    assert body["approval"]["revoke_requested_at"] is not None
    assert body["approval"]["revoke_requested_by"] == person.username


def test_the_same_request_again_does_nothing_twice(client: Client, here: World, person: User) -> None:
    (tern,) = uavs = fleet()
    mission, _approval = approved(person, uavs, here.towers[:2])
    for path, body in ((f"missions/{mission.pk}/dispatch", {}), (f"uavs/{tern.pk}/commands", {"kind": "hold"})):
        first, second = (post(client, path, body, **{"Idempotency-Key": path}) for _ in range(2))
        assert first.json() == second.json()
        assert second["Idempotency-Replayed"] == "true"
    assert UavCommand.objects.count() == 2


@pytest.mark.parametrize("role", [Role.VIEWER, Role.CURATOR])
def test_others_look_and_do_nothing(here: World, person: User, role: Role) -> None:
    (tern,) = uavs = fleet()
    mission = dispatched(person, uavs, here.towers[:2])
    looker = client_of(a_user(role))
    for path in ("approve", "revoke", "dispatch", "abort"):
        assert post(looker, f"missions/{mission.pk}/{path}", {"reason": "x"}).status_code == 403
    assert post(looker, f"uavs/{tern.pk}/commands", {"kind": "hold"}).status_code == 403
    for path in (f"missions/{mission.pk}/approval", f"missions/{mission.pk}/commands", f"uavs/{tern.pk}/commands"):
        assert get(looker, path).status_code == 200
    assert UavCommand.objects.filter(kind="hold").count() == 0


def test_other_organisations_find_nothing(here: World, person: User) -> None:
    (tern,) = uavs = fleet()
    mission = dispatched(person, uavs, here.towers[:2])
    stranger = client_of(a_user(organisation=Organisation.objects.create(name="Other")))
    for path in ("approve", "revoke", "dispatch", "abort"):
        assert post(stranger, f"missions/{mission.pk}/{path}", {"reason": "x"}).status_code == 404
    assert post(stranger, f"uavs/{tern.pk}/commands", {"kind": "hold"}).status_code == 404
    command = mission.commands.get()
    for path in (
        f"missions/{mission.pk}/approval", f"missions/{mission.pk}/commands", f"uavs/{tern.pk}/commands", f"commands/{command.pk}",
    ):  # fmt: skip
        assert get(stranger, path).status_code == 404
    assert Mission.objects.get(pk=mission.pk).state == "dispatched"


@pytest.mark.parametrize(
    ("body", "place"),
    [
        ({}, "kind"),
        ({"kind": "dance"}, "kind"),
        ({"kind": "hold", "whi": "x"}, "whi"),
        ({"kind": "hold", "why": "x" * 301}, "why"),
        ({"kind": "change-speed", "parameters": {"speed_kmh": 30}}, "parameters.speed_kmh"),
        ({"kind": "change-speed", "parameters": {"speed_mps": "fast"}}, "parameters.speed_mps"),
    ],
)
def test_a_command_that_cannot_be_read_is_told_where(client: Client, body: dict, place: str) -> None:
    fault = error(post(client, f"uavs/{a_uav().pk}/commands", body), 400)
    assert list(fault["details"]) == [place]


def test_a_speed_beyond_the_types_limits_is_refused(client: Client) -> None:
    tern = a_uav("Tern", max_airspeed_mps=11.0)
    fault = error(post(client, f"uavs/{tern.pk}/commands", {"kind": "change-speed", "parameters": {"speed_mps": 20}}), 409)
    assert (fault["code"], "from 0.5 to 11 m/s" in fault["message"]) == ("out_of_range", True)
    answer = post(client, f"uavs/{tern.pk}/commands", {"kind": "change-speed", "parameters": {"speed_mps": 7}})
    assert answer.json()["parameters"] == {"speed_mps": 7.0}
    assert answer["Location"] == f"/api/v1/commands/{answer.json()['id']}"


@pytest.mark.parametrize("body", [{"flight": 2}, {"uav": -1}, {"uav": "x"}, {"flights": 1}])
def test_a_dispatch_that_cannot_be_read_is_refused(client: Client, here: World, person: User, body: dict) -> None:
    mission, _approval = approved(person, fleet(), here.towers[:2])
    assert post(client, f"missions/{mission.pk}/dispatch", body).status_code == 400


def test_a_uav_out_of_the_mission_is_refused(client: Client, here: World, person: User) -> None:
    mission, _approval = approved(person, fleet(), here.towers[:2])
    assert error(post(client, f"missions/{mission.pk}/dispatch", {"uav": 3}), 409)["code"] == "no_route"
    assert error(post(client, f"missions/{mission.pk}/dispatch", {"uav": 0, "flight": 2}), 409)["code"] == "no_flight"


def test_what_became_of_a_command_is_said_in_words(client: Client) -> None:
    tern: Uav = a_uav("Tern")
    post(client, f"uavs/{tern.pk}/commands", {"kind": "pause"})
    post(client, f"uavs/{tern.pk}/commands", {"kind": "hold"})
    (held,) = claim(tern)
    note_failed(held.pk, "denied", "The UAV refused it.", **fence(held))
    hold, pause = get(client, f"uavs/{tern.pk}/commands").json()["results"]
    assert (pause["state"], pause["outcome_code"], pause["outcome"]) == ("expired", "superseded", "A later command took its place: Hold.")
    assert (hold["state"], hold["priority"], hold["outcome"]) == ("failed", "safety", "The UAV refused it.")
    german = client.get(f"/api/v1/uavs/{tern.pk}/commands", headers={"Accept-Language": "de"}).json()["results"]
    assert german[1]["outcome"] == "Ein späterer Befehl trat an seine Stelle: Anhalten."


def test_a_command_that_is_sent_unheard_says_so_until_its_uav_is_heard(client: Client) -> None:
    tern: Uav = a_uav("Tern")

    def reported() -> tuple[str, str, bool]:
        (command,) = get(client, f"uavs/{tern.pk}/commands").json()["results"]
        return command["state"], command["outcome_code"], "nothing is heard" in command["outcome"]

    post(client, f"uavs/{tern.pk}/commands", {"kind": "return"})
    (command,) = claim(tern)
    assert note_sent_unacknowledged(command.pk, **fence(command)) and is_wanted(command.pk, **fence(command))
    assert reported() == ("sent", "unheard", True)
    note_released(command.pk, **fence(command))
    (command,) = claim(tern)
    note_sent(command.pk, **fence(command))
    assert reported() == ("sent", "", False)
    UavCommand.objects.update(expires_at=command.created_at)
    assert not is_wanted(command.pk, **fence(command)) and not note_sent_unacknowledged(command.pk, **fence(command))


def test_another_link_is_refused_in_words_while_a_command_waits(client: Client) -> None:
    tern = a_uav("Tern")
    post(client, f"uavs/{tern.pk}/commands", {"kind": "hold"})
    problem = error(patch(client, f"uavs/{tern.pk}", {"link": "http"}, **{"If-Match": "*"}), 409)
    assert problem["code"] == "commands_waiting"
    assert "Tern" in problem["message"]


def test_only_administrators_say_that_a_uav_is_simulated_or_needs_no_signature(client: Client) -> None:
    tern = a_uav("Tern")
    for name in ("is_simulated", "allows_unsigned"):
        assert error(patch(client, f"uavs/{tern.pk}", {name: True}, **{"If-Match": "*"}), 403)["code"] == "permission_denied"
        assert patch(client, f"uavs/{tern.pk}", {name: False, "link": "http"}, **{"If-Match": "*"}).status_code == 200
        changed = patch(client_of(a_user(Role.ADMINISTRATOR)), f"uavs/{tern.pk}", {name: True}, **{"If-Match": "*"})
        assert changed.json()["properties"][name] is True
    tern.refresh_from_db()
    assert (tern.is_simulated, tern.allows_unsigned, tern.link) == (True, True, "http")
