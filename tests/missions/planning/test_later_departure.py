"""Whether departing later brings a better plan: after the end of the zone that bars it, and not after others."""

from datetime import UTC, datetime, timedelta
from typing import Any

import pytest
from django.test import Client

from inspection.models import NoFlyZone
from inspection.services import mark_ground_changed
from missions.services.planning.later_departure import better_departure
from planning.problem import Objective
from tests.accounts.users import a_user, client_of
from tests.missions.api import plan_body, post
from tests.missions.planning.test_timed_zones import MONDAY_NOON, timed_zone
from tests.missions.worlds import request, world, zone_around
from workspace.models import Role

pytestmark = pytest.mark.django_db

HOUR = timedelta(hours=1)
MARGIN = timedelta(minutes=5)


def asked(**wishes: Any) -> dict[str, Any]:
    return better_departure(request=request(**wishes), now=MONDAY_NOON)


def at(moment: datetime) -> str:
    return f"{moment:%Y-%m-%dT%H:%M:%SZ}"


def over(number: int, begins: datetime, ends: datetime) -> None:
    """A zone round one of the towers."""
    zone = zone_around((10.0 + 0.004 * number, 56.0), 0.0005, name="Fire brigade", with_graph=False)
    period = {"startDateTime": at(begins), "endDateTime": at(ends), "schedule": []}
    NoFlyZone.objects.filter(pk=zone.pk).update(schedule=[period])
    mark_ground_changed()


def test_a_target_that_a_zone_holds_for_a_while_is_reached_once_that_is_over() -> None:
    here = world()
    over(5, MONDAY_NOON - HOUR, MONDAY_NOON + 3 * HOUR)
    over(0, MONDAY_NOON - HOUR, MONDAY_NOON + HOUR)  # its end changes nothing
    found = better_departure(request=request(here.towers[5], departs_at=MONDAY_NOON), now=MONDAY_NOON)
    assert (found["departs_at"], found["looked_until"]) == (at(MONDAY_NOON + 3 * HOUR + MARGIN),) * 2
    assert (found["before"]["left_out"], found["then"]["left_out"]) == (1, 0)


def test_a_route_round_a_zone_is_quicker_once_that_is_over() -> None:
    here = world()
    timed_zone(MONDAY_NOON - HOUR, MONDAY_NOON + 2 * HOUR, 0.008)
    found = better_departure(request=request(here.towers[5], objective=Objective.MAKESPAN, departs_at=MONDAY_NOON), now=MONDAY_NOON)
    assert found["departs_at"] == at(MONDAY_NOON + 2 * HOUR + MARGIN)
    assert found["then"]["done_s"] < 0.9 * found["before"]["done_s"]


def test_where_nothing_ends_or_nothing_is_better_no_departure_is_told() -> None:
    here = world()
    found = better_departure(request=request(here.towers[5], departs_at=MONDAY_NOON), now=MONDAY_NOON)
    assert (found["departs_at"], found["looked_until"], found["then"]) == (None, None, None)
    zone_around((10.020, 56.0), 0.0005)  # for ever
    over(0, MONDAY_NOON - HOUR, MONDAY_NOON + HOUR)
    found = better_departure(request=request(here.towers[5], departs_at=MONDAY_NOON), now=MONDAY_NOON)
    assert (found["departs_at"], found["looked_until"]) == (None, at(MONDAY_NOON + HOUR + MARGIN))


def test_without_a_departure_now_is_looked_at_first() -> None:
    here = world()
    over(5, MONDAY_NOON + 9 * HOUR, MONDAY_NOON + 10 * HOUR)
    found = better_departure(request=request(here.towers[5]), now=MONDAY_NOON)
    assert (found["departs_at"], found["before"]["left_out"], found["then"]["left_out"]) == (at(MONDAY_NOON), 1, 0)


def test_over_http_it_is_told_of_few_targets_alone() -> None:
    here, client = world(), client_of(a_user(Role.VIEWER))
    soon = datetime.now(UTC).replace(second=0, microsecond=0) + HOUR
    over(5, soon - HOUR, soon + HOUR)
    body = plan_body(here.towers[5]) | {"departs_at": at(soon)}
    found: Client = post(client, "plans/later-departure", body)
    assert found.status_code == 200, found.content
    assert found.json()["departs_at"] == at(soon + HOUR + MARGIN)
    many = plan_body(*[here.towers[0]] * 13) | {"departs_at": at(soon)}
    refused = post(client, "plans/later-departure", many)
    assert refused.status_code == 400
