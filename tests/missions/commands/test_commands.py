"""The outbox of commands to UAVs: order, urgency, leases, and an end for everything."""

import threading
from uuid import uuid4

import psycopg
import pytest
from django.conf import settings
from django.db import IntegrityError, connection, transaction

from missions.command_rules import AXES, PRIORITIES, Axis, axis_of, priority_of
from missions.models import CommandAxis, CommandKind, CommandPriority, CommandState, LinkKind, Uav, UavCommand
from missions.selectors.given import given_to
from missions.services import change_uav
from missions.services.commands.commands import (
    CHANNEL,
    claim_commands,
    expire_overdue,
    note_acknowledged,
    note_applied,
    note_failed,
    note_progress,
    note_released,
    note_sent,
    renew_claims,
)
from missions.services.commands.refused import Refused
from missions.tasks import expire_commands
from tests.accounts.users import a_user
from tests.missions.commands.outbox import LEASE_S, a_uav, claim, fence, give, grow_old, lose, now, steps
from workspace.models import AuditEntry

pytestmark = pytest.mark.django_db


def test_every_kind_has_its_priority_and_its_axis() -> None:
    assert set(PRIORITIES) == set(CommandKind.values)
    assert set(AXES) <= set(CommandKind.values)
    assert {str(axis) for axis in Axis} == set(CommandAxis.values)
    assert {priority_of(kind) for kind in CommandKind.values} == set(CommandPriority.values)
    assert [CommandPriority(priority_of(kind)) for kind in ("abort", "hold", "return", "land")] == [CommandPriority.SAFETY] * 4
    assert (axis_of("arm"), axis_of("upload-mission"), axis_of("change-speed")) == (Axis.FLIGHT, Axis.MISSION, Axis.SPEED)


def test_what_sets_a_uav_in_motion_is_too_old_before_what_stops_it() -> None:
    wanted_s = settings.COMMAND_RULES.wanted_for_s
    motion, stop = ("arm", "take-off", "start", "resume"), ("pause", "hold", "return", "land", "abort")
    assert max(wanted_s(kind) for kind in motion) <= 30.0 < min(wanted_s(kind) for kind in stop)
    assert wanted_s("clear-mission") is None


def test_a_commands_way_from_the_person_to_the_vehicle() -> None:
    person, uav = a_user(), a_uav()
    command = give(uav, CommandKind.HOLD, person, why="Crane on the site")
    assert (command.state, command.sequence, command.attempts) == (CommandState.QUEUED, 1, 0)
    (held,) = claim(uav)
    assert held == command
    assert note_sent(held.pk, **fence(held))
    assert note_acknowledged(held.pk, **fence(held))
    assert note_applied(held.pk, **fence(held), note="LOITER")
    done = now(command)
    assert done.state == CommandState.APPLIED
    assert done.created_at <= done.sent_at <= done.acknowledged_at <= done.finished_at
    assert steps(done) == [("queued", 0), ("sent", 1), ("acknowledged", 1), ("applied", 1)]
    entry = AuditEntry.objects.get(subject_type="uav_command", subject_id=str(command.pk))
    assert (entry.actor, entry.after["why"], entry.after["uav"]) == (person, "Crane on the site", uav.pk)


def test_sequences_of_a_uav_have_no_gaps_and_are_its_own() -> None:
    kite, tern = a_uav("Kite"), a_uav("Tern")
    kinds = [CommandKind.ARM, CommandKind.CHANGE_SPEED, CommandKind.HOLD]
    assert [give(kite, kind).sequence for kind in kinds] == [1, 2, 3]
    assert give(tern, CommandKind.ARM).sequence == 1


def test_a_later_command_about_the_same_thing_takes_the_place_of_the_earlier() -> None:
    uav = a_uav()
    pause, speed = give(uav, CommandKind.PAUSE), give(uav, CommandKind.CHANGE_SPEED)
    resume = give(uav, CommandKind.RESUME)
    assert (now(pause).state, pause.outcome_code) == (CommandState.EXPIRED, "superseded")
    assert pause.outcome_why["reasons"] == [{"code": "superseded", "params": {"command": {"code": "command_resume", "params": {}}}}]
    assert claim(uav) == [resume, speed]


