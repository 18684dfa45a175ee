"""Texts of the planner's reasons in the user's language."""

from typing import Any

import pytest
from django.test import Client
from django.utils.translation import override

from missions.models import InspectionTarget
from missions.reason_texts import plan_with_texts
from operation.reasons import Reason
from tests.accounts.users import a_user, client_of
from tests.missions.api import mission_body, plan_body, post
from tests.missions.worlds import world
from workspace.models import Role
from workspace.reason_texts import reason_text, why_text

BEYOND = Reason(
    "beyond_range", {"needed_m": 93_100.0, "there": Reason("there_and_back"), "missing_m": 850.0, "uav": "Kite", "minutes": 46.0}
)
OTHERS = Reason(
    "other_uavs",
    {
        "limits": [
            Reason("no_permitted_route", {"uavs": ["Tern (old)", "Owl", "Heron", "Gull"]}),
            Reason("battery_too_small_of", {"uavs": ["Rook"]}),
        ]
    },
)


def test_figures_names_and_minutes_are_put_in_in_english() -> None:
    assert str(BEYOND) == "It is 93.1 km there and back, 850 m more than the range of Kite: 46.0 min of flight."
    assert str(OTHERS) == "Other UAVs: no permitted route (Tern (old), Owl, Heron +1); battery too small (Rook)."


def test_they_are_in_german_with_german_figures() -> None:
    with override("de"):
        assert reason_text(BEYOND) == "Es sind 93,1 km hin und zurück, 850 m mehr als die Reichweite von Kite: 46,0 min Flug."
        assert reason_text(OTHERS).startswith("Andere UAVs: keine zulässige Route (Tern (old), Owl, Heron +1); Akku zu klein")
        assert "Kite oder Tern" in reason_text(Reason("battery_too_small", {"any_uav": ["Kite", "Tern"]}))


@pytest.mark.parametrize("damage", [[{"code": "unheard_of", "params": {}}], [{"code": "beyond_range", "params": {}}], [{}], [3]])
def test_a_stored_reason_that_cannot_be_read_leaves_the_stored_text(damage: list[Any]) -> None:
    assert why_text(damage, "As it was stored.") == "As it was stored."


def test_a_plan_is_left_alone_in_english() -> None:
    plan: dict[str, Any] = {"warnings": [], "unassigned": [{"message": "…", "why": []}]}
    with override("en"):
        assert plan_with_texts(plan) is plan


@pytest.mark.django_db
def test_a_plan_and_a_stored_mission_are_read_in_german_and_stored_in_english() -> None:
    here = world()
    client: Client = client_of(a_user(Role.OPERATOR))
    far = {"position": [10.0, 57.0]}
    plan = post(client, "plans", plan_body(here.towers[2], far), **{"Accept-Language": "de"}).json()
    assert plan["unassigned"][0]["message"] == "Es liegt mehr als 10 km vom Netz entfernt."
    mission = post(client, "missions", mission_body(here.towers[2], far, plan=True)).json()
    row = InspectionTarget.objects.get(mission=mission["id"], sequence=1)
    assert row.unassigned_message == "It is more than 10 km from the network."
    shown = client.get(f"/api/v1/missions/{mission['id']}", headers={"Accept-Language": "de"}).json()
    assert shown["plan"]["unassigned"][0]["message"] == plan["unassigned"][0]["message"]
    assert shown["plan"]["unassigned"][0]["why"] == plan["unassigned"][0]["why"]
