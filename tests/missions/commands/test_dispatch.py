"""Sending approved missions to UAVs, flight by flight; aborting; and what telemetry tells of them."""

from datetime import UTC, datetime, timedelta

import pytest
from django.utils import timezone

from mavlink.vehicle_plan import load_to_json
from missions.models import Approval, CommandKind, CommandState, LinkKind, Mission, MissionState, TargetState, Uav, UavState
from missions.services import change_mission, plan_mission
from missions.services.approval.approval import approve_mission, revoke_approval
from missions.services.approval.document import approval_document, content_sha256
from missions.services.commands.commands import note_failed
from missions.services.commands.dispatch import DamagedApproval, abort_mission, dispatch_mission, load_of
from missions.services.commands.flight_progress import FlightEnd, mark_flight_ended, mark_started, mark_target, mark_waypoint_reached
from missions.services.commands.refused import Refused
from missions.services.commands.steering import command_uav
from missions.services.missions import MissionChange
from tests.missions import worlds
from tests.missions.commands.outbox import claim, fence, now
from tests.missions.flights import an_operator, approved, carry, dispatched, fleet, planned
from tests.missions.worlds import World
from workspace.models import AuditEntry, User

pytestmark = pytest.mark.django_db

LATER = datetime(2027, 5, 4, 9, 0, tzinfo=UTC)


@pytest.fixture
def person() -> User:
    return an_operator()


def codes(error: pytest.ExceptionInfo[Refused]) -> list[str]:
    return [reason.code for reason in error.value.reasons]


def refused(mission: Mission, person: User, **which: int) -> list[str]:
    with pytest.raises(Refused) as error:
        dispatch_mission(mission=mission, actor=person, **which)
    return codes(error)


def state(mission: Mission) -> str:
    mission.refresh_from_db()
    return mission.state


def active(person: User, uavs: list[Uav], here: World) -> Mission:
    mission = dispatched(person, uavs, here.towers[1 : 1 + len(uavs)])
    carry(*uavs)
    for uav in uavs:
        command_uav(uav=uav, kind=CommandKind.START, actor=person)
    carry(*uavs)
    return mission


def test_every_uav_is_sent_what_was_approved_for_it(here: World, person: User) -> None:
    uavs = fleet("Tern", "Kite")
    mission, approval = approved(person, uavs, here.towers[1:3])
    commands = dispatch_mission(mission=mission, actor=person, why="Go")
    assert state(mission) == MissionState.DISPATCHED
    assert [(command.uav, command.kind, command.approval_id) for command in commands] == [
        (uav, "upload-mission", approval.pk) for uav in uavs
    ]
    for place, command in enumerate(claim(*uavs)):
        load = load_of(command)
        stored = approval.document["routes"][place]["flights"][0]
        assert load_to_json(load.load) == stored["items"]
        assert load.content_sha256 == load.load.content_sha256 == stored["content_sha256"]
        assert (load.uav, load.flight, load.flights, load.mission) == (command.uav_id, 1, 1, mission.pk)
        assert list(load.take_off.position) == stored["take_off"]["position"]
    entry = AuditEntry.objects.filter(subject_type="mission", subject_id=str(mission.pk)).first()
    assert (entry.action, entry.actor, entry.after["why"]) == ("dispatch", person, "Go")


def test_missions_that_live_pages_show_have_different_call_numbers(here: World, person: User) -> None:
    def sent(name: str) -> Mission:
        mission = dispatched(person, fleet(name), here.towers[1:2])
        mission.refresh_from_db()
        return mission

    first, second = sent("Tern"), sent("Kite")
    assert (first.call_number, second.call_number) == (1, 2)
    abort_mission(mission=first, actor=person, why="")
    assert sent("Crow").call_number == 3  # the first is still shown
    Mission.objects.filter(pk=first.pk).update(ended_at=timezone.now() - timedelta(minutes=61))
    assert sent("Rook").call_number == 1


