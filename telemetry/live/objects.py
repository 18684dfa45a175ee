"""Objects of live pages: one JSON text each, in the reader's language."""

from collections import defaultdict
from collections.abc import Callable, Iterable
from typing import Any
from uuid import UUID

import orjson
from django.db.models import Count
from django.utils import translation

from missions.models import InspectionTarget, Mission, MissionUav, ReplanOffer, TargetState, UavCommand, Waypoint
from missions.serializers.commands import command_json
from missions.serializers.replan_offers import offer_outcome, render_difference, revision_of_offer
from planning.trajectory.waypoints import WaypointKind
from telemetry.live.uavs import uavs_json
from telemetry.models import Alert
from telemetry.selectors.live import Key
from telemetry.serializers.alerts import alert_json
from workspace.reason_texts import column_text

SAME_IN_ALL = ""  # language key of objects without text


def missions_json(mission_ids: Iterable[UUID]) -> list[dict[str, Any]]:
    missions = list(Mission.objects.filter(pk__in=list(mission_ids)))
    ids = [mission.pk for mission in missions]
    targets: dict[UUID, list[InspectionTarget]] = defaultdict(list)
    for target in InspectionTarget.objects.filter(mission__in=ids).defer("position", "stretch", "task"):
        targets[target.mission_id].append(target)
    uavs: dict[UUID, list[dict[str, Any]]] = defaultdict(list)
    flying = MissionUav.objects.filter(mission__in=ids, route__geometry__isnull=False)
    for mission, place, name, uav in flying.values_list("mission", "sequence", "name", "uav"):
        uavs[mission].append({"place": place, "name": name, "uav": uav})
    places = _places(ids)
    return [_mission_json(mission, uavs[mission.pk], targets[mission.pk], places) for mission in missions]


def _places(mission_ids: list[UUID]) -> dict[int, int]:
    """Return the place of the assigned UAV by target."""
    visits = Waypoint.objects.filter(route__mission__in=mission_ids, kind=WaypointKind.TARGET)
    return dict(visits.order_by().values_list("target", "route__mission_uav__sequence"))


def _mission_json(mission: Mission, uavs: list[dict[str, Any]], targets: list[InspectionTarget], places: dict[int, int]) -> dict[str, Any]:
    return {
        "id": mission.pk,
        "name": mission.name,
        "call_number": mission.call_number,
        "colours": mission.colours,
        "state": mission.state,
        "revision": mission.revision,
        "departs_at": mission.departs_at,
        "started_at": mission.started_at,
        "ended_at": mission.ended_at,
        "uavs": uavs,
        "targets": [
            {
                "place": target.sequence,
                "label": target.label,
                "state": target.state,
                "state_at": target.state_at,
                "state_reason": column_text(target.state_why, target.state_reason),
                "uav": places.get(target.pk),
            }
            for target in targets
        ],
        "counts": {"complete": sum(target.state == TargetState.COMPLETE for target in targets), "all": len(targets)},
    }


def language_of(kind: str, language: str) -> str:
    """Return the language in which objects of a kind are stored for a reader of `language`."""
    return SAME_IN_ALL if kind == "uavs" else language


def texts_of(keys: Iterable[Key], language: str) -> dict[Key, str]:
    """Return the texts of the objects that still exist."""
    by_kind: dict[str, list[str]] = defaultdict(list)
    for kind, key in keys:
        by_kind[kind].append(key)
    with translation.override(language or None):
        return {
            (kind, str(found["id"])): orjson.dumps(found, default=str).decode()
            for kind, ids in by_kind.items()
            for found in _READ[kind](ids)
        }


def _alerts(ids: list[str]) -> list[dict[str, Any]]:
    alerts = Alert.objects.filter(pk__in=ids).select_related("acknowledged_by", "uav").annotate(note_count=Count("notes"))
    return [alert_json(alert, note_count=alert.note_count) for alert in alerts]


def _commands(ids: list[str]) -> list[dict[str, Any]]:
    return [command_json(command) for command in UavCommand.objects.filter(pk__in=ids).select_related("uav", "created_by")]


def _offers(ids: list[str]) -> list[dict[str, Any]]:
    return [
        {
            "id": offer.pk,
            "mission": offer.mission_id,
            "code": offer.code,
            "state": offer.state,
            "revision": revision_of_offer(offer),
            "cause": offer.cause,
            "difference": render_difference(offer.difference),
            "continuation": offer.continuation_id,
            "created_at": offer.created_at,
            "decided_by": None if offer.decided_by is None else offer.decided_by.username,
            "decided_at": offer.decided_at,
            **offer_outcome(offer),
        }
        for offer in ReplanOffer.objects.filter(pk__in=ids).select_related("decided_by")
    ]


_READ: dict[str, Callable[[list[Any]], list[dict[str, Any]]]] = {
    "uavs": uavs_json,
    "missions": missions_json,
    "alerts": _alerts,
    "commands": _commands,
    "offers": _offers,
}
