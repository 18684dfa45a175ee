"""Each invariant of a working day, violated on purpose, is named: a check that cannot fail would hide what was lost."""

from collections.abc import Callable
from datetime import timedelta
from pathlib import Path
from typing import Any
from uuid import uuid4

import pytest
from django.db import connection
from django.db.models import Model
from django.utils import timezone

from deploy.load.day import book as kinds
from deploy.load.day.book import Book, lines
from deploy.load.day.promises import Promises, promises_of
from deploy.load.invariants import check_invariants, check_invariants_here
from missions.models import Approval, Mission, Uav, UavCommand, UavCommandEvent
from missions.services import MissionChange, change_mission, create_mission
from telemetry.models import AlertLevel, AlertNote, InspectionResult, TelemetryRecord
from telemetry.services.alerts.alerts import acknowledge_alert, note_alert, open_alert
from telemetry.services.links.companion_reports import take_reports
from telemetry.services.results import EndedFlight, NewResult, take_results
from tests.accounts.users import a_user
from tests.missions import flights, worlds
from workspace.jobs.services import create_job, finish_job, start_job
from workspace.models import AuditEntry, IdempotencyKey

LONG_AGO = timedelta(hours=1)


@pytest.fixture
def day(db: None, tmp_path: Path) -> Promises:
    """A small working day in which everything was kept, and its book."""
    book, user = Book(tmp_path), a_user()
    flights.ground(tmp_path / "ground.tif")
    here, [uav] = worlds.world(), flights.fleet(link="http")
    mission = flights.dispatched(user, [uav], [here.towers[3]])
    approval = Approval.objects.get(mission=mission)
    book.note(kinds.APPROVAL, mission=str(mission.pk), approval=str(approval.pk), sha256=approval.content_sha256)
    [command] = flights.carry(uav)
    book.note(kinds.COMMAND, id=str(command.pk), uav=uav.pk, kind=command.kind, key="once")
    book.note(kinds.COMMAND_END, id=str(command.pk), state="applied")
    _saved(book, user, here)
    _reported(book, uav)
    _flown(book, uav, approval)
    _alerted(book, uav, user)
    job = create_job(organisation=user.organisation, created_by=user, task="missions.tasks.solve_plan", parameters={})
    held = start_job(job_id=job.pk)
    assert held is not None
    finish_job(job=held, result={"routes": []})
    book.note(kinds.JOB, id=str(job.pk))
    book.note(kinds.PLAN, job=str(job.pk))
    zone = worlds.zone_around((10.5, 55.5), with_graph=False, name="Works")
    book.note(kinds.ZONE, id=zone.pk, name=zone.name)
    return promises_of(lines(tmp_path))


def _saved(book: Book, user: Any, here: Any) -> None:
    name = "Drawn"
    drawn = create_mission(organisation=user.organisation, author=user, name=name, request=worlds.request(here.towers[1]))
    book.note(kinds.MISSION, id=str(drawn.pk), name=name, revision=drawn.revision)
    edited = change_mission(mission=drawn, actor=user, change=MissionChange(name="Edited"))
    book.note(kinds.EDIT, mission=str(drawn.pk), revision=edited.revision, name="Edited")


def _reported(book: Book, uav: Uav) -> None:
    now = timezone.now()
    sent = [{"sequence": number, "measured_at": now.isoformat(), "position": [10.0, 56.0]} for number in range(5)]
    take_reports(uav_id=uav.pk, place=None, stream="boot", sent=sent, received_at=now)
    book.note(kinds.RECORDS, uav=uav.pk, stream="boot", sequences=list(range(5)))


def _flown(book: Book, uav: Uav, approval: Approval) -> None:
    now = timezone.now()
    result = NewResult(1, approval.pk, 0, "complete", now, "seen", {})
    ended = EndedFlight(approval.pk, 1, "flown")
    take_results(uav_id=uav.pk, stream="boot", results=[result], flights=[ended], received_at=now)
    book.note(kinds.RESULTS, uav=uav.pk, stream="boot", sequences=[1])
    book.note(kinds.FLIGHT, uav=uav.pk, approval=str(approval.pk), flight=1)


def _alerted(book: Book, uav: Uav, user: Any) -> None:
    alert = open_alert(uav=uav, level=AlertLevel.WARNING, code="test", message="Something is.")
    acknowledge_alert(alert=alert, actor=user)
    book.note(kinds.ACKNOWLEDGEMENT, alert=alert.pk)
    note = note_alert(alert=alert, actor=user, text="Seen once")
    book.note(kinds.NOTE, alert=alert.pk, id=note.pk, text=note.text)


