"""Leases on rows: who may take one, in one statement, and what is renewed."""

from datetime import timedelta

import pytest
from django.db import connection
from django.db.models import F
from django.db.models.functions import Now

from missions.models import CommandKind
from telemetry.models import UavWatch
from tests.missions.commands.outbox import a_uav, claim, give
from tests.missions.flights import fleet
from workspace.leases import from_now, held_until_s, holder_name, is_free, is_free_for, release, renew, take

pytestmark = pytest.mark.django_db


@pytest.fixture
def rows():
    for uav in fleet("Kite", "Tern", "Wren"):
        UavWatch.objects.create(uav=uav, organisation=uav.organisation)
    return UavWatch.objects.all()


def taken_by(holder: str, **values) -> int:
    return len(take(UavWatch.objects.filter(is_free_for(holder, lease_s=10.0, **values)), holder=holder, lease_s=10.0))


def test_what_is_held_is_taken_once_its_lease_has_run_out(rows) -> None:
    assert (taken_by("one/a"), taken_by("two/a")) == (3, 0)
    rows.update(lease_expires_at=from_now(-0.001))
    assert rows.filter(is_free()).count() == taken_by("two/a") == 3


def test_a_process_that_was_started_again_waits_for_no_lease(rows) -> None:
    taken_by("one/a")
    assert (taken_by("one-b/a"), taken_by("one/b")) == (0, 3)


def test_a_second_process_of_the_same_name_takes_what_was_not_renewed_for_a_while(rows) -> None:
    taken_by("one/a")
    assert taken_by("one/b", namesake_s=2.0) == 0
    rows.update(lease_expires_at=F("lease_expires_at") - timedelta(seconds=2.1))
    assert taken_by("one/b", namesake_s=2.0) == 3


def test_rows_come_back_as_they_are_after_it(rows) -> None:
    (first, second) = take(rows.order_by("-uav")[:2], holder="one/a", lease_s=10.0, version=F("version") + 4)
    assert (first.holder, first.version, second.version) == ("one/a", 5, 5)
    assert set(rows.exclude(holder="").values_list("pk", flat=True)) == {first.pk, second.pk}


def test_only_rows_that_are_held_are_renewed(rows, django_assert_num_queries) -> None:
    held, lost, _free = rows.order_by("uav")
    rows.filter(pk=held.pk).update(holder="one/a", lease_expires_at=from_now(1), version=7)
    rows.filter(pk=lost.pk).update(holder="two/a", lease_expires_at=from_now(1))
    with django_assert_num_queries(1):
        assert renew(rows.filter(holder="one/a"), lease_s=20.0, column="version") == {held.pk: 7}
    late = rows.filter(lease_expires_at__gt=Now() + timedelta(seconds=15))
    assert [row.pk for row in late] == [held.pk]
    with django_assert_num_queries(0):
        assert renew(rows.filter(pk__in=[]), lease_s=20.0) == {}


def test_what_is_released_is_free_at_once_or_later(rows) -> None:
    taken_by("one/a")
    first = rows.order_by("uav")[0]
    assert release(rows.filter(pk=first.pk), holder="") == 1
    assert release(rows.exclude(pk=first.pk), after_s=5.0, holder="") == 2
    assert [row.pk for row in rows.filter(is_free())] == [first.pk]


def test_a_holder_acts_for_less_long_than_its_lease() -> None:
    assert held_until_s(100.0, 10.0) == 108.0


def test_a_name_holds_nothing_that_parts_it_from_the_run() -> None:
    assert holder_name("gate way/1") == "gate-way-1"
    assert holder_name(None) == holder_name("")


def test_no_more_are_taken_than_asked_for_whatever_plan_the_database_makes() -> None:
    """A subquery with a limit and locks may run once for each row of a nested loop, and then finds other rows each time."""
    uavs = [a_uav(name) for name in ("Kite", "Tern", "Auk", "Owl")]
    commands = [give(uavs[0], CommandKind.HOLD)]
    with connection.cursor() as cursor:
        cursor.execute("ANALYZE missions_uavcommand")  # from now on the database expects one row
        commands += [give(uav, CommandKind.HOLD) for uav in uavs[1:]]
        for kind in ("hashjoin", "mergejoin", "material", "memoize"):
            cursor.execute(f"SET LOCAL enable_{kind} = off")
    assert claim(*uavs, limit=2) == commands[:2]
