"""Whoever looks whether a mission may be flown keeps nobody from stopping its UAVs."""

import threading

import pytest
from django.db import connection, connections

from missions.models import CommandKind, MissionState
from missions.services.approval import checks
from missions.services.approval.approval import locked_mission
from missions.services.commands import dispatch
from missions.services.commands.refused import Refused
from missions.services.commands.steering import command_uav
from tests.missions.commands.outbox import a_uav
from tests.missions.flights import an_operator, carry, dispatched, fleet
from tests.missions.worlds import world

pytestmark = pytest.mark.django_db(transaction=True)
TIMEOUT_S = 60.0


def beside(do) -> None:
    """In a thread and a transaction of its own; without waiting for a row."""
    raised = []

    def inside() -> None:
        try:
            with connection.cursor() as cursor:
                cursor.execute("SET lock_timeout = '1s'")
            do()
        except Exception as error:
            raised.append(error)
        finally:
            connections.close_all()

    thread = threading.Thread(target=inside)
    thread.start()
    thread.join(TIMEOUT_S)
    assert not thread.is_alive()
    if raised:
        raise raised[0]


def test_a_mission_is_aborted_while_a_start_of_it_is_looked_at(monkeypatch):
    author, (one, other) = an_operator(), fleet("Tern", "Kite")
    mission = dispatched(author, [one, other], world().towers[:2])
    carry(one, other)
    look, looked = checks.reasons_against, []

    def slowly(*values, **named):
        if not looked:
            looked.append(1)
            beside(lambda: dispatch.abort_mission(mission=mission, actor=author, why="smoke"))
        return look(*values, **named)

    monkeypatch.setattr(checks, "reasons_against", slowly)
    with pytest.raises(Refused) as refused:
        command_uav(uav=one, kind=CommandKind.START, actor=author)
    assert refused.value.reasons[0].code == "no_mission", "it was aborted in the meantime"
    mission.refresh_from_db()
    assert mission.state == MissionState.ABORTED


def test_a_look_counts_as_long_as_nothing_was_changed(monkeypatch):
    author, (uav,) = an_operator(), fleet("Tern")
    mission = dispatched(author, [uav], world().towers[:1])
    carry(uav)
    look, looks = checks.reasons_against, []

    def counted(*values, **named):
        looks.append(named)
        if len(looks) == 1:
            mission.__class__.objects.filter(pk=mission.pk).update(revision=mission.revision + 1)
        return look(*values, **named)

    monkeypatch.setattr(checks, "reasons_against", counted)
    assert command_uav(uav=uav, kind=CommandKind.START, actor=author).parameters == {"flight": 1}
    assert len(looks) == 2, "the mission was changed while it was looked at"


@pytest.mark.parametrize("kind", [CommandKind.HOLD, CommandKind.RETURN, CommandKind.LAND, CommandKind.ABORT, CommandKind.PAUSE])
def test_what_stops_a_uav_does_not_wait_for_its_mission(kind):
    author, uav = an_operator(), a_uav("Tern", is_simulated=True)
    mission = dispatched(author, [uav], world().towers[:1])
    with dispatch.transaction.atomic():
        locked_mission(mission.pk, None)
        beside(lambda: command_uav(uav=uav, kind=kind, actor=author))
    assert uav.commands.filter(kind=kind, mission=mission).exists()
