"""What a UAV's autopilot would refuse is said before its mission is approved."""

import pytest

from missions.models import Mission, MissionState, Uav
from missions.services import TargetRequest
from missions.services.approval.approval import approve_mission
from missions.services.commands.refused import RefusalReason, Refused
from planning.task import Task, TaskKind
from telemetry.models import UavLink
from tests.missions.flights import an_operator, fleet, planned
from tests.missions.worlds import world

pytestmark = pytest.mark.django_db


@pytest.fixture
def uav() -> Uav:
    return fleet("Tern")[0]


@pytest.fixture
def mission(uav) -> Mission:
    photo, look = Task(TaskKind.PHOTO, 10.0), Task(TaskKind.LOOK, 5.0)
    towers = world().towers
    return planned(an_operator(), [uav], [TargetRequest(towers[0].pk, task=photo), TargetRequest(towers[1].pk, task=look)])


def reasons(mission: Mission) -> list[RefusalReason]:
    try:
        approve_mission(mission=mission, actor=mission.author)
    except Refused as refused:
        return list(refused.reasons)
    mission.refresh_from_db()
    assert mission.state == MissionState.APPROVED
    return []


def test_an_item_that_its_firmware_does_not_know_is_named_with_command_and_version(mission, uav):
    UavLink.objects.create(uav=uav, autopilot="ardupilot", firmware="4.3.2", vehicle_type=2)
    (reason,) = reasons(mission)
    assert (reason.code, reason.uav) == ("unknown_items", 0)
    assert reason.message.startswith("ArduPilot 4.3.2 of Tern does not know IMAGE_START_CAPTURE (2000), at waypoint ")


@pytest.mark.parametrize(
    "facts",
    [
        {"autopilot": "ardupilot", "firmware": "4.6.0", "vehicle_type": 2},
        {"autopilot": "ardupilot", "firmware": "", "vehicle_type": None},
        {"autopilot": "px4", "firmware": "1.14.0", "vehicle_type": 13},
        {},
    ],
)
def test_what_is_known_or_not_told_is_no_reason(facts, mission, uav):
    UavLink.objects.create(uav=uav, **facts)
    assert reasons(mission) == []


@pytest.mark.parametrize(
    ("autopilot", "vehicle_type", "kind"), [("ardupilot", 1, "plane"), ("px4", 22, "VTOL"), ("ardupilot", 10, "rover")]
)
def test_a_mission_for_another_kind_of_vehicle_is_not_approved(autopilot, vehicle_type, kind, mission, uav):
    UavLink.objects.create(uav=uav, autopilot=autopilot, vehicle_type=vehicle_type)
    (reason,) = reasons(mission)
    assert (reason.code, reason.message) == ("vehicle_class", f"Tern is a {kind}: Spanwise plans for and commands multicopters only.")