def violated(promised: Promises) -> set[str]:
    return {one.name for one in check_invariants_here(promised) if one.violations}


def sql(statement: str) -> None:
    """Past every rule that the database keeps by itself."""
    with connection.cursor() as cursor:
        cursor.execute("SET CONSTRAINTS ALL IMMEDIATE")
        cursor.execute("SET LOCAL session_replication_role = replica")
        cursor.execute(statement)
        cursor.execute("SET LOCAL session_replication_role = DEFAULT")


def again(model: type[Model], **others: Any) -> None:
    """The newest row of a table a second time, with these columns otherwise."""
    row = model._default_manager.order_by("-pk")[0]
    row.pk = None
    for name, value in others.items():
        setattr(row, name, value)
    model._default_manager.bulk_create([row])


def edited() -> Any:
    return Mission.objects.get(name="Edited").pk


def twice_a_record() -> None:
    sql("ALTER TABLE telemetry_telemetryrecord DROP CONSTRAINT telemetry_record_once")
    again(TelemetryRecord)


def twice_a_result() -> None:
    sql("ALTER TABLE telemetry_inspectionresult DROP CONSTRAINT inspection_result_once")
    again(InspectionResult)


def twice_a_mission() -> None:
    sql("INSERT INTO workspace_auditentry (organisation_id, action, subject_type, subject_id, after, recorded_at) "
        "SELECT organisation_id, action, subject_type, gen_random_uuid(), after, now() FROM workspace_auditentry "
        "WHERE action = 'create' AND after->>'name' = 'Drawn'")  # fmt: skip


MISSIONS, EDITS = "acknowledged missions are there, each once", "acknowledged edits are in the history, none over another"
JOBS, APPROVALS = "acknowledged jobs are there; a plan that was fetched is kept", "approvals are as they were approved"
COMMANDS = "acknowledged commands are there, one a key, and ended as told"
RECORDS, RESULTS = "acknowledged records are there, each once", "acknowledged results are there, each once"
FLIGHTS, SEEN, NOTES = "flights ended as told", "acknowledgements of alerts are there", "notes are there, each once"
ORPHANS, PLANS, HASHES = "no orphans, by every foreign key", "no mission is mixed from two plans", "each approval has its document's hash"
TWICE, STUCK_JOB, STUCK = "nothing is stored twice", "no job is open without a lease", "no command is open without a lease"
STEPS, HISTORY = "each command has its whole history", "each mission has its whole history"
ALERTS, LATEST = "alerts, their courses and notes add up", "live pages are shown the newest records"
HALF = "no kept answer is half written"


def _job_forgotten() -> None:
    sql("UPDATE workspace_job SET state = 'running', lease_expires_at = now() - interval '1 hour'")


def _command_forgotten() -> None:
    long_ago = timezone.now() - LONG_AGO
    UavCommand.objects.update(state="sent", expires_at=long_ago, lease_expires_at=long_ago, finished_at=None)
    UavCommandEvent.objects.create(command=UavCommand.objects.get(), state="sent", attempt=9)


def _half_an_answer() -> None:
    IdempotencyKey.objects.create(user=a_user(), key=str(uuid4()), request_sha256="")