def test_an_abort_takes_the_place_of_everything() -> None:
    uav = a_uav()
    earlier = [give(uav, CommandKind.CLEAR_MISSION), give(uav, CommandKind.START), give(uav, CommandKind.CHANGE_SPEED)]
    abort = give(uav, CommandKind.ABORT)
    assert {now(command).outcome_code for command in earlier} == {"superseded"}
    assert claim(uav) == [abort]


SAFETY_UPWARDS = (CommandKind.HOLD, CommandKind.RETURN, CommandKind.LAND, CommandKind.ABORT)


@pytest.mark.parametrize("waiting", SAFETY_UPWARDS)
@pytest.mark.parametrize("later", [kind for kind in CommandKind if axis_of(kind) == Axis.FLIGHT])
def test_what_makes_a_uav_safe_is_called_off_by_nothing_less(waiting: CommandKind, later: CommandKind) -> None:
    uav = a_uav()
    first = give(uav, waiting)
    if later in SAFETY_UPWARDS and SAFETY_UPWARDS.index(later) >= SAFETY_UPWARDS.index(waiting):
        second = give(uav, later)
        assert claim(uav) == [second]
        assert now(first).outcome_code == "superseded"
        return
    with pytest.raises(Refused) as error:
        give(uav, later)
    assert error.value.reasons[0].code == "safety_first"
    assert claim(uav) == [first]


@pytest.mark.parametrize("later", [CommandKind.ARM, CommandKind.TAKE_OFF, CommandKind.START])
def test_a_pause_is_called_off_by_nothing_that_moves_a_uav_but_going_on(later: CommandKind) -> None:
    uav = a_uav()
    pause = give(uav, CommandKind.PAUSE)
    with pytest.raises(Refused):
        give(uav, later)
    assert claim(uav) == [pause]


def test_once_it_is_done_the_uav_goes_on() -> None:
    uav = a_uav()
    give(uav, CommandKind.HOLD)
    (hold,) = claim(uav)
    assert note_applied(hold.pk, **fence(hold))
    resume = give(uav, CommandKind.RESUME)
    assert claim(uav) == [resume]


def test_other_uavs_keep_their_commands() -> None:
    kite, tern = a_uav("Kite"), a_uav("Tern")
    start = give(kite, CommandKind.START)
    give(tern, CommandKind.ABORT)
    assert now(start).state == CommandState.QUEUED


def test_whoever_carries_what_was_overtaken_learns_of_it_with_the_next_word() -> None:
    uav = a_uav()
    give(uav, CommandKind.START)
    (start,) = claim(uav)
    assert note_sent(start.pk, **fence(start))
    hold = give(uav, CommandKind.HOLD)
    assert not note_acknowledged(start.pk, **fence(start))
    assert not note_applied(start.pk, **fence(start))
    assert not note_failed(start.pk, "denied", "Denied", **fence(start))
    assert not note_released(start.pk, **fence(start))
    assert now(start).state == CommandState.EXPIRED
    assert claim(uav) == [hold]


def test_the_database_keeps_two_open_commands_about_one_thing_apart() -> None:
    uav = a_uav()
    give(uav, CommandKind.ARM)
    with pytest.raises(IntegrityError, match="uav_command_one_open_of_an_axis"), transaction.atomic():
        UavCommand.objects.create(uav=uav, sequence=2, kind="hold", axis="flight", priority=0, link="mavlink")


def test_the_most_urgent_is_taken_first_and_of_these_the_oldest() -> None:
    uavs = [a_uav(name) for name in ("Kite", "Tern", "Auk")]
    speed = give(uavs[0], CommandKind.CHANGE_SPEED)
    start = give(uavs[0], CommandKind.START)
    pause = give(uavs[1], CommandKind.PAUSE)
    first_hold, second_hold = give(uavs[2], CommandKind.HOLD), give(a_uav("Owl"), CommandKind.HOLD)
    uavs.append(second_hold.uav)
    assert claim(*uavs, limit=2) == [first_hold, second_hold]
    assert claim(*uavs, limit=10) == [pause, start, speed]
    assert claim(*uavs) == []


def test_commands_to_uavs_that_are_not_asked_for_are_left_alone() -> None:
    kite, tern = a_uav("Kite"), a_uav("Tern")
    give(kite, CommandKind.HOLD)
    assert claim(tern) == []
    assert claim() == []


