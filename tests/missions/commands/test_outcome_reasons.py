"""What became of commands is stored as reasons and in English, and read in the reader's language."""

from importlib import import_module

import pytest
from django.apps import apps
from django.db import connection
from django.utils.translation import override

from missions.models import CommandKind, CommandState, UavCommand
from missions.serializers.commands import command_json
from missions.services.commands.commands import expire_overdue, note_released
from operation.reasons import Reason
from tests.missions.commands.outbox import a_uav, claim, fence, give, grow_old, now

pytestmark = pytest.mark.django_db


def test_a_reason_to_wait_is_read_in_german_also_once_the_time_is_over() -> None:
    start = give(a_uav(), CommandKind.START)
    (held,) = claim(start.uav)
    note_released(held.pk, **fence(held), note=(Reason("beside_leg", {"metres": 120, "allowed": 100}),), code="off-route")
    grow_old(start)
    assert expire_overdue() == 1
    assert now(start).outcome == "It was not sent in time. The UAV is 120 m from the leg that it would fly on; 100 m are allowed."
    with override("de"):
        shown = command_json(start)
    assert [reason["code"] for reason in shown["outcome_why"]] == ["not_sent_in_time", "beside_leg"]
    assert "120 m" in shown["outcome"] and "The UAV" not in shown["outcome"]


def test_the_migration_gives_codes_to_fixed_outcomes_alone() -> None:
    outcomes = {
        "no-position": "The UAV does not tell where it stands.",
        "denied": "PreArm: Compass",
        "superseded": "A later command: Hold.",
    }
    rows = [give(a_uav(code), CommandKind.START) for code in outcomes]
    for row, (code, text) in zip(rows, outcomes.items(), strict=True):
        UavCommand.objects.filter(pk=row.pk).update(state=CommandState.FAILED, outcome_code=code, outcome=text, outcome_why=None)
    with connection.schema_editor() as editor:
        import_module("missions.migrations.0009_codes_of_fixed_texts").give_codes(apps, editor)
    given = [[reason["code"] for reason in command_json(now(row))["outcome_why"]] for row in rows]
    assert given == [["stand_unknown"], [], []]
