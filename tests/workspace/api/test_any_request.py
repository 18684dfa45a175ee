"""Whatever is sent to the API is answered by a status that it describes, and never by a fault of its own (findings: S11)."""

import random
from collections import Counter
from typing import Any
from unittest import mock

import pytest
from django.test import Client
from drf_spectacular.generators import SchemaGenerator

from inspection.models import Asset, NoFlyZone
from tests.accounts.users import a_user, client_of
from tests.inspection import ground
from tests.missions.worlds import world
from tests.workspace.api.described_requests import Maker, Request
from tests.workspace.test_foreign_rows import rows_of
from workspace.models import Organisation, Role

pytestmark = pytest.mark.django_db(transaction=True)

SEED = 11
HEADERS = ("ETag", "Location", "Retry-After", "RateLimit", "RateLimit-Policy", "Idempotency-Replayed", "WWW-Authenticate")


class Known:
    """Ids that there are, or were, by the names that addresses and bodies have for them."""

    def __init__(self) -> None:
        here = world()
        ground.zone((10.01, 56.01), 0.001, name="Over there")
        self._chance = random.Random(SEED)
        self._ids = {name.split(" of ")[0]: [row.pk] for name, row in rows_of(Organisation.objects.get(pk=1)).items()}
        self._ids |= {"asset_id": list(Asset.objects.values_list("pk", flat=True)), "zone_id": [NoFlyZone.objects.get().pk]}
        self._ids |= {
            "zoom": [12, 14],
            "column": [2162],
            "row": [1262],
            "kind": ["csv", "gpx"],
            "position": [[10.0, 56.0]],
            "line": [here.line.pk],
        }
        self._ids |= {name: self._ids[f"{name}_id"] for name in ("asset", "uav", "mission", "base", "job", "type", "simulation")}

    def __call__(self, name: str) -> Any | None:
        if not (ids := self._ids.get(name)):
            return None
        found = self._chance.choice(ids)
        return found if isinstance(found, int | list) else str(found)


def answered(client: Client, request: Request) -> Any:
    return client.generic(
        request.method,
        request.path,
        request.body or "",
        content_type=request.media_type,
        headers={"X-Request-ID": "any-request", **request.headers},
    )


@pytest.mark.parametrize("number", [200, pytest.param(20_000, marks=pytest.mark.long)])
def test_every_request_is_answered_as_it_is_described(number: int, record_property: Any) -> None:
    maker = Maker(SchemaGenerator().get_schema(request=None, public=True), SEED + number, Known())
    client, uav_link = client_of(a_user(Role.ADMINISTRATOR)), Client(raise_request_exception=False)
    statuses: Counter[int] = Counter()
    faults: list[str] = []
    undescribed: set[str] = set()
    with mock.patch("workspace.tasks.current_app.send_task"):
        for request in maker.requests(number):
            answer = answered(uav_link if "/uav-link/" in request.path else client, request)
            if answer.status_code == 401 and "/uav-link/" not in request.path:  # it has signed itself out, or taken its own role
                client = client_of(a_user(Role.ADMINISTRATOR))
                answer = answered(client, request)
            statuses[answer.status_code] += 1
            described_headers = request.described.get(answer.status_code, frozenset())
            if hidden := [name for name in HEADERS if name in answer and name not in described_headers]:
                undescribed.add(f"{answer.status_code} {request.method} {request.template} {hidden}")
            if (answer.status_code >= 500 and answer.status_code != 503) or answer.status_code not in request.described:
                faults.append(f"{answer.status_code} {request.method} {request.template} {request.path[:200]} {str(request.body)[:500]}")
    record_property("figure", f"{number:,} requests to {maker.operations} operations: {dict(sorted(statuses.items()))}")
    assert not faults, "\n".join(faults[:40])
    assert not undescribed, "\n".join(sorted(undescribed))
    assert sum(count for status, count in statuses.items() if status < 300) > number // 10, "most would be refused at the door"
