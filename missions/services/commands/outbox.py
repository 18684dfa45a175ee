"""The outbox of commands to UAVs. Rows are authoritative: a dispatcher holds one by a lease, and writes to it only while it does.

All times are the database's, so that the dispatchers' clocks do not matter. A command is fenced by its attempt and its holder: once
another holder has taken it over, or it has ended, writes of the first holder match no row.
"""

from collections.abc import Collection, Iterable, Sequence
from datetime import timedelta
from functools import partial
from typing import Any
from uuid import UUID

from django.conf import settings
from django.db import connection, transaction
from django.db.models import F, Max, Q, QuerySet
from django.db.models.functions import Coalesce, Greatest, Least, Now
from django.utils.translation import gettext as _

from missions.command_rules import ALONG_ROUTE, HAND_OVER, WAIT_S, axes_overtaken_by, axis_of, may_overtake, priority_of
from missions.models import (
    OPEN_COMMANDS,
    Approval,
    CommandAxis,
    CommandKind,
    CommandPriority,
    CommandState,
    LinkKind,
    Mission,
    Uav,
    UavCommand,
    UavCommandEvent,
)
from missions.services.commands.refused import refuse
from operation.reasons import Reason, Why, english, reasons_of, text_reason
from workspace.audit import record_change
from workspace.leases import from_now, is_free, release, renew, take
from workspace.live.changes import publish_live
from workspace.models import User
from workspace.reason_texts import text_and_column, why_of_column

CHANNEL = "spanwise_uav_commands"  # PostgreSQL's NOTIFY: the key of a UAV with a command that waits or was cancelled
SUPERSEDED, NOT_DELIVERED, UNCONFIRMED, UNACKNOWLEDGED = "superseded", "not-delivered", "unconfirmed", "unheard"
WITHDRAWN = "withdrawn"


def queue_command(
    *,
    uav: Uav,
    kind: CommandKind,
    actor: User | None,
    why: str = "",
    parameters: dict[str, Any] | None = None,
    mission: Mission | None = None,
    approval: Approval | None = None,
    expires_in_s: float | None = None,
    wait_s: float = 0.0,
) -> UavCommand:
    """Queue a command for a UAV; unfinished ones on the same axis expire.

    Raises Refused while one of them makes the UAV safer than this one would: that one is not replaced. Without `expires_in_s` the command
    is valid for as long as the settings define for its kind. It is delivered after `wait_s`; until then any other command on the same axis
    replaces it. Rows are locked in the order mission, UAV, command: a caller that needs a mission's row locks it before.
    """
    wanted_for_s = settings.COMMAND_RULES.wanted_for_s(kind) if expires_in_s is None else expires_in_s
    waits = {"lease_expires_at": from_now(wait_s)} if wait_s > 0.0 else {}
    with transaction.atomic():
        link = Uav.objects.select_for_update(no_key=True).values_list("link", flat=True).get(pk=uav.pk)
        overtaken = UavCommand.objects.filter(uav=uav, axis__in=axes_overtaken_by(kind))
        _refuse_to_overtake(uav, kind, overtaken)
        _end(
            overtaken,
            SUPERSEDED,
            (Reason("superseded", {"command": Reason(f"command_{kind}")}),),
        )
        last = UavCommand.objects.filter(uav=uav).aggregate(last=Max("sequence"))["last"] or 0
        command = UavCommand.objects.create(
            organisation_id=uav.organisation_id,
            uav=uav,
            mission=mission,
            approval=approval,
            sequence=last + 1,
            kind=kind,
            axis=axis_of(kind),
            priority=priority_of(kind),
            parameters=parameters or {},
            link=link,
            created_by=actor,
            why=why,
            expires_at=None if wanted_for_s is None else Now() + timedelta(seconds=wanted_for_s + wait_s),
            **waits,
        )
        command.refresh_from_db(fields=["created_at", "expires_at"])
        UavCommandEvent.objects.create(command=command, state=CommandState.QUEUED, attempt=0)
        record_change(
            organisation=uav.organisation, actor=actor, action="give", subject_type="uav_command", subject_id=command.pk,
            after={
                "uav": uav.pk, "kind": str(kind), "sequence": command.sequence, "parameters": command.parameters, "why": why,
                "mission": mission and str(mission.pk), "approval": approval and str(approval.pk),
            },
        )  # fmt: skip
        _notify(uav.pk)
        _notify_pages([uav.organisation_id])
    return command


