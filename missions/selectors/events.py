"""The event log of missions: what happened, by whom and when, read from rows that are stored anyway."""

from collections import defaultdict
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta
from typing import Any
from uuid import UUID

from django.db import connection
from django.db.models import Q
from django.utils import timezone

from missions.hooks.events import EventKind, EventPlace, EventSource, MissionEvent, registered_sources
from missions.models import InspectionTarget, Mission, MissionState, TargetState, Uav, UavCommand
from workspace.models import AuditEntry, Organisation
from workspace.reason_texts import column_text

SHOWN_AFTER_END = timedelta(hours=1)  # as live pages show missions

_STEPS = {
    "1-given": EventKind.COMMAND_GIVEN,
    "2-sent": EventKind.COMMAND_SENT,
    "3-acknowledged": EventKind.COMMAND_ACKNOWLEDGED,
}
_ENDS = {"applied": EventKind.COMMAND_DONE, "failed": EventKind.COMMAND_FAILED, "expired": EventKind.COMMAND_EXPIRED}
_COMMANDS = """
SELECT command.id::text, step.name, step.at, command.mission_id FROM missions_uavcommand command, LATERAL (VALUES
    ('1-given', command.created_at), ('2-sent', command.sent_at), ('3-acknowledged', command.acknowledged_at),
    ('4-ended', command.finished_at)
) AS step(name, at) WHERE command.mission_id = ANY(%(missions)s) AND step.at IS NOT NULL
"""

_TARGETS = """
SELECT id::text, state, state_at, mission_id FROM missions_inspectiontarget
WHERE mission_id = ANY(%(missions)s) AND state_at IS NOT NULL AND state <> 'pending'
"""
_TARGET_KINDS = {
    TargetState.IN_PROGRESS: (EventKind.TARGET_STARTED, "in progress"),
    TargetState.COMPLETE: (EventKind.TARGET_COMPLETE, "complete"),
    TargetState.SKIPPED: (EventKind.TARGET_SKIPPED, "skipped"),
    TargetState.FAILED: (EventKind.TARGET_FAILED, "failed"),
}

_ACTIONS = {
    "approve": EventKind.MISSION_APPROVED,
    "revoke": EventKind.APPROVAL_REVOKED,
    "start": EventKind.MISSION_STARTED,
    "abort": EventKind.MISSION_ABORTED,
    "close": EventKind.MISSION_CLOSED,
    "complete": EventKind.MISSION_ENDED,
    "fail": EventKind.MISSION_ENDED,
    "continue-elsewhere": EventKind.MISSION_ENDED,
    "begin-starts": EventKind.STARTS_BEGUN,
    "stop-starts": EventKind.STARTS_STOPPED,
    "replan": EventKind.OFFER_MADE,
    "replan-accepted": EventKind.OFFER_ACCEPTED,
    "replan-declined": EventKind.OFFER_DECLINED,
    "replan-outdated": EventKind.OFFER_EXPIRED,
    "replan-impossible": EventKind.OFFER_IMPOSSIBLE,
}
_WORDS = {
    "approve": "Approved",
    "revoke": "The approval was revoked",
    "start": "The mission has begun",
    "abort": "Aborted",
    "close": "Closed",
    "complete": "The mission has ended: completed",
    "fail": "The mission has ended: failed",
    "continue-elsewhere": "The mission has ended: another one continues it",
    "begin-starts": "Start in planned order",
    "stop-starts": "Start in planned order: stopped",
    "replan": "Another plan is worked out",
    "replan-accepted": "The other plan was accepted",
    "replan-declined": "The other plan was declined",
    "replan-outdated": "The other plan expired",
    "replan-impossible": "No other plan can be flown",
}
_OUT, _NOTED = "1-out", "2-noted"
# An offer that expired and was computed again at once for the same cause yields no event for either. A UAV drops out where its flight
# failed, or where the rest is replanned because of that: the first of both since its last start.
_HISTORY = f"""
SELECT entry.id::text, step.name, entry.recorded_at, entry.subject_id::uuid
FROM workspace_auditentry entry
LEFT JOIN missions_replanoffer offer ON entry.action = 'replan-outdated' AND offer.id::text = entry.after ->> 'offer'
CROSS JOIN (VALUES ('{_OUT}'), ('{_NOTED}')) AS step(name)
WHERE entry.subject_type = 'mission' AND entry.subject_id = ANY(%(names)s) AND entry.action = ANY(%(actions)s)
    AND CASE step.name WHEN '{_NOTED}' THEN entry.action <> 'fail-route' AND NOT EXISTS (
        SELECT FROM (
            SELECT action, actor_id, after FROM workspace_auditentry other
            WHERE entry.action IN ('replan', 'replan-outdated') AND entry.actor_id IS NULL AND other.subject_type = 'mission'
                AND other.subject_id = entry.subject_id
                AND CASE entry.action WHEN 'replan' THEN other.id < entry.id ELSE other.id > entry.id END
            ORDER BY abs(other.id - entry.id) LIMIT 1
        ) beside JOIN missions_replanoffer others ON others.id::text = beside.after ->> 'offer'
        WHERE beside.action IN ('replan', 'replan-outdated') AND beside.action <> entry.action AND beside.actor_id IS NULL
            AND others.cause = coalesce(offer.cause, entry.after -> 'cause')
    ) ELSE (entry.action = 'fail-route' OR (entry.action = 'replan' AND entry.after ->> 'code' = 'uav-out')) AND NOT EXISTS (
        SELECT FROM workspace_auditentry earlier
        WHERE earlier.subject_type = 'mission' AND earlier.subject_id = entry.subject_id AND earlier.id < entry.id
            AND (earlier.action = 'fail-route' OR (earlier.action = 'replan' AND earlier.after ->> 'code' = 'uav-out'))
            AND coalesce(earlier.after ->> 'uav', earlier.after -> 'cause' ->> 'uav')
                = coalesce(entry.after ->> 'uav', entry.after -> 'cause' ->> 'uav')
            AND NOT EXISTS (
                SELECT FROM missions_uavcommand command
                WHERE command.mission_id = entry.subject_id::uuid AND command.kind = 'start' AND command.state = 'applied'
                    AND command.uav_id::text = coalesce(entry.after ->> 'uav', entry.after -> 'cause' ->> 'uav')
                    AND command.finished_at BETWEEN earlier.recorded_at AND entry.recorded_at
            )
    ) END
"""  # noqa: S608 (names of steps, all constants of this module)


