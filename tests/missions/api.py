"""Requests to the planning API, as JSON."""

import json
from typing import Any

from django.http import HttpResponse
from django.test import Client

from inspection.models import Asset
from tests.missions.worlds import UAV_AT

TERN = {"name": "Tern", "position": list(UAV_AT)}


def post(client: Client, path: str, body: Any = None, **headers: str) -> HttpResponse:
    """Of whatever is there, unless an ETag is given."""
    sent = {"If-Match": "*"} | headers
    return client.post(f"/api/v1/{path}", json.dumps(body or {}), content_type="application/json", headers=sent)


def patch(client: Client, path: str, body: Any, **headers: str) -> HttpResponse:
    sent = {"If-Match": "*"} | headers
    return client.patch(f"/api/v1/{path}", json.dumps(body), content_type="application/json", headers=sent)


def unlimited_type(client: Client) -> int:
    """A type whose UAVs are complete without a range."""
    return int(post(client, "uav-types", {"name": "Unlimited", "range_unlimited": True}).json()["id"])


def plan_body(*targets: Asset | dict[str, Any], **more: Any) -> dict[str, Any]:
    listed = [target if isinstance(target, dict) else {"asset": target.pk} for target in targets]
    return {"uavs": [TERN], "targets": listed, "objective": "total", "return_to_start": False} | more


def mission_body(*targets: Asset | dict[str, Any], **more: Any) -> dict[str, Any]:
    return plan_body(*targets, name="Bexley spring") | more