def test_what_is_sent_never_mixes_two_plans(here: World, person: User) -> None:
    """Revoked, planned otherwise and approved again: an upload that still belongs to the first approval brings the first plan, whole."""
    uavs = fleet("Tern", "Kite")
    mission = dispatched(person, uavs, here.towers[1:3])
    first = claim(*uavs)
    revoke_approval(mission=mission, actor=person, reason="Other order")
    carry(*uavs)
    change_mission(mission=mission, actor=person, change=MissionChange(return_to_start=True))
    plan_mission(mission=Mission.objects.get(pk=mission.pk), actor=person)
    approve_mission(mission=mission, actor=person)
    dispatch_mission(mission=mission, actor=person)
    second = claim(*uavs)
    for commands in (first, second):
        assert len({load_of(command).approval for command in commands}) == 1
    for earlier, later in zip(first, second, strict=True):
        assert load_of(earlier).approval != load_of(later).approval
        document = Approval.objects.get(pk=later.approval_id).document
        assert load_of(later).content_sha256 in {flight["content_sha256"] for route in document["routes"] for flight in route["flights"]}


def test_a_document_that_somebody_changed_is_not_sent(here: World, person: User) -> None:
    uavs = fleet()
    mission = dispatched(person, uavs, here.towers[:2])
    (command,) = claim(*uavs)
    approval = Approval.objects.get(mission=mission)
    approval.document["routes"][0]["flights"][0]["items"]["mission"][1][8] += 50.0
    approval.save()
    command.refresh_from_db()
    with pytest.raises(DamagedApproval):
        load_of(command)
    with pytest.raises(DamagedApproval):
        dispatch_mission(mission=mission, actor=person, place=0)


def test_only_an_approved_mission_is_sent(here: World, person: User) -> None:
    assert refused(planned(person, fleet(), here.towers[:2]), person) == ["not_approved"]


def test_only_uavs_of_the_fleet_are_sent_something(here: World, person: User) -> None:
    mission, _approval = approved(person, fleet(), here.towers[:2])
    approval = Approval.objects.get(mission=mission)
    approval.delete()
    mission.mission_uavs.update(uav=None)
    Mission.objects.filter(pk=mission.pk).update(state=MissionState.PLANNED, flat_ground_assumed=False)
    mission.routes.get().waypoints.update(altitude_amsl_m=50.0)
    document = approval_document(Mission.objects.get(pk=mission.pk))
    Approval.objects.create(mission=mission, document=document, content_sha256=content_sha256(document))
    Mission.objects.filter(pk=mission.pk).update(state=MissionState.APPROVED)
    assert "not_in_fleet" in refused(mission, person)


def test_a_uav_that_is_busy_or_out_of_service_is_sent_nothing(here: World, person: User) -> None:
    uavs = fleet()
    dispatched(person, uavs, here.towers[:2], name="First")
    second, _approval = approved(person, uavs, here.towers[3:5], name="Second")
    assert refused(second, person) == ["uav_busy"]
    third, _approval = approved(person, fleet("Kite"), here.towers[3:5], name="Third")
    Uav.objects.filter(name="Kite").update(state=UavState.MAINTENANCE)
    assert refused(third, person) == ["uav_changed"]
    assert state(third) == MissionState.APPROVED


def test_a_uav_with_another_link_since_has_to_be_approved_anew(here: World, person: User) -> None:
    mission, _approval = approved(person, fleet(), here.towers[:2])
    Uav.objects.update(link=LinkKind.HTTP)
    assert refused(mission, person) == ["link_changed"]


def test_a_companion_computer_is_given_the_route_itself(here: World, person: User) -> None:
    (tern,) = uavs = fleet(link=LinkKind.HTTP)
    dispatched(person, uavs, here.towers[:2])
    (command,) = claim(tern)
    load = load_of(command)
    assert (command.link, load.load, len(load.content_sha256)) == (LinkKind.HTTP, None, 64)
    assert len(load.route.waypoints) == len(load.waypoints)