def test_each_door_has_its_own_commands() -> None:
    kite, tern = a_uav("Kite", link=LinkKind.HTTP), a_uav("Tern")
    by_http, by_mavlink = give(kite, CommandKind.HOLD), give(tern, CommandKind.HOLD)
    asked = {"uav_ids": [kite.pk, tern.pk], "holder": "gateway-1", "lease_s": LEASE_S, "limit": 10}
    assert claim_commands(**asked, link=LinkKind.MAVLINK) == [by_mavlink]
    assert claim_commands(**asked) == [by_http]


def test_a_uav_that_is_reached_otherwise_now_is_given_nothing_by_its_former_door() -> None:
    kite = a_uav("Kite", link=LinkKind.HTTP)
    give(kite, CommandKind.CHANGE_SPEED)
    Uav.objects.update(link=LinkKind.MAVLINK)  # as nobody may while something waits
    land = give(kite, CommandKind.LAND)
    assert land.link == LinkKind.MAVLINK, "by the link of now, not of when the caller looked"
    asked = {"uav_ids": [kite.pk], "holder": "gateway-1", "lease_s": LEASE_S, "limit": 10}
    assert claim_commands(**asked, link=LinkKind.HTTP) == []
    assert not given_to(kite.pk).waiting
    assert claim_commands(**asked, link=LinkKind.MAVLINK) == [land]


@pytest.mark.parametrize("change", [{"link": LinkKind.HTTP}, {"mavlink_system_id": 9}, {"allows_unsigned": True}])
def test_how_a_uav_is_reached_does_not_change_while_a_command_waits(change: dict) -> None:
    person, uav = a_user(), a_uav(mavlink_system_id=7)
    abort = give(uav, CommandKind.ABORT)
    with pytest.raises(Refused) as error:
        change_uav(uav=uav, actor=person, position=None, values=change)
    assert error.value.reasons[0].code == "commands_waiting"
    change_uav(uav=uav, actor=person, position=None, values={"name": "Owl"})
    assert claim_commands(uav_ids=[uav.pk], holder="gateway-1", lease_s=LEASE_S, limit=1, link=LinkKind.MAVLINK) == [abort]
    assert note_applied(abort.pk, attempt=1, holder="gateway-1")
    change_uav(uav=uav, actor=person, position=None, values=change)


def test_a_system_id_is_given_to_a_uav_that_had_none_though_a_command_waits() -> None:
    uav = a_uav()
    give(uav, CommandKind.ABORT)
    change_uav(uav=uav, actor=a_user(), position=None, values={"mavlink_system_id": 9})


def test_what_is_held_is_taken_by_nobody_else_until_the_lease_runs_out() -> None:
    uav = a_uav()
    give(uav, CommandKind.HOLD)
    (first,) = claim(uav, holder="gateway-1")
    assert claim(uav, holder="gateway-2") == []
    note_sent(first.pk, **fence(first))
    lose(first)
    (second,) = claim(uav, holder="gateway-2")
    assert (second.attempts, second.holder) == (2, "gateway-2")
    assert not note_acknowledged(first.pk, **fence(first))
    assert not note_applied(first.pk, **fence(first))
    assert note_sent(second.pk, **fence(second))
    assert note_applied(second.pk, **fence(second))
    assert steps(second) == [("queued", 0), ("sent", 1), ("sent", 2), ("applied", 2)]
    assert now(second).sent_at < second.finished_at


def test_a_gateway_that_takes_its_own_again_fences_off_its_earlier_attempt() -> None:
    uav = a_uav()
    give(uav, CommandKind.HOLD)
    (first,) = claim(uav)
    lose(first)
    (again,) = claim(uav)
    assert not note_sent(first.pk, **fence(first))
    assert note_sent(again.pk, **fence(again))


def test_renewing_says_what_is_still_held() -> None:
    uav = a_uav()
    give(uav, CommandKind.HOLD)
    give(uav, CommandKind.CHANGE_SPEED)
    hold, speed = claim(uav)
    lose(hold)
    assert renew_claims(holder="gateway-1", lease_s=LEASE_S) == {hold.pk: 1, speed.pk: 1}
    assert claim(uav, holder="gateway-2") == []
    give(uav, CommandKind.ABORT)
    assert renew_claims(holder="gateway-1", lease_s=LEASE_S) == {}