def claim_commands(
    *,
    uav_ids: Collection[int],
    holder: str,
    lease_s: float,
    limit: int,
    link: LinkKind | None = None,
    axes: Collection[CommandAxis] | None = None,
    to_unreachable: bool = False,
) -> list[UavCommand]:
    """Claim up to `limit` commands to these UAVs, the most urgent first, then the oldest; commands that others hold are skipped.

    With `link`, only commands of this link to UAVs that use it now; with `axes`, only commands on these axes. `to_unreachable`: only
    commands suitable for a UAV that sends nothing: safety commands that are neither a step that others follow nor a return that depends on
    its position.

    Claims commands that nobody holds and those whose lease has run out, and increments the attempts of each. `holder` names one run of one
    program: a restarted gateway has another name.
    """
    waiting = UavCommand.objects.filter(is_free(), _wanted(), uav__in=uav_ids, state__in=OPEN_COMMANDS)
    if link is not None:
        waiting = waiting.filter(link=link, uav__link=link)
    if axes is not None:
        waiting = waiting.filter(axis__in=axes)
    if to_unreachable:
        waiting = waiting.filter(priority=CommandPriority.SAFETY).exclude(parameters__has_any_keys=[HAND_OVER, ALONG_ROUTE])
    urgent = waiting.order_by("priority", "created_at", "sequence")[:limit]
    found = take(urgent, holder=holder, lease_s=lease_s, skip_locked=True, attempts=F("attempts") + 1)
    return sorted(found, key=lambda command: (command.priority, command.created_at, command.sequence))


def renew_claims(*, holder: str, lease_s: float) -> dict[UUID, int]:
    """Renew the leases of a holder. Returns the attempt of each command still held; the caller drops every other command at once.

    A command that expired before it was sent is no longer held.
    """
    held = UavCommand.objects.filter(holder=holder, state__in=OPEN_COMMANDS, lease_expires_at__isnull=False)
    return renew(held.exclude(sent_at=None, expires_at__lte=Now()), lease_s=lease_s, column="attempts")


def release_claims_of_others(*, uav_ids: Collection[int], holder: str) -> int:
    """Release what other gateways claimed for UAVs that this one serves now, without waiting for their leases. Returns how many.

    The row keeps its holder, which the command's history names, until another one claims it.
    """
    if not uav_ids:
        return 0
    held = UavCommand.objects.filter(uav__in=uav_ids, link=LinkKind.MAVLINK, state__in=OPEN_COMMANDS, lease_expires_at__isnull=False)
    return release(held.exclude(holder__in=["", holder]))


def note_sent(command_id: UUID, *, attempt: int, holder: str) -> bool:
    """Record that it is being sent; a later attempt sends it again. Returns False also once it has expired."""
    now = {"sent_at": Coalesce("sent_at", Now()), "outcome_code": "", **_outcome(())}
    return _note(command_id, attempt, holder, CommandState.SENT, now, only=_wanted())


def note_sent_unacknowledged(command_id: UUID, *, attempt: int, holder: str) -> bool:
    """Record that it is being sent repeatedly to a UAV that sends nothing. Returns False also once it has expired."""
    why = (Reason("unacknowledged"),)
    now = {"sent_at": Coalesce("sent_at", Now()), "outcome_code": UNACKNOWLEDGED, **_outcome(why)}
    return _note(command_id, attempt, holder, CommandState.SENT, now, why, only=_wanted())


def is_wanted(command_id: UUID, *, attempt: int, holder: str) -> bool:
    """Whether it is still held and has not expired."""
    return _held(command_id, attempt, holder).filter(_wanted()).exists()