@dataclass(frozen=True, slots=True)
class LoggedEvent:
    """One line of the log. `event` is None if its row was deleted before it was read."""

    place: EventPlace
    event: MissionEvent | None


def missions_with_live_events(organisation: Organisation) -> list[UUID]:
    """Return the missions that live pages show: those on their way, or ended within the hour."""
    is_live = Q(state__in=[MissionState.DISPATCHED, MissionState.ACTIVE]) | Q(ended_at__gt=timezone.now() - SHOWN_AFTER_END)
    return list(Mission.objects.filter(is_live, organisation=organisation, deleted_at=None).values_list("pk", flat=True))


def events_of_missions(mission_ids: Collection[UUID], *, before: tuple[datetime, str] | None, limit: int) -> list[LoggedEvent]:
    """Return at most `limit` events, newest first; `before` is time and key of the last one already known.

    Uses one query per source and one more, whatever the number of events.
    """
    sources = {source.name: source for source in (*_OWN, *registered_sources())}
    places = _places(list(sources.values()), mission_ids, before, limit) if mission_ids else []
    by_source: dict[str, list[EventPlace]] = defaultdict(list)
    for place in places:
        by_source[place.source].append(place)
    read: dict[EventPlace, MissionEvent] = {}
    for name, of_source in by_source.items():
        read.update(sources[name].read(of_source))
    return [LoggedEvent(place, read.get(place)) for place in places]


def _places(
    sources: Sequence[EventSource], mission_ids: Collection[UUID], before: tuple[datetime, str] | None, limit: int
) -> list[EventPlace]:
    parts = " UNION ALL ".join(
        f"SELECT '{source.name}', part.* FROM ({source.statement}) AS part(row, step, at, mission_id)"  # noqa: S608 - constant texts
        for source in sources
    )
    statement = f"""
        SELECT source, row, step, at, mission_id FROM ({parts}) AS event(source, row, step, at, mission_id)
        WHERE %(at)s::timestamptz IS NULL OR (at, (source || ':' || row || ':' || step) COLLATE "C") < (%(at)s, %(key)s)
        ORDER BY at DESC, (source || ':' || row || ':' || step) COLLATE "C" DESC LIMIT %(limit)s
    """  # noqa: S608 - constant texts
    at, key = before or (None, "")
    values: dict[str, Any] = {
        "missions": list(mission_ids), "names": [str(mission_id) for mission_id in mission_ids], "at": at, "key": key, "limit": limit,
        "actions": [*_ACTIONS, "fail-route"],
    }  # fmt: skip
    with connection.cursor() as cursor:
        cursor.execute(statement, values)
        return [EventPlace(*row) for row in cursor.fetchall()]