def test_what_is_given_back_is_there_for_anybody_and_after_a_while_if_wished() -> None:
    uav = a_uav()
    give(uav, CommandKind.HOLD)
    (held,) = claim(uav)
    assert note_released(held.pk, **fence(held), note="The gateway stops")
    (held,) = claim(uav, holder="gateway-2")
    assert note_released(held.pk, **fence(held), retry_in_s=60.0)
    assert claim(uav) == []
    assert renew_claims(holder="gateway-2", lease_s=LEASE_S) == {}
    lose(held)
    assert claim(uav) == [held]


def test_acknowledging_twice_is_one_step() -> None:
    uav = a_uav()
    give(uav, CommandKind.HOLD)
    (held,) = claim(uav)
    assert note_acknowledged(held.pk, **fence(held))
    assert note_acknowledged(held.pk, **fence(held))
    assert steps(held) == [("queued", 0), ("acknowledged", 1)]
    assert now(held).sent_at is not None


def test_what_has_ended_stays_ended() -> None:
    uav = a_uav()
    give(uav, CommandKind.HOLD)
    (held,) = claim(uav)
    assert note_failed(held.pk, "denied", "The UAV refused it.", **fence(held))
    assert not note_applied(held.pk, **fence(held))
    assert not note_progress(held.pk, **fence(held), done=1, total=2)
    assert (now(held).state, held.outcome_code, held.outcome) == (CommandState.FAILED, "denied", "The UAV refused it.")
    assert claim(uav) == []


def test_progress_is_noted_without_a_step() -> None:
    uav = a_uav()
    give(uav, CommandKind.CLEAR_MISSION)
    (held,) = claim(uav)
    assert note_progress(held.pk, **fence(held), done=3, total=200)
    assert now(held).progress == {"done": 3, "total": 200}
    assert steps(held) == [("queued", 0)]
    assert not note_progress(held.pk, attempt=7, holder=held.holder, done=4, total=200)


def test_notes_of_what_is_not_there_write_nothing() -> None:
    assert not note_sent(uuid4(), attempt=1, holder="gateway-1")


def test_an_arm_that_could_not_be_delivered_does_not_arm_the_uav_an_hour_later() -> None:
    uav = a_uav()
    arm = give(uav, CommandKind.ARM)
    assert 29 < (arm.expires_at - arm.created_at).total_seconds() < 31
    grow_old(arm)
    assert claim(uav) == []
    expire_commands()
    assert (now(arm).state, arm.outcome_code) == (CommandState.EXPIRED, "not-delivered")
    assert steps(arm) == [("queued", 0), ("expired", 0)]


def test_a_start_that_had_to_wait_and_was_not_sent_keeps_the_reason() -> None:
    uav, words = a_uav(), "The UAV does not tell where it stands."
    start = give(uav, CommandKind.START)
    (held,) = claim(uav)
    note_released(held.pk, **fence(held), note=words, code="no-position")
    assert (now(start).state, start.outcome_code, start.outcome) == (CommandState.QUEUED, "no-position", words)
    grow_old(start)
    assert expire_overdue() == 1
    assert (now(start).state, start.outcome_code) == (CommandState.EXPIRED, "no-position")
    assert start.outcome == f"It was not sent in time. {words}"
    assert start.events.order_by("pk").last().note == start.outcome


def test_a_start_that_was_sent_after_all_has_no_reason_to_wait_any_more() -> None:
    start = give(a_uav(), CommandKind.START)
    (held,) = claim(start.uav)
    note_released(held.pk, **fence(held), note="The UAV does not tell where it stands.", code="no-position")
    (held,) = claim(start.uav)
    assert note_sent(held.pk, **fence(held))
    assert (now(start).outcome_code, start.outcome) == ("", "")


def test_what_is_carried_is_left_to_its_carrier_beyond_its_time() -> None:
    uav = a_uav()
    give(uav, CommandKind.ARM)
    (held,) = claim(uav)
    note_sent(held.pk, **fence(held))
    grow_old(held)
    assert expire_overdue() == 0
    assert note_applied(held.pk, **fence(held))


