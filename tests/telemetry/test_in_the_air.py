"""A mission that is planned for a UAV in the air begins with a take-off that is none: its plan says so."""

from datetime import timedelta

import pytest
from django.utils import timezone

from missions.models import Uav
from missions.services import make_plan
from telemetry.models import UavLink
from telemetry.selectors.in_the_air import reported_in_the_air
from tests.missions import worlds
from tests.missions.flights import asked, fleet

pytestmark = pytest.mark.django_db


@pytest.fixture
def uav() -> Uav:
    return fleet("Tern")[0]


def warned(uav: Uav, targets: list) -> list[str]:
    found = make_plan(request=asked([uav], targets))["warnings"]
    return [warning["message"] for warning in found if warning["code"] == "uav_in_air"]


def test_a_plan_for_a_uav_in_the_air_says_that_it_begins_with_a_take_off(uav) -> None:
    targets = worlds.world().towers[:1]
    assert warned(uav, targets) == []
    link = UavLink.objects.create(uav=uav, is_in_air=True, last_message_at=timezone.now())
    (words,) = warned(uav, targets)
    assert words.startswith("Tern is reported to be in the air")
    link.is_in_air = False
    link.save()
    assert warned(uav, targets) == []


def test_what_was_said_long_ago_is_no_sign(uav) -> None:
    UavLink.objects.create(uav=uav, is_in_air=True, last_message_at=timezone.now() - timedelta(hours=1))
    assert reported_in_the_air([uav.pk]) == set()
