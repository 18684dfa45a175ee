"""The log of a flight is stored while somebody holds its mission to give a command: neither waits for the other."""

import threading

import pytest
from django.contrib.gis.geos import Point
from django.db import connections, transaction
from django.utils import timezone

from missions.models import Mission, MissionState, Uav
from missions.services.approval.approval import locked_mission
from telemetry.models import TelemetryRecord
from telemetry.services import store_records
from tests.telemetry.flown_missions import flies_route
from tests.telemetry.records import record

TIMEOUT_S = 60.0


@pytest.mark.django_db(transaction=True)
def test_a_report_is_stored_while_its_mission_is_held():
    uav = Uav.objects.create(name="One", location=Point(0, 0))
    mission = Mission.objects.create(name="Held", state=MissionState.DISPATCHED, planned_at=timezone.now(), graph_version=1)
    flies_route(mission, uav)

    def report() -> None:
        store_records([record(uav, 1)])
        connections.close_all()

    with transaction.atomic():
        locked_mission(mission.pk, None)
        thread = threading.Thread(target=report)
        thread.start()
        thread.join(TIMEOUT_S)
        is_stored = not thread.is_alive()
    thread.join(TIMEOUT_S)
    assert is_stored
    assert TelemetryRecord.objects.get().mission == mission
