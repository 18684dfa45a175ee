"""A mission is rehearsed by a worker: flown whole, judged, kept; what belongs to another plan says nothing of this one."""

import pytest

from missions.models import Mission
from simulation.models import Rehearsal
from tests.missions.flights import an_operator, fleet, ground, planned
from tests.missions.worlds import World, world
from tests.simulation.rehearsed import rehearsed
from workspace.models import JobState, User

pytestmark = pytest.mark.django_db


@pytest.fixture
def person() -> User:
    return an_operator()


@pytest.fixture
def here(tmp_path) -> World:
    found = world()
    ground(tmp_path / "ground.tif")
    return found


@pytest.fixture
def mission(here: World, person: User) -> Mission:
    return planned(person, fleet("Tern", "Gull"), [here.towers[0], here.towers[3]])


def test_a_planned_mission_is_flown_and_judged(mission: Mission, person: User) -> None:
    rehearsal = rehearsed(mission, person, "calm")
    run = rehearsal.runs.get()
    import json
    print(json.dumps(run.verdict, indent=1)); print(rehearsal.job.error, rehearsal.uavs, run.took_s)
    assert rehearsal.job.state == JobState.DONE
    assert Rehearsal.objects.get().level == "pass"