PLANTED: list[tuple[str, Callable[[], object]]] = [
    (MISSIONS, lambda: sql("DELETE FROM missions_mission WHERE name = 'Edited'")),
    (MISSIONS, lambda: Mission.objects.filter(name="Edited").update(deleted_at=timezone.now())),
    (MISSIONS, twice_a_mission),
    (EDITS, lambda: sql("DELETE FROM workspace_auditentry WHERE after->>'name' = 'Edited'")),
    (JOBS, lambda: sql("DELETE FROM workspace_job")),
    (JOBS, lambda: sql("UPDATE workspace_job SET result = NULL")),
    (APPROVALS, lambda: sql("UPDATE missions_approval SET content_sha256 = repeat('0', 64)")),
    (COMMANDS, lambda: sql("DELETE FROM missions_uavcommand")),
    (COMMANDS, lambda: sql("UPDATE missions_uavcommand SET state = 'failed'")),
    (RECORDS, lambda: TelemetryRecord.objects.filter(sequence=3).delete()),
    (RECORDS, twice_a_record),
    (RESULTS, lambda: sql("DELETE FROM telemetry_inspectionresult")),
    (RESULTS, twice_a_result),
    (FLIGHTS, lambda: sql("UPDATE missions_route SET flights_flown = 0")),
    (SEEN, lambda: sql("UPDATE telemetry_alert SET course = '[]'")),
    (NOTES, lambda: sql("DELETE FROM telemetry_alertnote")),
    (NOTES, lambda: again(AlertNote)),
    ("zones came and went as told", lambda: sql("DELETE FROM inspection_noflyzone WHERE name = 'Works'")),
    (ORPHANS, lambda: sql("DELETE FROM telemetry_telemetrystream")),
    (PLANS, lambda: sql("UPDATE missions_route SET graph_version = graph_version + 1")),
    (PLANS, lambda: sql("UPDATE missions_waypoint SET target_id = (SELECT max(id) FROM missions_inspectiontarget)")),
    (PLANS, lambda: sql("DELETE FROM missions_route")),
    (PLANS, lambda: sql("UPDATE missions_mission SET state = 'active' WHERE state = 'completed'; DELETE FROM missions_approval")),
    (HASHES, lambda: sql("""UPDATE missions_approval SET document = jsonb_set(document, '{ground,revision}', '0')""")),
    (TWICE, twice_a_record),
    (STUCK_JOB, _job_forgotten),
    (STUCK, _command_forgotten),
    (STEPS, lambda: UavCommandEvent.objects.filter(state="queued").delete()),
    (STEPS, lambda: UavCommandEvent.objects.filter(state="applied").delete()),
    (STEPS, lambda: UavCommandEvent.objects.create(command=UavCommand.objects.get(), state="applied", attempt=1)),
    (HISTORY, lambda: sql("UPDATE missions_mission SET revision = revision + 1")),
    (HISTORY, lambda: again(AuditEntry, subject_type="mission", subject_id=str(edited()), action="rename", after={"revision": 2})),
    (ALERTS, lambda: sql("UPDATE telemetry_alert SET closed_at = now()")),
    (ALERTS, lambda: sql("UPDATE telemetry_alert SET acknowledged_at = NULL")),
    (ALERTS, lambda: again(AlertNote)),
    (LATEST, lambda: sql("""UPDATE telemetry_uavwatch SET measured = jsonb_set(measured, '{measured_at}', '"2020-01-01T00:00:00Z"')""")),
    (HALF, _half_an_answer),
]  # fmt: skip


def test_each_planted_violation_is_named_and_a_sound_day_is_not_blamed(day: Promises) -> None:
    assert day.count > 15
    assert violated(day) == set()
    missed = []
    for number, (name, plant) in enumerate(PLANTED):
        with connection.cursor() as cursor:
            cursor.execute("SAVEPOINT planted")
            plant()
            found = violated(day)
            cursor.execute("ROLLBACK TO SAVEPOINT planted")
        if name not in found:
            missed.append(f"{number}: {name}, but {sorted(found)}")
    assert missed == []
    assert violated(day) == set(), "each was taken back"


def test_a_promise_that_was_given_to_two_is_named(day: Promises) -> None:
    day.edits.append(day.edits[0])
    day.commands[str(uuid4())] = "once"
    day.gaps.append("somebody: 3 was to come, and 5 came")
    assert violated(day) == {EDITS, COMMANDS, "live pages saw no gap"}


def test_what_was_asked_and_never_answered_may_be_either_way(day: Promises, tmp_path: Path) -> None:
    drawn = Mission.objects.get(name="Edited")
    Mission.objects.filter(pk=drawn.pk).update(deleted_at=timezone.now())
    assert violated(day) == {MISSIONS}
    Book(tmp_path).note(kinds.ASKED, thing=str(drawn.pk))
    assert violated(promises_of(lines(tmp_path))) == set()


def test_a_line_that_was_cut_off_is_left_out(tmp_path: Path) -> None:
    Book(tmp_path).note(kinds.JOB, id="1")
    with (tmp_path / "book.jsonl").open("ab") as book:
        book.write(b'{"what": "job", "id": "2')
    assert promises_of(lines(tmp_path)).jobs == {"1"}


@pytest.mark.django_db(transaction=True)
def test_looking_writes_nothing_and_can_write_nothing() -> None:
    assert all(not one.violations for one in check_invariants(Promises()))
