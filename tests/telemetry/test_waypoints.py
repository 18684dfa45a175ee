"""A record names the waypoint of the approved route, whatever the autopilot calls the item that its list is at."""

from dataclasses import replace

import pytest

from missions.models import Approval, Mission, Uav
from missions.services.commands.dispatch import approved_load
from telemetry.models import TelemetryRecord, UavLink
from telemetry.services import store_records
from tests.missions.flights import an_operator, approved, fleet
from tests.missions.worlds import world
from tests.telemetry.records import at, record

pytestmark = pytest.mark.django_db


@pytest.fixture
def uav() -> Uav:
    return fleet("Tern")[0]


@pytest.fixture
def approval(uav) -> Approval:
    return approved(an_operator(), [uav], world().towers[:2])[1]


def loaded(uav: Uav, approval: Approval, **facts) -> UavLink:
    values = {"autopilot": "px4", "loaded_sha256": "a" * 64, "loaded_approval": approval.pk, "loaded_flight": 1, "loaded_read_at": at(0)}
    return UavLink.objects.create(uav=uav, **{**values, **facts})


def stored(uav: Uav, approval: Approval, items: list[int], **values) -> list[tuple[int | None, int | None]]:
    Mission.objects.filter(pk=approval.mission_id).update(state="active")
    store_records([record(uav, number, mission_item=item, **values) for number, item in enumerate(items, 1)])
    return list(TelemetryRecord.objects.order_by("sequence").values_list("mission_item", "waypoint_sequence"))


@pytest.mark.parametrize(("autopilot", "first"), [("px4", 0), ("ardupilot", 1)])
def test_each_item_is_told_with_its_waypoint(autopilot, first, uav, approval):
    items = approved_load(approval, uav_id=uav.pk, flight=1).load.mission
    waypoints = [item.waypoint for item in items]
    assert len(items) > len(set(waypoints)) > 2  # speeds and tasks are items, too
    loaded(uav, approval, autopilot=autopilot)
    numbers = list(range(len(items) + first + 1))
    assert stored(uav, approval, numbers) == list(zip(numbers, [*[None] * first, *waypoints, None], strict=True))


@pytest.mark.parametrize(
    "facts",
    [
        {"loaded_approval": None, "loaded_flight": None, "loaded_sha256": ""},
        {"loaded_doubt": "other-station"},
        {"loaded_read_at": at(60)},
        {"loaded_flight": 9},
    ],
    ids=["nothing", "doubted", "read later", "no such flight"],
)
def test_an_item_of_a_list_that_is_not_known_has_no_waypoint(facts, uav, approval):
    loaded(uav, approval, **facts)
    assert stored(uav, approval, [1]) == [(1, None)]


def test_an_item_of_one_mission_is_no_waypoint_of_another(uav, approval):
    other, _ = approved(an_operator(), fleet("Kite"), world().towers[2:4])
    loaded(uav, approval)
    store_records([replace(record(uav, 1, mission_item=1), mission_id=other.pk)])
    assert TelemetryRecord.objects.get().waypoint_sequence is None


def test_what_a_companion_says_is_kept(uav, approval):
    loaded(uav, approval)
    assert stored(uav, approval, [0], waypoint_sequence=3) == [(0, 3)]
