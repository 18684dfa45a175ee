"""Zone sets over the API: files of square zones, and the ways from a file to the ground."""

import json
from pathlib import Path
from typing import Any

from django.test import Client

from inspection.models import DataImport, ImportProposal, NoFlyZone
from inspection.services import import_zones
from inspection.tasks import apply_proposal, read_proposal
from tests.workspace.loopback import Server

SETS, SUBSCRIPTIONS = "/api/v1/zone-sets", "/api/v1/zone-subscriptions"


def square(west: float, south: float = 47.0, side: float = 0.1) -> dict[str, Any]:
    east, north = west + side, south + side
    return {"type": "Polygon", "coordinates": [[[west, south], [east, south], [east, north], [west, north], [west, south]]]}


def zone_file(*zones: tuple[str, float], south: float = 47.0, **collection: Any) -> bytes:
    features = [{"type": "Feature", "id": name, "properties": {"name": name}, "geometry": square(west, south)} for name, west in zones]
    return json.dumps({"type": "FeatureCollection", "features": features} | collection).encode()


def stored(folder: Path, *zones: tuple[str, float], **options: Any) -> DataImport:
    path = folder / "Works.geojson"
    path.write_bytes(zone_file(*zones))
    return import_zones(path=path, **options)


def post(client: Client, to: str, /, **values: Any) -> Any:
    return client.post(to, values, content_type="application/json")


def read(proposal: ImportProposal) -> ImportProposal:
    read_proposal(str(proposal.job_id))
    proposal.refresh_from_db()
    return proposal


def applied(client: Client, proposal: ImportProposal, **parameters: Any) -> ImportProposal:
    answer = post(client, f"/api/v1/imports/{proposal.pk}/apply", parameters=parameters)
    assert answer.status_code == 202, answer.content
    apply_proposal(answer.json()["job"]["id"])
    proposal.refresh_from_db()
    assert proposal.state == "applied"
    return proposal


def names() -> list[str]:
    return sorted(NoFlyZone.objects.values_list("name", flat=True))


def subscribed(client: Client, source: Server, **values: Any) -> dict[str, Any]:
    answer = post(client, SUBSCRIPTIONS, **{"set_name": "Works", "address": source.address("/zones.json")} | values)
    assert answer.status_code == 201, answer.content
    return answer.json()
