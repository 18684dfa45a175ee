"""Whether everything that was acknowledged to a client is in the database, once. Each check returns what violates it, in words."""

from collections import Counter
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from typing import Any

from django.db import connection

from deploy.load.day.promises import Promises

AT_ONCE = 5_000
Check = Callable[[Promises], list[str]]


def rows(sql: str, values: Sequence[Any] | Mapping[str, Any] | None = None) -> list[tuple[Any, ...]]:
    with connection.cursor() as cursor:
        cursor.execute(sql, values)
        return cursor.fetchall()


def _found(sql: str, wanted: Collection[Any]) -> Iterator[tuple[Any, ...]]:
    """Rows of a statement with one array in it."""
    keys = sorted(wanted)
    for first in range(0, len(keys), AT_ONCE):
        yield from rows(sql, [keys[first : first + AT_ONCE]])


def missions_are_there_once(promised: Promises) -> list[str]:
    stored = {str(key): (is_deleted, name) for key, is_deleted, name in _found(
        "SELECT id, deleted_at IS NOT NULL, name FROM missions_mission WHERE id = ANY(%s::uuid[])", promised.missions
    )}  # fmt: skip
    lost = [f"mission {key} ({name}) is not there" for key, name in promised.missions.items() if key not in stored]
    gone = [
        f"mission {key} is deleted and nobody was told so"
        for key, (is_deleted, _) in stored.items()
        if is_deleted and key not in promised.deleted | promised.unsure
    ]
    back = [
        f"mission {key} was deleted, and is there" for key in promised.deleted - promised.unsure if key in stored and not stored[key][0]
    ]
    names = Counter(promised.missions.values())
    made = _found(
        "SELECT after->>'name', count(*) FROM workspace_auditentry WHERE subject_type = 'mission' AND action = 'create' "
        "AND after->>'name' = ANY(%s) GROUP BY 1 HAVING count(*) > 1",
        [name for name, number in names.items() if number == 1],
    )
    return lost + gone + back + [f"mission {name} was made {number} times" for name, number in made]


def edits_were_not_overwritten(promised: Promises) -> list[str]:
    """Each acknowledged edit is a revision of its own, and the history has it with what it was to say."""
    keys = Counter((mission, revision) for mission, revision, _ in promised.edits)
    twice = [f"revision {edit[1]} of mission {edit[0]} was promised to {number}" for edit, number in keys.items() if number > 1]
    history = {(mission, revision): name for mission, revision, name in _found(
        "SELECT subject_id, (after->>'revision')::int, after->>'name' FROM workspace_auditentry "
        "WHERE subject_type = 'mission' AND after ? 'revision' AND after ? 'name' AND subject_id = ANY(%s)",
        {edit[0] for edit in promised.edits},
    )}  # fmt: skip
    lost = [
        f"revision {revision} of mission {mission} is not in its history as {name}"
        for mission, revision, name in promised.edits
        if history.get((mission, revision)) != name
    ]
    return twice + lost


def jobs_ended_as_reported(promised: Promises) -> list[str]:
    stored = {str(key): (state, has_result) for key, state, has_result in _found(
        "SELECT id, state, result IS NOT NULL FROM workspace_job WHERE id = ANY(%s::uuid[])", promised.jobs | promised.plans
    )}  # fmt: skip
    lost = [f"job {key} is not there" for key in promised.jobs | promised.plans if key not in stored]
    changed = [f"job {key} was done, and is {stored[key][0]}" for key in promised.plans if key in stored and stored[key] != ("done", True)]
    return lost + changed


def approvals_are_as_approved(promised: Promises) -> list[str]:
    stored = {str(key): (str(mission), sha256) for key, mission, sha256 in _found(
        "SELECT id, mission_id, content_sha256 FROM missions_approval WHERE id = ANY(%s::uuid[])", promised.approvals
    )}  # fmt: skip
    return [
        f"approval {key} is {stored.get(key, 'not there')}" for key, reported in promised.approvals.items() if stored.get(key) != reported
    ]


def commands_are_there_once(promised: Promises) -> list[str]:
    stored, ended = _states(promised.commands), _states(promised.ends)
    lost = [f"command {key} is not there" for key in promised.commands if key not in stored]
    keys = Counter(key for key in promised.commands.values() if key)
    twice = [f"key {key} gave {number} commands" for key, number in keys.items() if number > 1]
    otherwise = [f"command {key} was {state}, and is {ended.get(key)}" for key, state in promised.ends.items() if ended.get(key) != state]
    return lost + twice + otherwise


def _states(commands: Collection[str]) -> dict[str, str]:
    return {str(key): state for key, state in _found("SELECT id, state FROM missions_uavcommand WHERE id = ANY(%s::uuid[])", commands)}


