"""From a right password to a session: at once, or after a second factor. Until then the user is not logged in."""

import time
from dataclasses import dataclass
from datetime import timedelta
from typing import Any

from django.conf import settings
from django.contrib.auth import login
from django.http import HttpRequest, HttpResponse, HttpResponseRedirect
from django.shortcuts import resolve_url
from django.utils import timezone
from django.utils.crypto import constant_time_compare
from django.utils.translation import gettext as _
from drf_spectacular.utils import OpenApiResponse
from rest_framework.request import Request

from accounts.second_factors import has_second_factor, is_required_of
from workspace.api.errors import ApiProblem
from workspace.models import SignInEntry, SignInOutcome, User
from workspace.sessions.browser_sessions import note_session
from workspace.sessions.sign_in_attempts import address_of, is_first_in, network_of, remember

HELD_BACK_INTERVAL_S = 60  # per name and network: many tries do not write many rows


def record_sign_in(request: HttpRequest, outcome: SignInOutcome, *, user: User | None = None, name: str = "") -> None:
    """Store a sign-in attempt. The name is stored only if it is known: users type passwords there."""
    address = address_of(request)
    if outcome == SignInOutcome.HELD_BACK and not is_first_in(HELD_BACK_INTERVAL_S, name, network_of(address)):
        return
    if user is None and name:
        user = User.objects.filter(username=name).first()
    agent = "".join(character for character in request.headers.get("User-Agent", "") if character.isprintable())
    SignInEntry.objects.create(user=user, outcome=outcome, address=address[:45], user_agent=agent[:200])


def forget_old_sign_ins() -> int:
    kept_since = timezone.now() - timedelta(days=settings.SIGN_IN_LOG_DAYS)
    deleted, _ = SignInEntry.objects.filter(recorded_at__lt=kept_since).delete()
    return deleted


BACKEND = "workspace.api.authentication.RoleBackend"
MFA_PENDING = "workspace.mfa_pending"  # in the session: the user who gave the password, the time, and the next address
MFA_PENDING_S = 10 * 60


@dataclass(frozen=True)
class HalfIn:
    """A user who has given the password and not yet the second factor."""

    user: User
    wanted: str  # the requested address


def let_in(request: HttpRequest, user: User, wanted: str) -> HttpResponse:
    """Respond after the password: redirect to the requested address, to the code page, or to the page that sets up a second factor."""
    has_one = has_second_factor(user)
    if not (has_one or is_required_of(user)):
        response = HttpResponseRedirect(wanted)
        sign_in(request, response, user)
        return response
    request.session.cycle_key()
    request.session[MFA_PENDING] = {"user": user.pk, "of": user.get_session_auth_hash(), "at": time.time(), "wanted": wanted}
    return HttpResponseRedirect(resolve_url("sign-in-code" if has_one else "second-factor"))


def user_with_mfa_pending(request: HttpRequest) -> HalfIn | None:
    """Return the pending login; None after ten minutes, once the password has changed, or if the user may no longer log in."""
    kept = request.session.get(MFA_PENDING)
    if kept is None or not 0 <= time.time() - kept["at"] <= MFA_PENDING_S:
        return None
    user = User.objects.select_related("organisation").filter(pk=kept["user"], is_active=True).first()
    if user is None or not constant_time_compare(kept["of"], user.get_session_auth_hash()):
        return None
    return HalfIn(user, kept["wanted"])


def sign_in(request: HttpRequest, response: HttpResponse, user: User) -> None:
    """Begin the session, write the log, and remember the browser as a trusted device."""
    request.session.pop(MFA_PENDING, None)
    login(request, user, backend=BACKEND)
    note_session(request.session, user, is_act=True, user_agent=request.headers.get("User-Agent", ""))
    record_sign_in(request, SignInOutcome.SIGNED_IN, user=user)
    remember(request, response, user.username)


PROVED_AT = "workspace.proved_at"  # in the session, beside its beginning
REAUTHENTICATION_S = 15 * 60
PASSWORD_NEEDED = OpenApiResponse(description="`password_needed`: say it at `/account/proof`.")


def note_reauthentication(session: Any) -> None:
    """Record that the user has just entered their password in this session."""
    session[PROVED_AT] = time.time()


def require_reauthentication(request: Request) -> None:
    """Raise ApiProblem 403 `password_needed` unless the password was entered within 15 min, by a login or a reauthentication."""
    row = getattr(request.session, "in_use", None)
    since_sign_in_s = REAUTHENTICATION_S + 1.0 if row is None else (timezone.now() - row.began_at).total_seconds()
    since_reauthentication_s = time.time() - request.session.get(PROVED_AT, 0.0)
    if min(since_sign_in_s, since_reauthentication_s) > REAUTHENTICATION_S:
        raise ApiProblem(403, "password_needed", _("Say your password again for this."))
