"""Browser sessions: recording their use, listing and ending them."""

from dataclasses import dataclass
from datetime import datetime, timedelta
from typing import Any

from django.conf import settings
from django.contrib.auth import HASH_SESSION_KEY
from django.contrib.sessions.models import Session
from django.db import transaction
from django.db.models import Exists, OuterRef
from django.utils import timezone
from django.utils.crypto import constant_time_compare

from workspace.audit import record_account_event
from workspace.models import BrowserSession, User

NOTED_EVERY = timedelta(minutes=1)


@dataclass(frozen=True)
class SessionRules:
    longest_s: float  # from the login, whatever happens
    idle_s: float  # without any open page
    watching_s: float  # with an open page that the user does not use


def ends_at(*, began_at: datetime, acted_at: datetime, present_at: datetime, rules: SessionRules) -> datetime:
    """Return the first of the three ends. `acted_at`: the user opened or sent something; `present_at`: an open page sent a request."""
    present_at = max(present_at, acted_at)
    return min(
        began_at + timedelta(seconds=rules.longest_s),
        present_at + timedelta(seconds=rules.idle_s),
        acted_at + timedelta(seconds=rules.watching_s),
    )


def session_rules() -> SessionRules:
    return SessionRules(settings.SESSION_COOKIE_AGE, settings.SESSION_IDLE_S, settings.SESSION_WATCHING_S)


def session_ends_at(row: BrowserSession) -> datetime:
    return ends_at(began_at=row.began_at, acted_at=row.acted_at, present_at=row.present_at, rules=session_rules())


def seconds_left(store: Any) -> int:
    """Return the seconds until the session ends without further requests."""
    left = settings.SESSION_IDLE_S if store.in_use is None else (session_ends_at(store.in_use) - timezone.now()).total_seconds()
    return max(0, round(left))


def note_session(store: Any, user: User, *, is_act: bool, user_agent: str = "", address: str = "") -> None:
    """Record, to the minute, that the store's session is in use, and from which address. An unknown one begins now."""
    now, row = timezone.now(), store.in_use
    if row is None:
        if store.session_key is not None:
            store.in_use = _begin(store.session_key, user, user_agent, address, now)
        return
    values: dict[str, Any] = {"present_at": now} | ({"acted_at": now} if is_act else {}) | ({"address": address} if address else {})
    if now - (row.acted_at if is_act else row.present_at) >= NOTED_EVERY:
        BrowserSession.objects.filter(pk=row.pk).update(**values)
        for name, value in values.items():
            setattr(row, name, value)


def _begin(session_key: str, user: User, user_agent: str, address: str, now: datetime) -> BrowserSession | None:
    agent = "".join(character for character in user_agent if character.isprintable())[:200]
    row = BrowserSession(
        session_id=session_key, user=user, user_agent=agent, address=address or None, began_at=now, acted_at=now, present_at=now
    )
    BrowserSession.objects.bulk_create([row], ignore_conflicts=True)  # a page's first requests may be concurrent
    return BrowserSession.objects.filter(session_id=session_key).first()


def open_sessions(user: User) -> list[BrowserSession]:
    """Return the sessions that are still valid, the last used first."""
    now = timezone.now()
    rows = user.browser_sessions.filter(session__expire_date__gt=now).select_related("session")
    return [row for row in rows if session_ends_at(row) > now and _lets_in(row.session, user)]


def _lets_in(session: Session, user: User) -> bool:
    """Whether the session is valid: a new password, or a new generation, ends others without a write to their rows."""
    signed = session.get_decoded().get(HASH_SESSION_KEY, "")
    return any(constant_time_compare(signed, known) for known in (user.get_session_auth_hash(), *user.get_session_auth_fallback_hash()))


def end_session(row: BrowserSession, *, actor: User) -> None:
    """End a session: at its next request, and within 5 s for its websockets."""
    with transaction.atomic():
        Session.objects.filter(pk=row.session_id).delete()
        record_account_event(row.user, actor, "session ended")


def forget_ended_sessions() -> int:
    """Delete the rows of sessions that have ended, however they ended."""
    now, rules = timezone.now(), session_rules()
    present_since, acted_since = now - timedelta(seconds=rules.idle_s), now - timedelta(seconds=rules.watching_s)
    over = BrowserSession.objects.filter(present_at__lt=present_since) | BrowserSession.objects.filter(acted_at__lt=acted_since)
    Session.objects.filter(pk__in=over.values("session_id")).delete()
    deleted, _ = Session.objects.filter(expire_date__lt=now).delete()
    BrowserSession.objects.filter(~Exists(Session.objects.filter(pk=OuterRef("session_id")))).delete()
    return deleted
