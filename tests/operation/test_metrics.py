"""What is counted, under which names, and that every name that dashboards and alerts use is one of them."""

import json
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
import yaml
from django.test import Client
from prometheus_client import REGISTRY
from prometheus_client.metrics import MetricWrapperBase
from prometheus_client.parser import text_string_to_metric_families

from config.instrumentation import system_metrics
from operation import metrics
from operation.exposition import metrics_text
from simulation.simulator import process as simulator_process
from telemetry.gateway import figures as gateway_figures
from tests.accounts.users import a_user, client_of

DEPLOY = Path(__file__).resolve().parents[2] / "deploy"
BOUNDED = {
    "route", "method", "status", "size", "reason", "task", "outcome", "kind", "bound", "state", "version", "program", "queue", "level",
    "cause", "when",
}  # fmt: skip


def own_names() -> Iterator[tuple[str, tuple[str, ...]]]:
    """Every series that Spanwise's programs tell, with its labels."""
    for metric in vars(metrics).values():
        if isinstance(metric, MetricWrapperBase):
            for family in metric.describe():
                endings = {"counter": ("_total",), "histogram": ("_bucket", "_sum", "_count"), "gauge": ("",)}[family.type]
                for ending in endings:
                    yield f"{family.name}{ending}", (*metric._labelnames, *(("le",) if ending == "_bucket" else ()))
    for module in (gateway_figures, simulator_process, system_metrics):
        for one in module.DESCRIBED:
            yield one.name + ("_total" if one.is_counter else ""), tuple(one.labels)


NAMES = dict(own_names())
OF_PROMETHEUS = {"up", "process_resident_memory_bytes", "process_open_fds", "process_cpu_seconds_total", "process_start_time_seconds"}


def expressions() -> Iterator[tuple[str, str]]:
    """Each query of the dashboards and the alert rules, with where it stands."""
    for path in sorted((DEPLOY / "grafana").glob("*.json")):
        board = json.loads(path.read_text())
        for panel in board["panels"]:
            for target in panel.get("targets", []):
                yield f"{path.name}: {panel['title']}", target["expr"]
    for group in yaml.safe_load((DEPLOY / "prometheus" / "alerts.yaml").read_text())["groups"]:
        for rule in group["rules"]:
            yield f"alerts.yaml: {rule['alert']}", rule["expr"]


def test_every_metric_that_dashboards_and_alerts_name_exists() -> None:
    found = list(expressions())
    assert len(found) >= 50
    for place, expression in found:
        named = set(re.findall(r"\b(?:spanwise|process)_\w+|\bup\b", re.sub(r'"[^"]*"', "", expression)))
        assert named, place
        assert named - NAMES.keys() - OF_PROMETHEUS == set(), place


def test_every_label_that_they_choose_by_is_one_of_the_metric() -> None:
    for place, expression in expressions():
        for name, chosen in re.findall(r"\b(spanwise_\w+)\{([^}]*)\}", expression):
            for label in re.findall(r"(\w+)\s*(?:=~|!~|!=|=)", chosen):
                assert label in (*NAMES[name], "job", "instance"), (place, label)


def test_labels_take_few_values() -> None:
    assert {label for labels in NAMES.values() for label in labels} <= BOUNDED | {"le"}


@pytest.mark.django_db
def test_a_request_is_counted_by_the_pattern_of_its_address_and_never_by_the_address() -> None:
    client = client_of(a_user())
    labels = {"route": "api/v1/missions/<uuid:mission_id>", "method": "GET", "status": "404"}
    before = REGISTRY.get_sample_value("spanwise_http_requests_total", labels) or 0
    for number in range(3):
        client.get(f"/api/v1/missions/00000000-0000-4000-8000-00000000000{number}")
    assert REGISTRY.get_sample_value("spanwise_http_requests_total", labels) == before + 3
    assert "00000000-0000" not in metrics_text().decode()


@pytest.mark.django_db
def test_what_strangers_make_up_makes_no_new_series() -> None:
    client = Client(raise_request_exception=False)
    client.generic("BREW", "/coffee")
    before = len(list(_series()))
    for number in range(20):
        client.generic(f"BREW{number}", f"/coffee/{number}")
    assert len(list(_series())) == before


@pytest.mark.django_db
def test_metrics_are_not_at_the_public_port() -> None:
    assert Client().get("/metrics").status_code == 404


def _series() -> Iterator[str]:
    for family in text_string_to_metric_families(metrics_text().decode()):
        if family.name.startswith("spanwise_http"):
            yield from (str(sample[:2]) for sample in family.samples)
