"""Requests that schemathesis makes from the OpenAPI document are answered by the statuses, media types and shapes that it names.

What the document allows is taken, but for rules that no schema can say; what it does not allow is refused.
"""

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
from schemathesis.generation import GenerationMode
from schemathesis.specs.openapi.checks import (
    content_type_conformance,
    negative_data_rejection,
    response_headers_conformance,
    response_schema_conformance,
    status_code_conformance,
)

from tests.accounts.users import a_user
from tests.inspection import ground
from tests.missions.commands.outbox import a_uav
from tests.missions.worlds import world
from workspace.api_tokens import create_api_token
from workspace.models import Role

pytestmark = [pytest.mark.django_db(transaction=True), pytest.mark.long]
CHECKS = [
    not_a_server_error,
    status_code_conformance,
    content_type_conformance,
    response_headers_conformance,
    response_schema_conformance,
]
PRECONDITION, TOO_LARGE = 412, 413  # answered before the rest of a request is looked at
# Rules about several fields, about what is stored, and about texts of every kind: docs/api.md says them.
BESIDE_THE_SCHEMA = re.compile(
    "A text holds a control character|is not one that this address gave|A user name is printable|At most [0-9]+ printable characters"
    "|At most [0-9]+ characters, and no control characters|There is no such tower or pole"
    "|This is no entry of its history|Say one of bbox, import_id and set|Send the file first|One height for each position"
    "|A zone needs an area or a circle|A time with its zone|south is not above north|latitude from -90 to 90"
    "|A position is longitude, then latitude|Longitude comes first|within 5 degrees of a pole|Either every_s or most"
    "|required for a UAV without an id|A target needs an asset or a position|With a battery its mass is needed"
    "|cross the 180th meridian|There is no such (upload|set)|A speed is checked|A route is as plans have it"
    "|A UAV needs a position|It encloses nothing|a geometry is an object|Only addresses that begin with"
    "|Both ends are the same tower|A side of the box is|south below north|There is no such import|A stretch needs an asset and no position"
    "|for this mass and these rotors|A position is not on the globe"
    "|There is no such (mission|target|asset|UAV|photo)|Upload-Metadata: the value of|Either Upload-Length or a body"
    "|This category says nothing without a note"
    "|The names are ids of UAVs|There is no (base|type) [0-9]"  # OpenAPI 3.0 bounds no names of an object
)
EXAMPLES = 8  # an operation
schemathesis.serializer.alias("application/offset+octet-stream", "application/octet-stream")  # of tus
LEFT_OUT = re.compile(r"/(account|users|uav-link)\b")  # they end the token that asks, or have one of their own
BOUNDED = settings(
    max_examples=EXAMPLES,
    derandomize=True,
    database=None,
    deadline=None,
    phases=[Phase.generate],
    suppress_health_check=list(HealthCheck),
)


def has_blanks(case: Any) -> bool:
    """Whether a parameter of the query is empty, which counts as one that is not there."""
    return "" in (case.query or {}).values()


def faults_of(operation: Any, token: str, mode: GenerationMode) -> list[str]:
    faults: list[str] = []

    @BOUNDED
    @given(case=operation.as_strategy(generation_mode=mode))
    def ask(case: Any) -> None:
        answer = case.call(headers={"Authorization": f"Bearer {token}"})
        is_negative = mode is GenerationMode.NEGATIVE and answer.status_code not in {PRECONDITION, TOO_LARGE} and not has_blanks(case)
        if mode is GenerationMode.POSITIVE and answer.status_code == 400 and not BESIDE_THE_SCHEMA.search(answer.text):
            faults.append(f"{operation.label}: what the document allows is refused: {answer.text[:200]} {case.query} {case.body!r:.200}")
        try:
            case.validate_response(answer, checks=[*CHECKS, *([negative_data_rejection] if is_negative else [])])
        except FailureGroup as error:
            faults.extend(f"{operation.label}: {answer.status_code} {fault.title}: {fault.message[:300]}" for fault in error.exceptions)

    ask()
    return faults


@pytest.mark.parametrize("mode", list(GenerationMode), ids=lambda mode: mode.value)
def test_what_is_asked_by_the_document_is_answered_by_it(mode: GenerationMode, record_property: Any) -> None:
    world()
    ground.zone((10.01, 56.01), 0.001, name="Over there")
    a_uav("Tern")
    token = create_api_token(user=a_user(Role.ADMINISTRATOR), name="schemathesis", expires_at=timezone.now() + timedelta(hours=1))
    document = schemathesis.openapi.from_wsgi("/api/schema", WSGIHandler(), headers={"Accept": "application/vnd.oai.openapi+json"})
    operations = [found.ok() for found in document.get_all_operations()]
    asked = [operation for operation in operations if not LEFT_OUT.search(operation.path)]
    with mock.patch("workspace.tasks.current_app.send_task"):
        faults = [fault for operation in asked for fault in faults_of(operation, token, mode)]
    record_property("figure", f"{len(asked)} operations, {EXAMPLES} requests each")
    assert not faults, "\n".join(sorted(set(faults)))