def test_a_zone_saved_after_approval_that_touches_the_mission_stops_the_dispatch(here: World, person: User) -> None:
    mission, _approval = approved(person, fleet(), here.towers[:3])
    worlds.zone_around((10.008, 56.0), name="Airport")
    assert set(refused(mission, person)) == {"zone"}
    assert not mission.commands.exists()


def test_a_departure_that_passed_since_stops_the_dispatch(here: World, person: User) -> None:
    mission, _approval = approved(person, fleet(), here.towers[:2], departs_at=LATER)
    Mission.objects.filter(pk=mission.pk).update(departs_at=timezone.now() - timedelta(minutes=10))
    assert refused(mission, person) == ["departure_past"]


def test_sending_again_sends_what_is_not_there(here: World, person: User) -> None:
    tern, kite = uavs = fleet("Tern", "Kite")
    mission = dispatched(person, uavs, here.towers[1:3])
    carry(tern)
    assert refused(mission, person) == ["nothing_to_send"]
    (upload,) = claim(kite)
    note_failed(upload.pk, "no-space", "It holds too few items.", **fence(upload))
    (again,) = dispatch_mission(mission=mission, actor=person)
    assert again.uav == kite


def test_an_approval_that_is_being_taken_back_is_sent_to_nobody_and_started_by_nobody(here: World, person: User) -> None:
    (tern,) = uavs = fleet()
    mission = dispatched(person, uavs, here.towers[:2])
    carry(tern)
    start = command_uav(uav=tern, kind=CommandKind.START, actor=person)
    revoke_approval(mission=mission, actor=person, reason="Wrong day")
    assert now(start).outcome_code == "revoked"
    assert refused(mission, person) == ["being_revoked"]
    with pytest.raises(Refused) as error:
        command_uav(uav=tern, kind=CommandKind.START, actor=person)
    assert codes(error) == ["being_revoked"]


def test_a_mission_is_started_once_it_is_on_the_uav(here: World, person: User) -> None:
    (tern,) = uavs = fleet()
    with pytest.raises(Refused) as error:
        command_uav(uav=tern, kind=CommandKind.START, actor=person)
    assert codes(error) == ["no_mission"]
    mission = dispatched(person, uavs, here.towers[:2])
    with pytest.raises(Refused) as error:
        command_uav(uav=tern, kind=CommandKind.START, actor=person)
    assert codes(error) == ["not_loaded"]
    carry(tern)
    start = command_uav(uav=tern, kind=CommandKind.START, actor=person)
    assert load_of(start).content_sha256 == load_of(mission.commands.get(kind="upload-mission")).content_sha256
    assert state(mission) == MissionState.DISPATCHED
    carry(tern)
    assert state(mission) == MissionState.ACTIVE
    with pytest.raises(Refused) as error:
        revoke_approval(mission=mission, actor=person, reason="Too late")
    assert codes(error) == ["not_approved"]


def test_a_mission_is_started_at_its_time(here: World, person: User) -> None:
    (tern,) = uavs = fleet()
    mission = dispatched(person, uavs, here.towers[:2], departs_at=LATER)
    carry(tern)
    for departs_at, code in ((LATER, "too_early"), (timezone.now() - timedelta(hours=1), "departure_past")):
        Mission.objects.filter(pk=mission.pk).update(departs_at=departs_at)
        with pytest.raises(Refused) as error:
            command_uav(uav=tern, kind=CommandKind.START, actor=person)
        assert codes(error) == [code]
    Mission.objects.filter(pk=mission.pk).update(departs_at=timezone.now())
    assert command_uav(uav=tern, kind=CommandKind.START, actor=person)


