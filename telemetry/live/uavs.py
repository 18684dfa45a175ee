"""UAVs of live pages: link, measured and estimated values."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from django.db.models import Case, F, IntegerField, OuterRef, Subquery, Value, When

from missions.models import LinkKind, MissionState, MissionUav, Uav
from missions.selectors.commands import route_commands
from missions.services.commands.call_signs import colour_of
from telemetry.alerting.detectors.link import late_after_s
from telemetry.alerting.limits import sound_limits
from telemetry.estimation.link_model import SILENT_INTERVALS, SILENT_S
from telemetry.models import UavLink

FLYING = (MissionState.ACTIVE, MissionState.DISPATCHED)
MEASURED = (
    "position", "altitude_relative_m", "altitude_amsl_m", "altitude_agl_m", "speed_mps", "climb_mps", "heading_deg", "roll_deg",
    "pitch_deg", "battery_percent", "mode", "is_armed", "is_in_air", "gps_fix", "satellites", "hdop", "link_quality_percent",
    "wind_speed_mps", "wind_from_deg", "waypoint_sequence",
)  # fmt: skip
INTERVALS_S = {LinkKind.MAVLINK: 1.0, LinkKind.HTTP: 10.0}  # assumed intervals between reports
GROUPS = ("position", "height", "speed", "attitude", "battery", "state", "link", "gps", "wind", "waypoint")


def uavs_json(uav_ids: Iterable[int]) -> list[dict[str, Any]]:
    uavs = Uav.objects.filter(pk__in=list(uav_ids)).select_related("connection", "watch", "uav_type")
    flown = _flown([uav.pk for uav in uavs])
    return [_uav_json(uav, flown.get(uav.pk)) for uav in uavs]


def measured_json(stored: Mapping[str, Mapping[str, Any]] | None) -> dict[str, Any] | None:
    """Return the newest values, flat; `measured_at_of` has the time of each group, null if never reported."""
    if not stored:
        return None
    values = {name: value for group in stored.values() for name, value in group.items()}
    newest = stored["report"]
    return {
        "measured_at": newest["measured_at"],
        "received_at": newest["received_at"],
        **{name: values.get(name) for name in MEASURED},
        "measured_at_of": {group: stored[group]["measured_at"] if group in stored else None for group in GROUPS},
    }


def rhythm_of(interval_s: float, stated: Sequence[Mapping[str, float]]) -> dict[str, float]:
    """Return the interval of its reports, and the ages at which the last one is late, as in alerts, and at which the UAV is silent.

    stated: alert limits, later ones overriding earlier ones.
    """
    late_s = late_after_s(sound_limits(stated), interval_s)
    silent_s = max(late_s, SILENT_S, SILENT_INTERVALS * interval_s)
    return {"interval_s": round(interval_s, 1), "late_after_s": round(late_s, 1), "silent_after_s": round(silent_s, 1)}


def _flown(uav_ids: list[int]) -> dict[int, tuple[str, int, int, Mapping[str, float]]]:
    """Return the mission that each UAV flies, as in selectors/live.py, its place and colour there, and the mission's alert limits."""
    rows = MissionUav.objects.filter(uav__in=uav_ids, mission__state__in=FLYING, mission__deleted_at=None, route__geometry__isnull=False)
    sent = Subquery(route_commands(OuterRef("uav")).values("mission")[:1])
    first = Case(
        When(route__continued_by__isnull=False, then=Value(3)),
        When(mission=F("sent"), then=Value(0)),
        When(mission__state=MissionState.ACTIVE, then=Value(1)),
        default=Value(2),
        output_field=IntegerField(),
    )
    newest = rows.alias(sent=sent).order_by("uav", first, F("mission__updated_at").desc()).distinct("uav")
    found = newest.values_list("uav", "mission", "sequence", "mission__colours", "mission__alert_limits")
    return {uav: (str(mission), place, colour_of(place, colours), limits or {}) for uav, mission, place, colours, limits in found}


def _uav_json(uav: Uav, flown: tuple[str, int, int, Mapping[str, float]] | None) -> dict[str, Any]:
    watch = getattr(uav, "watch", None)
    mission, place, colour, limits = flown or (None, None, None, {})
    of_type = uav.uav_type.alert_limits if uav.uav_type is not None else {}
    interval_s = ((watch.estimated or {}).get("report_interval_s") if watch else None) or INTERVALS_S[LinkKind(uav.link)]
    return {
        "id": uav.pk,
        "name": uav.name,
        "mission": mission,
        "place": place,
        "colour": colour,
        "link": _link_json(uav.link, getattr(uav, "connection", None) or UavLink()),
        "measured": measured_json(watch.measured) if watch else None,
        "estimated": watch.estimated if watch else None,
        "rhythm": rhythm_of(interval_s, [of_type or {}, limits]),
        "is_simulated": uav.is_simulated,
    }


def _link_json(kind: str, link: UavLink) -> dict[str, Any]:
    loaded = {
        "approval": link.loaded_approval,
        "flight": link.loaded_flight,
        "read_at": link.loaded_read_at,
        "doubt": link.loaded_doubt,
    }
    return {
        "kind": kind,
        "last_message_at": link.last_message_at,
        "mode": link.mode,
        "is_armed": link.is_armed,
        "is_in_air": link.is_in_air,
        "autopilot": link.autopilot,
        "loaded": loaded if link.loaded_sha256 else None,
        "waypoint_sequence": link.waypoint_sequence,
        "clock_rate": None if link.clock_rate is None else round(link.clock_rate, 1),
    }
