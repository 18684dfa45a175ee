"""A UAV is given another name while its reports are stored: neither is in the other's way."""

import threading
import time
from collections.abc import Callable

import pytest
from django.contrib.gis.geos import Point
from django.db import connection, connections, transaction

from missions.models import Uav
from missions.services.fleet.uavs import change_uav
from tests.accounts.users import a_user
from tests.missions.commands.outbox import a_uav

pytestmark = pytest.mark.django_db(transaction=True)
TIMEOUT_S = 60.0
WAITS = "SELECT EXISTS (SELECT FROM pg_locks WHERE NOT granted AND locktype IN ('transactionid', 'tuple'))"


def somebody_waits_for_a_row() -> bool:
    with connection.cursor() as cursor:
        cursor.execute(WAITS)
        return bool(cursor.fetchone()[0])


def until(fact: Callable[[], bool]) -> None:
    end_s = time.monotonic() + TIMEOUT_S
    while not fact():
        assert time.monotonic() < end_s
        time.sleep(0.01)


def test_a_name_is_changed_between_a_report_that_points_at_the_uav_and_its_new_place() -> None:
    uav, actor = a_uav("Kite"), a_user()
    has_pointed = threading.Event()
    faults: list[Exception] = []

    def stores() -> None:
        """In the order of services/ingest.py."""
        try:
            with transaction.atomic():
                with connection.cursor() as cursor:
                    cursor.execute("SELECT id FROM missions_uav WHERE id = %s FOR KEY SHARE", [uav.pk])
                has_pointed.set()
                until(somebody_waits_for_a_row)
                Uav.objects.filter(pk=uav.pk).update(location=Point(11, 56))
        except Exception as error:
            faults.append(error)
        finally:
            connections.close_all()

    thread = threading.Thread(target=stores)
    thread.start()
    assert has_pointed.wait(TIMEOUT_S)
    change_uav(uav=uav, actor=actor, position=None, values={"name": "Kite 2", "mavlink_system_id": 77})
    thread.join(TIMEOUT_S)
    assert faults == []
    found = Uav.objects.get(pk=uav.pk)
    assert (found.name, found.location.x) == ("Kite 2", 11.0)