def note_acknowledged(command_id: UUID, *, attempt: int, holder: str) -> bool:
    """Record that the vehicle acknowledged it, which does not mean that it was done."""
    held = _held(command_id, attempt, holder)
    if held.filter(state=CommandState.ACKNOWLEDGED).exists():
        return True
    now = {"sent_at": Coalesce("sent_at", Now()), "acknowledged_at": Coalesce("acknowledged_at", Now())}
    return _note(command_id, attempt, holder, CommandState.ACKNOWLEDGED, now)


def note_progress(command_id: UUID, *, attempt: int, holder: str, done: int, total: int) -> bool:
    """Record how many items of an upload are transferred."""
    with transaction.atomic():
        if not _held(command_id, attempt, holder).update(progress={"done": done, "total": total}):
            return False
        _notify_pages([_organisation_of(command_id)])
    return True


def note_read_back(command_id: UUID, *, attempt: int, holder: str, done: int, total: int) -> bool:
    """Record how many onboard items were read back before the command is sent, and extend its expiry.

    It then expires `motion_s` from now, at most `read_back_s` later than originally. Returns False once it has expired.
    """
    rules = settings.COMMAND_RULES
    latest = F("created_at") + timedelta(seconds=rules.motion_s + rules.read_back_s)
    put_off = Greatest(F("expires_at"), Least(Now() + timedelta(seconds=rules.motion_s), latest))
    held = _held(command_id, attempt, holder).filter(sent_at=None, expires_at__gt=Now())
    return bool(held.update(progress={"done": done, "total": total}, expires_at=put_off))


def note_applied(command_id: UUID, *, attempt: int, holder: str, note: Why = (), warnings: Why = ()) -> bool:
    """Record that the vehicle did it. `warnings` are shown to the user who gave the command."""
    ended = {"sent_at": Coalesce("sent_at", Now()), "finished_at": Now(), "lease_expires_at": None, **_outcome(warnings)}
    return _note(command_id, attempt, holder, CommandState.APPLIED, ended, " ".join(filter(None, [english(note), english(warnings)])))


def note_failed(command_id: UUID, code: str, why: Why, *, attempt: int, holder: str) -> bool:
    """Record that the vehicle refused it or did not do it, with the reason."""
    ended = {"finished_at": Now(), "lease_expires_at": None, "outcome_code": code[:50], **_outcome(why)}
    return _note(command_id, attempt, holder, CommandState.FAILED, ended, why)


def note_released(command_id: UUID, *, attempt: int, holder: str, retry_in_s: float = 0.0, note: Why = (), code: str = "") -> bool:
    """Release the command for any holder after `retry_in_s`. With a `code` the row stores why it waits, as `note` describes."""
    back: dict[str, Any] = {"holder": "", "lease_expires_at": from_now(retry_in_s) if retry_in_s else None}
    back |= {"outcome_code": code[:50], **_outcome(note)} if code else {}
    return _note(command_id, attempt, holder, CommandState.QUEUED, back, note)


def expire_overdue() -> int:
    """End expired commands that nobody holds; returns how many. A command that had to wait keeps its reason."""
    overdue = UavCommand.objects.filter(is_free(), expires_at__lte=Now())
    with transaction.atomic():
        unsent = overdue.filter(sent_at=None)
        never = _end(unsent.filter(outcome_code=""), NOT_DELIVERED, (Reason("not_delivered"),), skip_locked=True)
        waited = unsent.exclude(outcome_code="").order_by("outcome_code", "outcome")
        causes = {(code, stored): column for code, stored, column in waited.values_list("outcome_code", "outcome", "outcome_why")}
        for (code, stored), column in causes.items():
            never += _end(waited.filter(outcome_code=code, outcome=stored), code, _not_in_time(stored, column), skip_locked=True)
        sent = overdue.filter(sent_at__isnull=False)
        unsure = _end(sent, UNCONFIRMED, (Reason("unconfirmed"),), skip_locked=True)
    return never + unsure


