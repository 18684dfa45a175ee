"""Zones saved while many plans are made: what is answered afterwards crosses none of them."""

import threading
import time
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import pytest
from django.contrib.gis.geos import LineString
from django.db import connections, transaction

from inspection.models import NoFlyZone
from inspection.services import mark_ground_changed
from missions.services import make_plan
from tests.inspection import ground
from tests.missions.worlds import request, uav, world

pytestmark = [pytest.mark.django_db(transaction=True), pytest.mark.long]

PLANNERS, LASTS_S, INTERVAL_S = 4, 20.0, 1.0
ON_ITS_WAY_S = 0.05  # an answer that has passed its last look before the save may arrive so much later
PLACES = ((10.006, 56.0), (10.010, 56.0), (10.014, 56.0), (10.018, 56.0))


def test_no_answer_after_a_save_crosses_the_zone() -> None:
    here = world()
    saved: list[tuple[float, float, NoFlyZone]] = []  # when, until when, which
    answers: list[tuple[float, dict[str, Any]]] = []
    over = threading.Event()

    def plan_on_and_on() -> None:
        asked = request(here.towers[5], here.bridge, uavs=(uav((10.0, 55.9999)), uav((10.0, 55.9995), name="Gull")))
        try:
            while not over.is_set():
                plan = make_plan(request=asked)
                answers.append((time.monotonic(), plan))
        finally:
            connections.close_all()

    with ThreadPoolExecutor(PLANNERS) as planners:
        running = [planners.submit(plan_on_and_on) for _ in range(PLANNERS)]
        began_s, number = time.monotonic(), 0
        try:
            while time.monotonic() - began_s < LASTS_S:
                with transaction.atomic():
                    NoFlyZone.objects.all().delete()
                    zone = ground.zone(PLACES[number % len(PLACES)], 0.0004, name=f"Zone {number}")
                    mark_ground_changed()
                if saved:
                    saved[-1] = (saved[-1][0], time.monotonic(), saved[-1][2])
                saved.append((time.monotonic(), float("inf"), zone))
                number += 1
                time.sleep(INTERVAL_S)
        finally:
            over.set()
        for one in running:
            one.result()

    print(f"{len(answers):,} answers, {len(answers) / LASTS_S:.0f} a second, among {len(saved)} saves")
    assert len(answers) > 50 * LASTS_S
    crossing = [
        (answered_s - from_s, zone.name)
        for answered_s, plan in answers
        for from_s, until_s, zone in saved
        if from_s + ON_ITS_WAY_S < answered_s < until_s
        for route in plan["routes"]
        if route["geometry"] and LineString(route["geometry"]["coordinates"]).intersects(zone.geometry)
    ]
    assert crossing == []