def test_targets_follow_the_uav(here: World, person: User) -> None:
    (tern,) = uavs = fleet()
    mission = dispatched(person, uavs, here.towers[1:4])
    visits = list(mission.routes.get().waypoints.filter(kind="target").order_by("sequence").values_list("sequence", "target__sequence"))
    (first, one), (_, two), (third, three) = visits
    states = lambda: dict(mission.targets.values_list("sequence", "state"))  # noqa: E731

    mark_started(mission_id=mission.pk, uav_id=tern.pk)
    mark_waypoint_reached(mission_id=mission.pk, uav_id=tern.pk, waypoint=first)
    assert states() == {one: TargetState.IN_PROGRESS, two: TargetState.PENDING, three: TargetState.PENDING}
    mark_target(mission_id=mission.pk, target=two, state=TargetState.SKIPPED)
    mark_waypoint_reached(mission_id=mission.pk, uav_id=tern.pk, waypoint=third)
    assert states() == {one: TargetState.COMPLETE, two: TargetState.SKIPPED, three: TargetState.IN_PROGRESS}
    mark_waypoint_reached(mission_id=mission.pk, uav_id=tern.pk, waypoint=first)
    assert states()[one] == TargetState.COMPLETE
    assert mark_flight_ended(mission_id=mission.pk, uav_id=tern.pk, flight=1, end=FlightEnd.FLOWN) == MissionState.COMPLETED
    assert states() == {one: TargetState.COMPLETE, two: TargetState.SKIPPED, three: TargetState.COMPLETE}
    mark_target(mission_id=mission.pk, target=two, state=TargetState.COMPLETE)
    assert states()[two] == TargetState.COMPLETE


def test_a_mission_is_completed_with_the_last_of_its_uavs(here: World, person: User) -> None:
    tern, kite = uavs = fleet("Tern", "Kite")
    mission = active(person, uavs, here)
    assert mark_flight_ended(mission_id=mission.pk, uav_id=tern.pk, flight=1, end=FlightEnd.FLOWN) == MissionState.ACTIVE
    assert mark_flight_ended(mission_id=mission.pk, uav_id=tern.pk, flight=1, end=FlightEnd.FLOWN) == MissionState.ACTIVE
    assert mark_flight_ended(mission_id=mission.pk, uav_id=kite.pk, flight=1, end=FlightEnd.FLOWN) == MissionState.COMPLETED
    assert mark_flight_ended(mission_id=mission.pk, uav_id=kite.pk, flight=1, end=FlightEnd.FAILED) == MissionState.COMPLETED


def test_a_flight_that_fails_fails_its_mission(here: World, person: User) -> None:
    (tern,) = uavs = fleet()
    mission = active(person, uavs, here)
    mark_flight_ended(mission_id=mission.pk, uav_id=tern.pk, flight=1, end=FlightEnd.FAILED)
    assert state(mission) == MissionState.FAILED
    assert set(mission.targets.values_list("state", flat=True)) == {TargetState.FAILED}


def test_nothing_is_sent_to_a_uav_that_is_flying(here: World, person: User) -> None:
    tern, _kite = uavs = fleet("Tern", "Kite")
    mission = active(person, uavs, here)
    assert refused(mission, person, place=0) == ["being_flown"]
    assert refused(mission, person, place=0, flight=2) == ["no_flight"]
    mark_flight_ended(mission_id=mission.pk, uav_id=tern.pk, flight=1, end=FlightEnd.FLOWN)
    assert refused(mission, person, place=0) == ["flown_already"]


def test_an_abort_comes_before_everything_and_ends_the_mission(here: World, person: User) -> None:
    tern, kite = uavs = fleet("Tern", "Kite")
    mission = active(person, uavs, here)
    speed = command_uav(uav=kite, kind=CommandKind.CHANGE_SPEED, actor=person, parameters={"speed_mps": 5.0})
    abort_mission(mission=mission, actor=person, why="Storm")
    assert state(mission) == MissionState.ABORTED
    assert now(speed).outcome_code == "superseded"
    assert [(command.kind, command.uav) for command in claim(*uavs)] == [("abort", tern), ("abort", kite)]


