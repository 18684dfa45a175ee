"""From a right password to a session: at once, or with a second factor in between. Until then nobody is signed in."""

import time
from dataclasses import dataclass

from django.contrib.auth import login
from django.http import HttpRequest, HttpResponse, HttpResponseRedirect
from django.shortcuts import resolve_url
from django.utils.crypto import constant_time_compare

from accounts.second_factors import has_second_factor, is_required_of
from accounts.sign_in_log import record_sign_in
from workspace.models import SignInOutcome, User
from workspace.sessions.browser_sessions import note_session
from workspace.sessions.trusted_devices import remember

BACKEND = "workspace.api.authentication.RoleBackend"
HALF_IN = "workspace.half_in"  # in the session: who has shown the password, when, and where they wanted to go
HALF_IN_S = 10 * 60


@dataclass(frozen=True)
class HalfIn:
    """Somebody who has shown their password here a few minutes ago."""

    user: User
    wanted: str  # address


def let_in(request: HttpRequest, user: User, wanted: str) -> HttpResponse:
    """After the password: to where they wanted to go, to the page that asks for a code, or to the one that sets the codes up."""
    has_one = has_second_factor(user)
    if not (has_one or is_required_of(user)):
        response = HttpResponseRedirect(wanted)
        sign_in(request, response, user)
        return response
    request.session.cycle_key()
    request.session[HALF_IN] = {"user": user.pk, "of": user.get_session_auth_hash(), "at": time.time(), "wanted": wanted}
    return HttpResponseRedirect(resolve_url("sign-in-code" if has_one else "second-factor"))


def who_is_half_in(request: HttpRequest) -> HalfIn | None:
    """None after ten minutes, and once the password is another one or they may not sign in any more."""
    kept = request.session.get(HALF_IN)
    if kept is None or not 0 <= time.time() - kept["at"] <= HALF_IN_S:
        return None
    user = User.objects.select_related("organisation").filter(pk=kept["user"], is_active=True).first()
    if user is None or not constant_time_compare(kept["of"], user.get_session_auth_hash()):
        return None
    return HalfIn(user, kept["wanted"])


def sign_in(request: HttpRequest, response: HttpResponse, user: User) -> None:
    """The session begins: the log has it, and the browser is known from now on."""
    request.session.pop(HALF_IN, None)
    login(request, user, backend=BACKEND)
    note_session(request.session, user, is_act=True, user_agent=request.headers.get("User-Agent", ""))
    record_sign_in(request, SignInOutcome.SIGNED_IN, user=user)
    remember(request, response, user.username)
