"""What a UAV gets when it asks: its route as it was approved, and the commands that wait for it."""

from collections.abc import Sequence
from typing import Any

from missions.models import UavCommand
from missions.services.dispatch import ApprovedLoad


def given_json(*, uav_id: int, upload: UavCommand | None, load: ApprovedLoad | None, waiting: Sequence[UavCommand]) -> dict[str, Any]:
    return {
        "uav": uav_id,
        "route": _route(upload, load) if upload and load else None,
        "commands": [
            {
                "id": command.pk,
                "sequence": command.sequence,
                "kind": command.kind,
                "priority": command.priority,
                "parameters": command.parameters,
                "expires_at": command.expires_at,
            }
            for command in waiting
        ],
    }


def _route(upload: UavCommand, load: ApprovedLoad) -> dict[str, Any]:
    assert upload.approval is not None  # noqa: S101 - the database keeps it
    document = upload.approval.document
    content = load.content
    assert content is not None  # noqa: S101 - a UAV with a companion computer
    visited = {waypoint["target"] for waypoint in content["waypoints"]}
    return {
        "command": upload.pk,
        "mission": load.mission,
        "mission_name": document["mission"]["name"],
        "approval": load.approval,
        "flights": load.flights,
        "content": content,
        "content_sha256": load.content_sha256,
        "targets": [_target(target) for target in document["targets"] if target["sequence"] in visited],
    }


def _target(target: dict[str, Any]) -> dict[str, Any]:
    stretch = target["stretch"]
    return {
        "place": target["sequence"],
        "label": target["label"],
        "kind": target["kind"],
        "task": target["task"],
        "position": target["position"],
        "stretch": {"type": "LineString", "coordinates": stretch} if stretch else None,
        "geometry": target["geometry"],
    }
