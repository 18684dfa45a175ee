"""What programs tell of their own state: the gateway of its links, the estimator of its errors, beat of the whole installation."""

import time
from collections import Counter
from datetime import timedelta
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from django.utils import timezone

from config.celery import app
from config.instrumentation import system_metrics
from config.instrumentation.system_metrics import InstallationState
from inspection.geodesy import LonLat
from inspection.geodesy.local_frame import LocalFrame
from inspection.models import GraphSnapshot, Ground
from telemetry.estimation.estimate import Ellipse, Estimate, innovation
from telemetry.gateway import figures as gateway_figures
from workspace.models import DEFAULT_ORGANISATION_ID, Job

HERE = LonLat(10.0, 56.0)


def an_estimate(bound: Ellipse) -> Estimate:
    return Estimate(
        at_s=0.0, position=HERE, altitude_relative_m=None, altitude_amsl_m=None, speed_mps=0.0, heading_deg=None, bound=bound,
        bound_height_m=1.0, bound_speed_mps=1.0, report_s=None, is_measured=False, is_lost=False,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("east_m", "north_m", "bearing_deg", "is_within"),
    [(8, 0, 90, True), (0, 8, 90, False), (0, 8, 0, True), (8, 0, 0, False), (6, 6, 45, True), (6, -6, 45, False), (0, 0, 17, True)],
)
def test_a_report_is_within_the_bound_as_the_ellipse_lies(east_m: float, north_m: float, bearing_deg: float, is_within: bool) -> None:
    """The ellipse is 10 m along its bearing and 2 m across it."""
    lon, lat = LocalFrame.around(*HERE).to_degrees(np.array([[east_m, north_m]]))[0]
    found = innovation(an_estimate(Ellipse(10.0, 2.0, bearing_deg)), LonLat(lon, lat))
    assert found.is_within is is_within
    assert found.error_m == pytest.approx(np.hypot(east_m, north_m), abs=1e-6)


def a_session(*, is_held: bool, last_message_ago_s: float) -> Any:
    return SimpleNamespace(is_held=is_held, last_message_s=time.time() - last_message_ago_s)


def test_a_gateway_tells_of_its_links_and_losses() -> None:
    sessions = [
        a_session(is_held=True, last_message_ago_s=0),
        a_session(is_held=True, last_message_ago_s=600),
        a_session(is_held=False, last_message_ago_s=0),
    ]
    gateway: Any = SimpleNamespace(
        store=SimpleNamespace(stored=7, duplicates=2, lost=1, records=[1, 2, 3], is_away=True),
        lost_here=Counter({"unsigned": 4}),
        sessions=dict(enumerate(sessions)),
        dropped=lambda: {"unknown-system": 5},
    )
    with gateway_figures.figures_of(gateway) as reported:
        values = {(sample.name, *sample.labels.values()): sample.value for family in reported.collect() for sample in family.samples}
    assert values == {
        ("spanwise_gateway_links", "heard"): 1, ("spanwise_gateway_links", "silent"): 1, ("spanwise_gateway_links", "elsewhere"): 1,
        ("spanwise_gateway_losses_total", "unsigned"): 4, ("spanwise_gateway_losses_total", "unknown-system"): 5,
        ("spanwise_gateway_records_total", "stored"): 7, ("spanwise_gateway_records_total", "duplicate"): 2,
        ("spanwise_gateway_records_total", "lost"): 1,
        ("spanwise_gateway_records_waiting",): 3, ("spanwise_gateway_database_away",): 1,
    }  # fmt: skip


@pytest.mark.django_db(transaction=True)
def test_beat_tells_of_jobs_by_queue_and_of_a_graph_that_is_behind() -> None:
    for task, ago_s in (("missions.tasks.plan_mission", 90), ("missions.tasks.solve_plan", 30), ("simulation.tasks.rehearse_mission", 5)):
        job = Job.objects.create(organisation_id=DEFAULT_ORGANISATION_ID, task=task)
        Job.objects.filter(pk=job.pk).update(created_at=timezone.now() - timedelta(seconds=ago_s))
    counts = dict.fromkeys(["nodes", "edges", "components", "excluded_nodes", "excluded_edges"], 0)
    GraphSnapshot.objects.create(ground_revision=1, rules={}, arrays=b"", arrays_sha256="", build_s=0.1, **counts)
    Ground.objects.update_or_create(pk=1, defaults={"revision": 2, "changed_at": timezone.now() - timedelta(seconds=700)})
    reported = InstallationState(app).read()
    assert reported[system_metrics.DATABASE] == reported[system_metrics.REDIS] == {(): 1.0}
    assert reported[system_metrics.JOBS]["planning", "queued"] == 2
    assert reported[system_metrics.JOBS]["simulation", "queued"] == 1
    assert reported[system_metrics.JOBS]["data", "queued"] == 0
    assert 89 <= reported[system_metrics.JOB_AGE]["planning", "queued"] < 500
    assert reported[system_metrics.QUEUE].keys() == {("data",), ("flight",), ("planning",), ("proofs",), ("simulation",)}
    assert reported[system_metrics.GRAPH_BEHIND][()] >= 699
    assert reported.keys() == {one.name for one in system_metrics.DESCRIBED}


def test_without_redis_the_rest_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    state = InstallationState(app)

    def away(*args: object, **named: object) -> None:
        raise ConnectionRefusedError

    monkeypatch.setattr(app, "connection_for_read", away)
    assert state._of_redis() == {system_metrics.REDIS: {(): 0.0}}