def test_a_mission_that_was_not_started_is_taken_off_its_uavs_by_an_abort(here: World, person: User) -> None:
    (tern,) = uavs = fleet()
    mission = dispatched(person, uavs, here.towers[:2])
    carry(tern)
    abort_mission(mission=mission, actor=person, why="Storm")
    assert [command.kind for command in claim(tern)] == ["abort", "clear-mission"]


def commanded(uav: Uav, person: User, kind: CommandKind) -> str:
    """The code of the refusal, empty where it is taken."""
    parameters = {"altitude_relative_m": 10.0} if kind == CommandKind.TAKE_OFF else None
    try:
        command_uav(uav=uav, kind=kind, actor=person, parameters=parameters)
    except Refused as refusal:
        return refusal.reasons[0].code
    return ""


MOTION = (CommandKind.ARM, CommandKind.TAKE_OFF, CommandKind.START, CommandKind.RESUME)


@pytest.mark.parametrize("kind", MOTION)
def test_nothing_sets_a_uav_in_motion_without_a_mission_in_force(here: World, person: User, kind: CommandKind) -> None:
    (tern,) = uavs = fleet()
    assert commanded(tern, person, kind) == "no_mission"
    mission = active(person, uavs, here)
    abort_mission(mission=mission, actor=person, why="Crane")
    assert commanded(tern, person, kind) == "no_mission"
    assert [command.kind for command in claim(tern)] == ["abort"]


@pytest.mark.parametrize("kind", MOTION)
def test_nothing_sets_a_uav_in_motion_while_its_approval_is_taken_back(here: World, person: User, kind: CommandKind) -> None:
    (tern,) = uavs = fleet()
    mission = dispatched(person, uavs, here.towers[1:2])
    carry(tern)
    revoke_approval(mission=mission, actor=person, reason="Crane")
    assert commanded(tern, person, kind) == "being_revoked"


def test_only_a_mission_that_was_started_is_gone_on_with(here: World, person: User) -> None:
    """By this UAV: another one's start is none of its own."""
    tern, kite = uavs = fleet("Tern", "Kite")
    dispatched(person, uavs, here.towers[1:3])
    carry(*uavs)
    assert commanded(tern, person, CommandKind.RESUME) == "not_started"
    command_uav(uav=tern, kind=CommandKind.START, actor=person)
    carry(tern)
    assert commanded(tern, person, CommandKind.RESUME) == ""
    assert commanded(kite, person, CommandKind.RESUME) == "not_started"


def test_a_flight_that_failed_ends_its_route_alone(here: World, person: User) -> None:
    tern, kite = uavs = fleet("Tern", "Kite")
    mission = active(person, uavs, here)
    assert mark_flight_ended(mission_id=mission.pk, uav_id=tern.pk, flight=1, end=FlightEnd.FAILED) == MissionState.ACTIVE
    assert mark_flight_ended(mission_id=mission.pk, uav_id=tern.pk, flight=1, end=FlightEnd.FLOWN) == MissionState.ACTIVE
    assert list(mission.targets.order_by("sequence").values_list("state", flat=True)).count(TargetState.FAILED) == 1
    assert {commanded(tern, person, kind) for kind in MOTION} == {"route_failed"}
    assert "uav_busy" in refused(planned_again(person, [kite], here), person)
    assert mark_flight_ended(mission_id=mission.pk, uav_id=kite.pk, flight=1, end=FlightEnd.FLOWN) == MissionState.FAILED


def planned_again(person: User, uavs: list[Uav], here: World) -> Mission:
    return approved(person, uavs, here.towers[3:5], name="Second")[0]


def test_one_failed_flight_leaves_the_others_to_be_aborted(here: World, person: User) -> None:
    tern, kite = uavs = fleet("Tern", "Kite")
    mission = active(person, uavs, here)
    mark_flight_ended(mission_id=mission.pk, uav_id=tern.pk, flight=1, end=FlightEnd.FAILED)
    abort_mission(mission=mission, actor=person, why="Storm")
    assert state(mission) == MissionState.ABORTED
    assert [(command.kind, command.uav) for command in claim(*uavs)] == [("abort", tern), ("abort", kite)]