@pytest.mark.parametrize("kind", [CommandKind.TAKE_OFF, CommandKind.START, CommandKind.ABORT])
def test_what_was_claimed_in_time_is_not_first_sent_after_it(kind: CommandKind) -> None:
    command = give(a_uav(), kind)
    (held,) = claim(command.uav)
    grow_old(command)
    assert renew_claims(holder=held.holder, lease_s=LEASE_S) == {}
    assert not note_sent(held.pk, **fence(held))
    assert now(command).sent_at is None
    lose(command)
    assert renew_claims(holder=held.holder, lease_s=LEASE_S) == {}, "a lease that ran out is not given back to what is overdue"
    assert expire_overdue() == 1
    assert (now(command).state, command.outcome_code) == (CommandState.EXPIRED, "not-delivered")


def test_what_was_sent_in_time_is_held_beyond_it() -> None:
    command = give(a_uav(), CommandKind.RETURN)
    (held,) = claim(command.uav)
    assert note_sent(held.pk, **fence(held))
    grow_old(command)
    assert renew_claims(holder=held.holder, lease_s=LEASE_S) == {held.pk: held.attempts}
    assert note_applied(held.pk, **fence(held))


def test_what_was_sent_by_somebody_who_died_ends_unconfirmed() -> None:
    uav = a_uav()
    give(uav, CommandKind.ARM)
    (held,) = claim(uav)
    note_sent(held.pk, **fence(held))
    grow_old(held)
    lose(held)
    assert claim(uav) == []
    assert expire_overdue() == 1
    assert now(held).outcome_code == "unconfirmed"
    assert not note_applied(held.pk, **fence(held))


def test_a_command_may_be_wanted_longer_or_shorter_than_its_kind() -> None:
    command = give(a_uav(), CommandKind.HOLD, expires_in_s=5.0)
    assert 4 < (command.expires_at - command.created_at).total_seconds() < 6
    assert give(a_uav("Tern"), CommandKind.CLEAR_MISSION).expires_at is None


@pytest.mark.django_db(transaction=True)
def test_whoever_listens_hears_of_a_committed_command_and_of_no_other() -> None:
    uav = a_uav()
    with psycopg.connect(**connection.get_connection_params() | {"cursor_factory": psycopg.Cursor}, autocommit=True) as ear:
        ear.execute(f"LISTEN {CHANNEL}")
        with transaction.atomic():
            give(uav, CommandKind.ARM)
            transaction.set_rollback(True)
        give(uav, CommandKind.HOLD)
        received = next(ear.notifies(timeout=10, stop_after=1))
        assert received.payload == str(uav.pk)
        assert list(ear.notifies(timeout=0.05)) == []


@pytest.mark.django_db(transaction=True)
def test_many_at_once_give_one_uav_its_commands_in_an_order_without_gaps() -> None:
    uav, kinds = a_uav(), [CommandKind.ABORT, CommandKind.CHANGE_SPEED, CommandKind.CLEAR_MISSION, CommandKind.ABORT]

    def give_some() -> None:
        try:
            for kind in kinds:
                give(uav, kind)
        finally:
            connection.close()

    together([give_some] * 4)
    assert sorted(uav.commands.values_list("sequence", flat=True)) == list(range(1, 17))
    for axis in CommandAxis.values:
        assert uav.commands.filter(axis=axis, state=CommandState.QUEUED).count() <= 1


@pytest.mark.django_db(transaction=True)
def test_many_at_once_take_each_command_once() -> None:
    uavs = [a_uav(f"Kite {number}") for number in range(20)]
    for uav in uavs:
        give(uav, CommandKind.HOLD)
        give(uav, CommandKind.CHANGE_SPEED)
    taken: list[list[UavCommand]] = []

    def take(holder: str) -> None:
        try:
            while found := claim(*uavs, holder=holder, limit=3):
                taken.append(found)
        finally:
            connection.close()

    together([lambda number=number: take(f"gateway-{number}") for number in range(4)])
    all_taken = [command for commands in taken for command in commands]
    assert len(all_taken) == len(set(all_taken)) == 40
    assert {command.attempts for command in all_taken} == {1}


def together(works: list) -> None:
    threads = [threading.Thread(target=work) for work in works]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(timeout=60)
    assert not any(thread.is_alive() for thread in threads)