def records_are_there(promised: Promises) -> list[str]:
    return _numbered("telemetry_telemetryrecord", "record", promised.records)


def results_are_there(promised: Promises) -> list[str]:
    return _numbered("telemetry_inspectionresult", "result", promised.results)


def _numbered(table: str, what: str, wanted: dict[tuple[int, str], set[int]]) -> list[str]:
    """Counting alone would take two that are twice for two that are lost."""
    lost = []
    for (uav, stream), sequences in wanted.items():
        stored = Counter(number for (number,) in rows(
            f"SELECT sequence FROM {table} stored JOIN telemetry_telemetrystream run ON run.id = stored.stream_id "  # noqa: S608 (our tables)
            "WHERE run.uav_id = %s AND run.key = %s", [uav, stream]
        ))  # fmt: skip
        missing = sorted(sequences - stored.keys())
        if missing:
            lost.append(f"{len(missing)} acknowledged {what}s of UAV {uav} in {stream} are lost: {missing[:5]}")
        twice = sorted(number for number, times in stored.items() if times > 1)
        if twice:
            lost.append(f"{len(twice)} {what}s of UAV {uav} in {stream} are stored more than once: {twice[:5]}")
    return lost


def flights_ended_as_reported(promised: Promises) -> list[str]:
    """The route has flown it, or the approval no longer counts; and what it was the last flight of is not on its way."""
    stored = {(uav, str(approval)): (flown, state) for uav, approval, flown, state in rows(
        "SELECT place.uav_id, approval.id, route.flights_flown, mission.state FROM missions_approval approval "
        "JOIN missions_mission mission ON mission.id = approval.mission_id JOIN missions_missionuav place ON place.mission_id = mission.id "
        "JOIN missions_route route ON route.mission_uav_id = place.id WHERE approval.revoked_at IS NULL AND approval.id = ANY(%s::uuid[])",
        [sorted({approval for _, approval, _ in promised.flights})],
    )}  # fmt: skip
    found = ((flight, stored.get(flight[:2])) for flight in promised.flights)
    return [
        f"flight {flight[2]} of UAV {flight[0]} was told to be over: {now}"
        for flight, now in found
        if now is None or (now[0] < flight[2] and now[1] not in {"aborted", "failed"})
    ]


def acknowledgements_are_there(promised: Promises) -> list[str]:
    """Also where the alert has risen since, and waits to be acknowledged anew: its course keeps the first one."""
    stored = dict(
        _found(
            "SELECT id, (SELECT count(*) FROM jsonb_array_elements(course) step WHERE step->>'what' = 'acknowledged') "
            "FROM telemetry_alert WHERE id = ANY(%s)",
            promised.acknowledged,
        )
    )
    return [f"alert {key} was acknowledged, and its course says nothing of it" for key in promised.acknowledged if not stored.get(key)]


def notes_are_there_once(promised: Promises) -> list[str]:
    stored = dict(_found("SELECT id, text FROM telemetry_alertnote WHERE id = ANY(%s)", promised.notes))
    lost = [f"note {key} is not there as it was written" for key, text in promised.notes.items() if stored.get(key) != text]
    often = "SELECT text, count(*) FROM telemetry_alertnote WHERE text = ANY(%s) GROUP BY 1 HAVING count(*) > 1"
    twice = _found(often, set(promised.notes.values()))
    return lost + [f"note {text} is there {number} times" for text, number in twice]


def zones_are_as_reported(promised: Promises) -> list[str]:
    stored = dict(_found("SELECT id, name FROM inspection_noflyzone WHERE id = ANY(%s)", promised.zones))
    lost = [
        f"zone {key} is not there"
        for key in promised.zones
        if key not in stored and key not in promised.zones_gone and str(key) not in promised.unsure
    ]
    return lost + [f"zone {key} was taken away, and is there" for key in promised.zones_gone if key in stored]


def pages_saw_no_gap(promised: Promises) -> list[str]:
    return promised.gaps


CHECKS: dict[str, Check] = {
    "acknowledged missions are there, each once": missions_are_there_once,
    "acknowledged edits are in the history, none over another": edits_were_not_overwritten,
    "acknowledged jobs are there; a plan that was fetched is kept": jobs_ended_as_reported,
    "approvals are as they were approved": approvals_are_as_approved,
    "acknowledged commands are there, one a key, and ended as told": commands_are_there_once,
    "acknowledged records are there, each once": records_are_there,
    "acknowledged results are there, each once": results_are_there,
    "flights ended as told": flights_ended_as_reported,
    "acknowledgements of alerts are there": acknowledgements_are_there,
    "notes are there, each once": notes_are_there_once,
    "zones came and went as told": zones_are_as_reported,
    "live pages saw no gap": pages_saw_no_gap,
}
