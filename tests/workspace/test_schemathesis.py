"""Requests that schemathesis makes from the OpenAPI document are answered by the statuses, media types and shapes that it names."""

import re
from datetime import timedelta
from typing import Any
from unittest import mock

import pytest
import schemathesis
from django.core.handlers.wsgi import WSGIHandler
from django.utils import timezone
from hypothesis import HealthCheck, Phase, given, settings
from schemathesis.checks import not_a_server_error
from schemathesis.core.failures import FailureGroup
from schemathesis.specs.openapi.checks import (
    content_type_conformance,
    response_headers_conformance,
    response_schema_conformance,
    status_code_conformance,
)

from tests.inspection import ground
from tests.missions.outbox import a_uav
from tests.missions.worlds import world
from tests.workspace.people import somebody
from workspace.models import Role
from workspace.services import create_api_token

pytestmark = [pytest.mark.django_db(transaction=True), pytest.mark.long]
CHECKS = [
    not_a_server_error,
    status_code_conformance,
    content_type_conformance,
    response_headers_conformance,
    response_schema_conformance,
]
EXAMPLES = 8  # an operation
LEFT_OUT = re.compile(r"/(account|people|uav-link)\b")  # they end the token that asks, or have one of their own
BOUNDED = settings(
    max_examples=EXAMPLES,
    derandomize=True,
    database=None,
    deadline=None,
    phases=[Phase.generate],
    suppress_health_check=list(HealthCheck),
)


def faults_of(operation: Any, token: str) -> list[str]:
    faults: list[str] = []

    @BOUNDED
    @given(case=operation.as_strategy())
    def ask(case: Any) -> None:
        answer = case.call(headers={"Authorization": f"Bearer {token}"})
        try:
            case.validate_response(answer, checks=CHECKS)
        except FailureGroup as error:
            faults.extend(f"{operation.label}: {answer.status_code} {fault.title}: {fault.message[:300]}" for fault in error.exceptions)

    ask()
    return faults


def test_what_is_asked_by_the_document_is_answered_by_it(record_property: Any) -> None:
    world()
    ground.zone((10.01, 56.01), 0.001, name="Over there")
    a_uav("Tern")
    token = create_api_token(user=somebody(Role.ADMINISTRATOR), name="schemathesis", expires_at=timezone.now() + timedelta(hours=1))
    document = schemathesis.openapi.from_wsgi("/api/schema", WSGIHandler(), headers={"Accept": "application/vnd.oai.openapi+json"})
    operations = [found.ok() for found in document.get_all_operations()]
    asked = [operation for operation in operations if not LEFT_OUT.search(operation.path)]
    with mock.patch("workspace.tasks.current_app.send_task"):
        faults = [fault for operation in asked for fault in faults_of(operation, token)]
    record_property("figure", f"{len(asked)} operations, {EXAMPLES} requests each")
    assert not faults, "\n".join(sorted(set(faults))[:60])