def end_commands(commands: QuerySet[UavCommand], *, code: str, why: Sequence[Reason]) -> int:
    """End commands for another reason than a later command."""
    with transaction.atomic():
        ended = list(commands.filter(state__in=OPEN_COMMANDS).values_list("uav_id", flat=True))
        number = _end(commands, code, why)
        for uav_id in set(ended):
            _notify(uav_id)
    return number


def _refuse_to_overtake(uav: Uav, kind: CommandKind, commands: QuerySet[UavCommand]) -> None:
    waiting = Q(parameters__has_key=WAIT_S, sent_at=None, lease_expires_at__gt=Now())
    unfinished = commands.filter(state__in=OPEN_COMMANDS).exclude(waiting).values_list("kind", flat=True)
    if not all(may_overtake(kind, other) for other in unfinished):
        words = _("A safer command to %(uav)s is not done yet: this one cannot take its place.")
        raise refuse("safety_first", words % {"uav": uav.name})


def _outcome(why: Why) -> dict[str, Any]:
    text, column = text_and_column(why, 500)
    return {"outcome": text, "outcome_why": column}


def _not_in_time(stored: str, column: dict[str, Any] | None) -> tuple[Reason, ...]:
    """Return the reason for an expiry with the reason for which the command had to wait."""
    waited_for = why_of_column(column, stored)
    return (Reason("not_sent_in_time"), *(reasons_of(waited_for) or [text_reason(stored)]))


def _wanted() -> Q:
    return Q(expires_at=None) | Q(expires_at__gt=Now())


def _held(command_id: UUID, attempt: int, holder: str) -> QuerySet[UavCommand]:
    return UavCommand.objects.filter(pk=command_id, attempts=attempt, holder=holder, state__in=OPEN_COMMANDS)


def _note(
    command_id: UUID, attempt: int, holder: str, state: CommandState, values: dict[str, Any], note: Why = (), *, only: Q | None = None
) -> bool:
    with transaction.atomic():
        if not _held(command_id, attempt, holder).filter(only or Q()).update(state=state, **values):
            return False
        UavCommandEvent.objects.create(command_id=command_id, state=state, attempt=attempt, holder=holder, note=english(note)[:500])
        _notify_pages([_organisation_of(command_id)])
    return True


def withdraw(command_ids: Collection[UUID]) -> int:
    """End those of these commands that were not sent; returns how many. Their holders are notified."""
    with transaction.atomic():
        unsent = UavCommand.objects.filter(pk__in=command_ids, sent_at=None)
        uavs = list(unsent.filter(state__in=OPEN_COMMANDS).values_list("uav", flat=True))
        ended = _end(unsent, WITHDRAWN, (Reason("withdrawn"),))
        for uav_id in uavs:
            _notify(uav_id)
    return ended


def _end(commands: QuerySet[UavCommand], code: str, why: Sequence[Reason], *, skip_locked: bool = False) -> int:
    """End commands; the caller has begun a transaction."""
    outcome = _outcome(why)
    found = list(commands.filter(state__in=OPEN_COMMANDS).select_for_update(skip_locked=skip_locked).order_by("pk"))
    UavCommand.objects.filter(pk__in=[command.pk for command in found]).update(
        state=CommandState.EXPIRED, finished_at=Now(), lease_expires_at=None, outcome_code=code, **outcome
    )
    UavCommandEvent.objects.bulk_create(
        UavCommandEvent(
            command=command, state=CommandState.EXPIRED, attempt=command.attempts, holder=command.holder, note=outcome["outcome"]
        )
        for command in found
    )
    _notify_pages({command.organisation_id for command in found})
    return len(found)


def _notify(uav_id: int) -> None:
    """Notify listeners when the transaction commits; a rollback sends nothing."""
    with connection.cursor() as cursor:
        cursor.execute("SELECT pg_notify(%s, %s)", [CHANNEL, str(uav_id)])


def _notify_pages(organisations: Iterable[int]) -> None:
    """Notify live pages after the commit."""
    for organisation_id in organisations:
        transaction.on_commit(partial(publish_live, organisation_id))


def _organisation_of(command_id: UUID) -> int:
    return UavCommand.objects.values_list("organisation_id", flat=True).get(pk=command_id)