def _read_commands(places: Sequence[EventPlace]) -> Mapping[EventPlace, MissionEvent]:
    rows = UavCommand.objects.select_related("uav", "created_by").in_bulk([UUID(place.row) for place in places])
    return {place: _of_command(row, place.step) for place in places if (row := rows.get(UUID(place.row))) is not None}


def _of_command(command: UavCommand, step: str) -> MissionEvent:
    kind = _STEPS.get(step) or _ENDS.get(command.state, EventKind.COMMAND_EXPIRED)
    who = command.created_by.display_name if command.created_by and kind is EventKind.COMMAND_GIVEN else None
    is_bad = kind in (EventKind.COMMAND_FAILED, EventKind.COMMAND_EXPIRED)
    done = kind.removeprefix("command-") + (f" by {who}" if who else "")
    why = f": {command.outcome}" if is_bad and command.outcome else f": {command.why}" if command.why and who else ""
    values = {"command": str(command.pk), "command_kind": command.kind, "why": command.why}
    if is_bad:
        values["outcome"] = column_text(command.outcome_why, command.outcome)
    return MissionEvent(
        kind, f"{command.uav.name}: {command.get_kind_display()}, {done}{why}", command.uav_id, command.uav.name, command.uav.is_simulated,
        who, "warning" if is_bad else None, values,
    )  # fmt: skip


def _read_targets(places: Sequence[EventPlace]) -> Mapping[EventPlace, MissionEvent]:
    rows = InspectionTarget.objects.only("label", "sequence", "state", "state_reason", "state_why").in_bulk(
        [int(place.row) for place in places]
    )
    found = {}
    for place in places:
        row = rows.get(int(place.row))
        if row is not None and row.state == place.step:
            kind, words = _TARGET_KINDS[TargetState(row.state)]
            reason = column_text(row.state_why, row.state_reason)
            why = f": {reason}" if reason else ""
            values = {"target": row.sequence, "label": row.label, "reason": reason}
            found[place] = MissionEvent(kind, f"{row.label}: {words}{why}", values=values)
    return found


def _read_history(places: Sequence[EventPlace]) -> Mapping[EventPlace, MissionEvent]:
    rows = AuditEntry.objects.select_related("actor").in_bulk([int(place.row) for place in places])
    uavs = Uav.objects.only("name", "is_simulated").in_bulk([uav for row in rows.values() if (uav := _uav_of(row)) is not None])
    return {place: _of_entry(row, place.step, uavs) for place in places if (row := rows.get(int(place.row))) is not None}


def _uav_of(entry: AuditEntry) -> int | None:
    """Return the only UAV that an audit entry is about, or None."""
    facts: dict[str, Any] = entry.after or {}
    found = facts.get("uav", (facts.get("cause") or {}).get("uav"))
    return found if isinstance(found, int) else None


def _of_entry(entry: AuditEntry, step: str, uavs: Mapping[int, Uav]) -> MissionEvent:
    facts: dict[str, Any] = entry.after or {}
    uav = uavs.get(_uav_of(entry) or 0)
    about: dict[str, Any] = {} if uav is None else {"uav_id": uav.pk, "uav_name": uav.name, "is_simulated": uav.is_simulated}
    if step == _OUT:
        cause = (facts.get("cause") or {}).get("alert", "") if entry.action == "replan" else "flight-failed"
        name = "A UAV" if uav is None else uav.name
        return MissionEvent(EventKind.DROP_OUT, f"{name} has dropped out", level="warning", values={"cause": cause}, **about)
    who = entry.actor.display_name if entry.actor else None
    why = facts.get("why") or facts.get("reason") or ""
    values = {"state": facts.get("state", ""), "why": why, "offer": facts.get("offer", ""), "code": facts.get("code", "")}
    message = _WORDS[entry.action] + (f" by {who}" if who else "") + (f": {why}" if why else "")
    return MissionEvent(_ACTIONS[entry.action], message, who=who, values={name: value for name, value in values.items() if value}, **about)


_OWN = (
    EventSource("command", _COMMANDS, _read_commands),
    EventSource("target", _TARGETS, _read_targets),
    EventSource("history", _HISTORY, _read_history),
)
