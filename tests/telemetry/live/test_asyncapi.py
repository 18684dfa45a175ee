"""The AsyncAPI document says what the websockets send and take."""

import json
import time
from datetime import timedelta
from pathlib import Path
from typing import Any

import pytest
from django.conf import settings
from django.utils import timezone
from websocket import WebSocket

from config.websocket_urls import websocket_urlpatterns
from telemetry.services import store_records
from tests.accounts.users import a_user
from tests.missions.commands.outbox import a_uav
from tests.telemetry.records import record
from tests.workspace.api.described_answers import openapi_document, validate
from tests.workspace.live.proxied_site import Endpoint, close_code
from workspace.api_tokens import create_api_token
from workspace.jobs.services import create_job, finish_job, start_job
from workspace.models import User

pytestmark = pytest.mark.django_db(transaction=True)
DOCUMENT = Path(settings.BASE_DIR) / "static" / "asyncapi.json"


@pytest.fixture
def document() -> Any:
    return json.loads(DOCUMENT.read_text().replace('"/api/schema#', '"#'))


def follow(here: Endpoint, path: str, user: User) -> WebSocket:
    token = create_api_token(user=user, name="follower", expires_at=timezone.now() + timedelta(hours=1))
    return here.open(path, token=token, origin=None)


def receive(live: WebSocket, document: Any, name: str) -> Any:
    """Return the next message but heartbeats, which has to be the one that the document names so."""
    while (message := json.loads(live.recv()))["type"] == "keepalive" != name:
        validate(message, document["components"]["schemas"]["keepalive"], openapi_document())
    validate(message, document["components"]["schemas"][name], openapi_document())
    return message


def a_flying_uav() -> Any:
    uav = a_uav("Tern")
    store_records([record(uav, 1, battery_percent=80.0)])
    return uav


def test_every_reference_leads_somewhere(document: Any) -> None:
    document["components"]["schemas"] |= openapi_document()["components"]["schemas"]

    def look(value: Any) -> None:
        if isinstance(value, dict):
            if reference := value.get("$ref"):
                found = document
                for name in reference.removeprefix("#/").split("/"):
                    found = found[name]
            value = list(value.values())
        for inner in value if isinstance(value, list) else []:
            look(inner)

    look({name: part for name, part in document.items() if name != "components"})
    look(json.loads(DOCUMENT.read_text().replace('"/api/schema#', '"#'))["components"])


def test_every_websocket_is_in_the_document(document: Any) -> None:
    addresses = {"/" + str(entry.pattern).replace("<uuid:", "{").replace(">", "}") for entry in websocket_urlpatterns}
    assert {channel["address"] for channel in document["channels"].values()} == addresses


def test_the_live_feed_sends_what_the_document_says_and_takes_ack_and_resync(here: Endpoint, document: Any) -> None:
    uav, live = a_flying_uav(), follow(here, "/ws/live", a_user())
    assert receive(live, document, "snapshot")["live"]["uavs"]
    live.send('{"type": "ack", "sequence": 1}')
    store_records([record(uav, 2, longitude_deg=10.5)])
    changed = receive(live, document, "changes")
    assert [reported["id"] for reported in changed["uavs"]] == [uav.pk]
    live.send(json.dumps({"type": "ack", "sequence": changed["sequence"]}))
    live.send('{"type": "resync"}')
    assert receive(live, document, "snapshot")["sequence"] > changed["sequence"]


def test_what_the_document_does_not_name_hangs_up(here: Endpoint) -> None:
    live = follow(here, "/ws/live", a_user())
    live.send('{"type": "hello"}')
    assert close_code(live) == 4400


@pytest.mark.long
def test_a_job_is_told_as_the_document_says(here: Endpoint, document: Any) -> None:
    user = a_user()
    job = create_job(organisation=user.organisation, created_by=user, task="missions.tasks.solve_plan", parameters={}, message="Planning")
    started = start_job(job_id=job.pk)
    assert started is not None
    live = follow(here, f"/ws/jobs/{job.pk}", user)
    assert receive(live, document, "job")["job"]["state"] == "running"
    finish_job(job=started, result={"routes": []}, message="Planned")
    assert receive(live, document, "job")["job"]["state"] == "done"


@pytest.mark.long
def test_a_follower_by_the_document_stays_and_one_that_confirms_nothing_is_hung_up_on(here: Endpoint, document: Any) -> None:
    uav, user = a_flying_uav(), a_user()
    live, mute = follow(here, "/ws/live", user), follow(here, "/ws/live", user)
    live.send(json.dumps({"type": "ack", "sequence": receive(live, document, "snapshot")["sequence"]}))
    store_records([record(uav, 2, longitude_deg=10.5)])
    live.send(json.dumps({"type": "ack", "sequence": receive(live, document, "changes")["sequence"]}))
    began_s = time.monotonic()
    while time.monotonic() - began_s < 75:
        receive(live, document, "keepalive")
    assert close_code(mute) == 1013