def test_a_failed_or_aborted_mission_is_aborted_again_while_a_uav_may_hold_it(here: World, person: User) -> None:
    """Who said that the last flight failed may be wrong, and an abort may not have been heard."""
    (tern,) = uavs = fleet()
    mission = active(person, uavs, here)
    mark_flight_ended(mission_id=mission.pk, uav_id=tern.pk, flight=1, end=FlightEnd.FAILED)
    for _again in range(2):
        abort_mission(mission=mission, actor=person, why="It flies on")
        assert state(mission) == MissionState.FAILED
        assert [command.kind for command in claim(tern)] == ["abort"]
    dispatched(person, uavs, here.towers[3:5], name="Second")
    with pytest.raises(Refused):
        abort_mission(mission=mission, actor=person, why="Storm")


def test_a_zone_that_came_after_the_mission_was_sent_bars_the_start(here: World, person: User) -> None:
    (tern,) = uavs = fleet()
    mission = dispatched(person, uavs, here.towers[1:2])
    carry(tern)
    first, second = mission.routes.get().waypoints.order_by("sequence")[:2]
    middle = ((first.position.x + second.position.x) / 2, (first.position.y + second.position.y) / 2)
    worlds.zone_around(middle, 0.0005, name="Crane")
    assert commanded(tern, person, CommandKind.START) == "zone"
    assert not tern.commands.filter(kind=CommandKind.START).exists()


def test_what_is_not_on_its_way_cannot_be_aborted(here: World, person: User) -> None:
    mission, _approval = approved(person, fleet(), here.towers[:2])
    with pytest.raises(Refused) as error:
        abort_mission(mission=mission, actor=person, why="Storm")
    assert codes(error) == ["not_on_its_way"]


def test_a_uav_is_free_for_another_mission_once_the_first_has_ended(here: World, person: User) -> None:
    uavs = fleet()
    first = active(person, uavs, here)
    abort_mission(mission=first, actor=person, why="Storm")
    second = dispatched(person, uavs, here.towers[3:5], name="Second")
    assert second.state == MissionState.DISPATCHED


@pytest.mark.parametrize(
    ("kind", "parameters", "code"),
    [
        ("change-speed", {"speed_mps": 12.5}, "out_of_range"),
        ("change-speed", {"speed_mps": 0.1}, "out_of_range"),
        ("change-speed", {}, "out_of_range"),
        ("change-speed", {"altitude_relative_m": 5.0}, "out_of_range"),
        ("take-off", {}, "out_of_range"),
        ("take-off", {"altitude_relative_m": 500.0}, "out_of_range"),
        ("hold", {"speed_mps": 5.0}, "no_parameters"),
        ("upload-mission", {}, "not_by_hand"),
        ("clear-mission", {}, "not_by_hand"),
    ],
)
def test_commands_have_figures_within_bounds(person: User, kind: str, parameters: dict, code: str) -> None:
    (tern,) = fleet(max_airspeed_mps=12.0)
    with pytest.raises(Refused) as error:
        command_uav(uav=tern, kind=CommandKind(kind), actor=person, parameters=parameters)
    assert codes(error) == [code]
    assert not tern.commands.exists()


def test_a_retired_uav_is_told_nothing(person: User) -> None:
    (tern,) = fleet(state=UavState.RETIRED)
    with pytest.raises(Refused):
        command_uav(uav=tern, kind=CommandKind.ARM, actor=person)


def test_commands_belong_to_the_mission_in_hand(here: World, person: User) -> None:
    (tern,) = uavs = fleet()
    assert command_uav(uav=tern, kind=CommandKind.HOLD, actor=person).mission is None
    mission = dispatched(person, uavs, here.towers[:2])
    hold = command_uav(uav=tern, kind=CommandKind.HOLD, actor=person, why="Crane")
    assert (hold.mission, hold.why, hold.state) == (mission, "Crane", CommandState.QUEUED)
