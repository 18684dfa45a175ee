"""What a UAV has been given over the HTTP link, read from the outbox and the approvals."""

from collections.abc import Collection
from dataclasses import dataclass
from uuid import UUID

from django.db.models import Q

from missions.models import Approval, CommandKind, CommandState, LinkKind, MissionState, Route, UavCommand
from workspace.prepared_statements import prepared_rows

FLOWN_IN = (MissionState.APPROVED, MissionState.DISPATCHED, MissionState.ACTIVE)


@dataclass(frozen=True)
class Given:
    """Commands of a UAV: `upload` is the one whose route it flies, `waiting` the unfinished ones, most urgent first."""

    upload: UUID | None
    waiting: tuple[UUID, ...]
    has_unclaimed: bool


# A command that was delivered and not answered is not delivered again after it expired: a late start would be a surprise.
_OPEN = """
    command.state IN ('queued', 'sent', 'acknowledged') AND (command.expires_at IS NULL OR command.expires_at > statement_timestamp()
        OR (command.acknowledged_at IS NOT NULL AND command.lease_expires_at > statement_timestamp()))"""
_OWN = f"""command.uav_id = %s AND command.link = '{LinkKind.HTTP.value}'
    AND EXISTS (SELECT FROM missions_uav AS uav WHERE uav.id = command.uav_id AND uav.link = '{LinkKind.HTTP.value}')"""
# The latest mission command counts: an upload or a clearing that was neither refused nor expired.
_GIVEN = f"""
    SELECT
        (SELECT CASE WHEN command.kind = '{CommandKind.UPLOAD_MISSION.value}' AND approval.revoked_at IS NULL AND mission.deleted_at IS NULL
                AND mission.state IN ({", ".join(f"'{state.value}'" for state in FLOWN_IN)}) THEN command.id END
            FROM missions_uavcommand AS command LEFT JOIN missions_approval AS approval ON approval.id = command.approval_id
                LEFT JOIN missions_mission AS mission ON mission.id = command.mission_id
            WHERE {_OWN} AND command.axis = 'mission' AND (command.state = '{CommandState.APPLIED.value}' OR {_OPEN})
            ORDER BY command.sequence DESC LIMIT 1),
        ARRAY(SELECT command.id FROM missions_uavcommand AS command WHERE {_OWN} AND {_OPEN}
            ORDER BY command.priority, command.created_at, command.sequence),
        EXISTS (SELECT 1 FROM missions_uavcommand AS command WHERE {_OWN} AND {_OPEN}
            AND (command.lease_expires_at IS NULL OR command.lease_expires_at <= statement_timestamp()))"""  # noqa: S608 - of constants


def given_to(uav_id: int) -> Given:
    """Return what a UAV should have, with one query: every UAV polls every few seconds."""
    ((upload, waiting, has_unclaimed),) = prepared_rows(_GIVEN, [uav_id, uav_id, uav_id])
    return Given(upload, tuple(waiting), has_unclaimed)


def commands_by_key(keys: tuple[UUID, ...]) -> list[UavCommand]:
    """Return commands in the order of the keys."""
    found = UavCommand.objects.in_bulk(keys)
    return [found[key] for key in keys if key in found]


def approvals_given_to(uav_id: int, keys: Collection[UUID]) -> dict[UUID, Approval]:
    """Return those of these approvals that were sent to this UAV, with their missions, in force or not."""
    uploads = UavCommand.objects.filter(uav_id=uav_id, approval__in=keys, kind=CommandKind.UPLOAD_MISSION)
    return Approval.objects.select_related("mission").in_bulk(set(uploads.values_list("approval", flat=True)))


def places_of_targets(uav_id: int, approval: Approval) -> frozenset[int]:
    """Return the targets on this UAV's approved route, as places in the mission's list."""
    (route,) = [route for route in approval.document["routes"] if route["uav"] == uav_id]
    return frozenset(waypoint["target"] for waypoint in route["route"]["waypoints"] if waypoint["target"] is not None)


def number_of_flights(uav_id: int, approval: Approval) -> int:
    """Return the number of flights of this UAV's approved route."""
    (route,) = [route for route in approval.document["routes"] if route["uav"] == uav_id]
    return len(route["flights"])


def is_end_known(uav_id: int, approval: Approval, flight: int) -> bool:
    """Whether the end of this flight of the UAV's route, counted from 1, has been reported before."""
    routes = Route.objects.filter(mission=approval.mission_id, mission_uav__uav=uav_id)
    return routes.filter(Q(has_failed=True) | Q(flights_flown__gte=flight)).exists()
