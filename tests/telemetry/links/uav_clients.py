"""UAVs that speak over the HTTP link, and what they say."""

import json
from datetime import UTC, datetime, timedelta
from typing import Any

from django.http import HttpResponse
from django.test import Client

from missions.models import CredentialKind, LinkKind, Uav
from missions.services import make_credential
from tests.accounts.users import a_user
from tests.missions.commands.outbox import a_uav
from workspace.models import Organisation

LINK = "/api/v1/uav-link"


class UavClient:
    """A UAV's own side of the link."""

    def __init__(self, uav: Uav, token: str) -> None:
        self.uav = uav
        self.token = token
        self.client = Client(raise_request_exception=False)

    @property
    def headers(self) -> dict[str, str]:
        return {"Authorization": f"Bearer {self.token}"}

    def get(self, what: str, **headers: str) -> HttpResponse:
        return self.client.get(f"{LINK}/{what}", headers=self.headers | headers)

    def post(self, what: str, body: Any, **headers: str) -> HttpResponse:
        """`body` may hold NaN, as many a JSON writer writes it."""
        return self.client.post(f"{LINK}/{what}", json.dumps(body), content_type="application/json", headers=self.headers | headers)

    def report(self, *records: Any, stream: str = "boot-1") -> HttpResponse:
        return self.post("telemetry", {"stream": stream, "records": list(records)})


def linked_uav(name: str = "Kite", organisation: Organisation | None = None, **facts: Any) -> UavClient:
    uav = a_uav(name, organisation, **{"link": LinkKind.HTTP, **facts})
    made = make_credential(uav=uav, actor=a_user(), kind=CredentialKind.LINK_TOKEN)
    return UavClient(uav, made.secret)


def seconds_ago(seconds: float) -> str:
    return (datetime.now(UTC) - timedelta(seconds=seconds)).isoformat()


def report(sequence: int = 1, **values: Any) -> dict[str, Any]:
    """Measured a second ago at the place of the test's UAVs, unless told."""
    return {"sequence": sequence, "measured_at": seconds_ago(1), "position": [10.001, 55.995], "altitude_amsl_m": 80.0} | values
