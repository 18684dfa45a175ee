"""Leases of UAVs by gateways, and the link states that gateways store.

Another gateway may take a UAV when the lease has expired or when the holder has not received the vehicle for a while. One with the same
name may also take it when the lease was not renewed for a while: it is the same gateway, restarted. Two gateways with one name by mistake
do not take UAVs from each other.
"""

import json
from collections.abc import Collection, Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Any

from django.db import connection
from django.db.models import Q

from missions.services.commands.commands import release_claims_of_others
from telemetry.models import UavLink
from telemetry.services.waypoints import lists_on
from workspace.leases import from_now, is_free_for, release, renew, take

NAMESAKE_S = 2.5  # a running gateway renews its leases more often
UNREACHABLE_S = 5.0  # if a holder has not received the vehicle for so long, another gateway need not wait for its lease to end


@dataclass(frozen=True)
class Lease:
    """A lease with the previous gateway's state: `signing`, `boots`, `losses`, `limits` and `cameras` as in UavLink.

    `mode_in_air` is the vehicle's last mode if it was armed and in the air, else empty. `mission_item` is the item at that time, as the
    vehicle counts.
    """

    uav_id: int
    signing: dict[str, Any]
    boots: list[dict[str, Any]]
    losses: dict[str, int]
    loaded_sha256: str
    limits: dict[str, float] = field(default_factory=dict)
    cameras: list[dict[str, Any]] = field(default_factory=list)
    mode_in_air: str = ""
    mission_item: int | None = None


@dataclass(frozen=True)
class LinkState:
    """State of a vehicle's link, with the fields of UavLink. `last_message_ago_s` is relative, so that gateways' clocks do not matter.

    `waypoint_sequence` is computed when the state is saved.
    """

    uav_id: int
    last_message_ago_s: float
    address: str
    autopilot: str
    firmware: str
    mode: str
    is_armed: bool | None
    is_in_air: bool | None
    home_longitude_deg: float | None
    home_latitude_deg: float | None
    home_amsl_m: float | None
    mission_item: int | None
    clock_offset_s: float | None
    clock_rate: float | None
    boots: list[dict[str, Any]] = field(default_factory=list)
    signing: dict[str, Any] = field(default_factory=dict)
    losses: dict[str, int] = field(default_factory=dict)
    limits: dict[str, float] = field(default_factory=dict)
    cameras: list[dict[str, Any]] = field(default_factory=list)
    waypoint_sequence: int | None = None
    vehicle_type: int | None = None
    battery_state: str = ""
    received_bytes_s: float | None = None
    received_messages_s: float | None = None


_ADD = """
INSERT INTO telemetry_uavlink (uav_id, holder, address, autopilot, firmware, mode, loaded_sha256, boots, signing, losses, limits)
SELECT uav.id, '', '', '', '', '', '', '[]', '{}', '{}', '{}' FROM missions_uav uav WHERE uav.id = ANY(%s) ORDER BY uav.id
ON CONFLICT (uav_id) DO NOTHING
"""


def take_leases(*, uav_ids: Collection[int], holder: str, lease_s: float) -> list[Lease]:
    """Return leases of those UAVs that this gateway may serve and whose commands no other gateway delivers. holder: "name/run"."""
    with connection.cursor() as cursor:
        cursor.execute(_ADD, [sorted(uav_ids)])
    may_take = is_free_for(holder, lease_s=lease_s, namesake_s=NAMESAKE_S) | Q(last_message_at__lt=from_now(-UNREACHABLE_S))
    links = take(UavLink.objects.filter(may_take, uav__in=uav_ids), holder=holder, lease_s=lease_s)
    release_claims_of_others(uav_ids=[link.uav_id for link in links], holder=holder)
    return [_lease_of(link) for link in links]


def renew_leases(*, uav_ids: Collection[int], holder: str, lease_s: float) -> set[int]:
    """Return the UAVs still held."""
    return set(renew(UavLink.objects.filter(uav__in=uav_ids, holder=holder), lease_s=lease_s))


def release_leases(*, holder: str) -> None:
    release(UavLink.objects.filter(holder=holder), holder="")


def _lease_of(link: UavLink) -> Lease:
    was_in_air = link.is_armed and link.is_in_air
    return Lease(
        uav_id=link.uav_id,
        signing=link.signing,
        boots=link.boots,
        losses=link.losses,
        loaded_sha256=link.loaded_sha256,
        limits=link.limits,
        cameras=link.cameras,
        mode_in_air=link.mode if was_in_air else "",
        mission_item=link.mission_item,
    )


_TYPES = {
    "uav_id": "int8", "is_armed": "bool", "is_in_air": "bool", "mission_item": "int4", "waypoint_sequence": "int4", "vehicle_type": "int2",
    "boots": "jsonb", "signing": "jsonb", "losses": "jsonb", "limits": "jsonb", "cameras": "jsonb",
    "address": "text", "autopilot": "text", "firmware": "text", "mode": "text", "battery_state": "text",
}  # fmt: skip
_COLUMNS = {column.name: _TYPES.get(column.name, "float8") for column in fields(LinkState)}
_MADE = ("uav_id", "last_message_ago_s", "home_longitude_deg", "home_latitude_deg")
_SAVE = f"""
UPDATE telemetry_uavlink link
SET {", ".join(f"{name} = heard.{name}" for name in _COLUMNS if name not in _MADE)},
    heard_at = statement_timestamp() - make_interval(secs => last_message_ago_s),
    home = ST_SetSRID(ST_MakePoint(home_longitude_deg, home_latitude_deg), 4326)
FROM unnest({", ".join(f"%s::{kind}[]" for kind in _COLUMNS.values())}) AS heard({", ".join(_COLUMNS)})
WHERE link.uav_id = heard.uav_id AND link.holder = %s
"""  # noqa: S608 (column names, all from here)


def save_links(*, states: Sequence[LinkState], holder: str) -> None:
    """Save the states of UAVs that the gateway still holds."""
    if not states:
        return
    lists = lists_on({state.uav_id for state in states if state.mission_item is not None})
    states = [
        replace(state, waypoint_sequence=lists[state.uav_id].waypoint_of(state.mission_item)) if state.uav_id in lists else state
        for state in states
    ]
    columns = [[_stored(getattr(state, name), kind) for state in states] for name, kind in _COLUMNS.items()]
    with connection.cursor() as cursor:
        cursor.execute(_SAVE, [*columns, holder])


def _stored(value: Any, kind: str) -> Any:
    return json.dumps(value) if kind == "jsonb" else value
