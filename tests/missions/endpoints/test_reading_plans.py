"""A serializer whose fields are made once in a thread reads each body as a new one does."""

import random
from typing import Any

import pytest
from django.utils import translation
from rest_framework.exceptions import ValidationError

from missions.serializers.inputs import PlanInputSerializer
from planning.problem import Objective
from tests.accounts.users import a_user
from tests.missions.api import TERN, plan_body

pytestmark = pytest.mark.django_db

ODD: list[Any] = [
    None, True, False, 0, 1, -1, 3, 12, 2**63 - 1, 2**63, 2**70, 0.0, -0.0, 0.5, 1e-320, 99.9, 100, 100.5, 1e7, 1.1e7, 3600, 3600.5,
    "", " ", "Tern", " Tern", "T" * 100, "T" * 101, "Mäwe", "a\tb", "total", "makespan", "hover", "return", "land", "hold", "dance",
    [], {}, [10, 56], [10.5, 56.25], [181, 0], [0, 91], [10, True], [10, "56"], [10, 56, 0], [180, -90], [[10, 56], [11, 56]],
    {"kind": "hold"}, {"kind": "photo", "hold_s": 3}, {"kind": "photo", "hold_s": None}, {"kind": "hold", "hold_s": 4e3}, {"kind": "x"},
    {"id": 1}, [TERN], [{}],
]  # fmt: skip
PLACES = ["objective", "return_to_start", "uavs", "targets", "other"]
UAV_FIELDS = ["id", "name", "position", "max_range_m", "cruise_speed_mps", "end_action", "other"]
TARGET_FIELDS = ["asset", "position", "stretch", "task", "other"]


def read_by_a_new_one(body: Any, organisation: Any) -> Any:
    """Values and faults."""
    serializer = PlanInputSerializer(data=body, context={"organisation": organisation})
    return (serializer.validated_data, None) if serializer.is_valid() else (None, serializer.errors)


def read(body: Any, organisation: Any) -> Any:
    try:
        return PlanInputSerializer.read(body, organisation=organisation), None
    except ValidationError as error:
        return None, error.detail


def odd_body(draw: random.Random) -> dict[str, Any]:
    body = plan_body({"asset": 3}, {"position": [10.0, 56.0]}, {"asset": 4, "task": {"kind": "hold", "hold_s": 2}}) | {
        "uavs": [dict(TERN), {"name": "Gull", "position": [10, 56], "max_range_m": 900, "cruise_speed_mps": 8, "end_action": "return"}]
    }
    for _ in range(draw.choice([0, 1, 1, 1, 2])):
        where = draw.random()
        if where < 0.2:
            body[draw.choice(PLACES)] = draw.choice(ODD)
        elif where < 0.6 and isinstance(body["uavs"], list) and body["uavs"] and isinstance(body["uavs"][0], dict):
            body["uavs"][0][draw.choice(UAV_FIELDS)] = draw.choice(ODD)
        elif isinstance(body["targets"], list) and body["targets"] and isinstance(body["targets"][0], dict):
            body["targets"][0][draw.choice(TARGET_FIELDS)] = draw.choice(ODD)
    return body


def test_each_body_is_read_as_by_a_new_serializer() -> None:
    draw, organisation, taken = random.Random(3), a_user().organisation, 0
    for number in range(600):
        body = odd_body(draw)
        with translation.override(("en", "de")[number % 2]):
            found = read(body, organisation)
            assert found == read_by_a_new_one(body, organisation), body
        taken += found[0] is not None
    assert 120 < taken < 480


@pytest.mark.parametrize("body", [None, [], "x", 3, {}, {"uavs": []}])
def test_what_is_no_request_is_refused(body: Any) -> None:
    values, faults = read(body, None)
    assert values is None
    assert faults == read_by_a_new_one(body, None)[1]


def test_nothing_of_a_body_stays_for_the_next() -> None:
    organisation = a_user().organisation
    PlanInputSerializer.read(
        plan_body({"asset": 3}, objective="makespan", return_to_start=True, charging_w=90.0), organisation=organisation
    )
    asked = PlanInputSerializer.read_request({"uavs": [TERN], "targets": [{"asset": 3}]}, organisation)
    assert (asked.objective, asked.return_to_start, asked.charging_w) == (Objective.TOTAL, False, None)
