"""A mission of one UAV and three targets that was started, for the tests of its record."""

import pytest
from django.test import Client

from missions.models import Approval, Mission, Uav
from missions.services.commands.flight_progress import mark_started
from tests.accounts.users import a_user, client_of
from tests.missions.flights import an_operator, dispatched, fleet
from tests.missions.worlds import World, world
from workspace.models import Role, User


@pytest.fixture
def here(db: None) -> World:
    return world()


@pytest.fixture
def person(db: None) -> User:
    return an_operator()


@pytest.fixture
def tern(db: None) -> Uav:
    return fleet("Tern")[0]


@pytest.fixture
def mission(here: World, person: User, tern: Uav) -> Mission:
    mission = dispatched(person, [tern], [here.towers[1], here.towers[3], here.bridge])
    mark_started(mission_id=mission.pk, uav_id=tern.pk)
    return mission


@pytest.fixture
def approval(mission: Mission) -> Approval:
    return Approval.objects.get(mission=mission)


@pytest.fixture
def client(db: None) -> Client:
    return client_of(a_user(Role.VIEWER))
