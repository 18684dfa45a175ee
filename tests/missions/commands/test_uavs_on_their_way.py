"""What of a UAV does not change while a mission is on its way to it."""

import pytest

from missions.models import LinkKind
from missions.services import change_uav
from missions.services.commands.dispatch import abort_mission
from missions.services.commands.refused import Refused
from tests.missions.flights import an_operator, carry, dispatched, fleet
from tests.missions.worlds import World
from workspace.models import User

pytestmark = pytest.mark.django_db


@pytest.fixture
def person() -> User:
    return an_operator()


def codes(error: pytest.ExceptionInfo[Refused]) -> list[str]:
    return [reason.code for reason in error.value.reasons]


def test_how_a_uav_is_reached_does_not_change_while_its_mission_is_on_its_way(here: World, person: User) -> None:
    (tern,) = uavs = fleet()
    mission = dispatched(person, uavs, here.towers[1:2])
    carry(tern)
    with pytest.raises(Refused) as error:
        change_uav(uav=tern, actor=person, position=None, values={"link": LinkKind.HTTP})
    assert codes(error) == ["mission_on_its_way"]
    abort_mission(mission=mission, actor=person, why="Storm")
    carry(tern)
    change_uav(uav=tern, actor=person, position=None, values={"link": LinkKind.HTTP})


def test_a_uav_that_flies_is_not_taken_for_a_simulated_one(here: World, person: User) -> None:
    """Else one would stand in for it, under its number and key. That it is real can be said at any time."""
    (tern,) = uavs = fleet(is_simulated=True)
    dispatched(person, uavs, here.towers[1:2])
    change_uav(uav=tern, actor=person, position=None, values={"is_simulated": False})
    with pytest.raises(Refused) as error:
        change_uav(uav=tern, actor=person, position=None, values={"is_simulated": True})
    assert codes(error) == ["commands_waiting"]
    carry(tern)
    with pytest.raises(Refused) as error:
        change_uav(uav=tern, actor=person, position=None, values={"is_simulated": True})
    assert codes(error) == ["mission_on_its_way"]
    tern.refresh_from_db()
    assert not tern.is_simulated
