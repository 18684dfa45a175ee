"""From a right password to a session: at once, or after a second factor. Until then the user is not logged in."""

import time
from datetime import timedelta
from typing import Any

from allauth.account.stages import LoginStage, LoginStageController
from allauth.mfa.webauthn.internal.flows import did_use_passwordless_login
from django.conf import settings
from django.http import HttpRequest, HttpResponse, HttpResponseRedirect
from django.urls import reverse
from django.utils import timezone
from django.utils.crypto import constant_time_compare
from django.utils.translation import gettext as _
from drf_spectacular.utils import OpenApiResponse
from rest_framework.request import Request

from accounts.second_factors import has_second_factor, is_required_of
from accounts.single_sign_on import came_by_single_sign_on
from workspace.api.errors import ApiProblem
from workspace.models import SignInEntry, SignInOutcome, User
from workspace.sessions.sign_in_attempts import address_of, is_first_in, network_of

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


class SecondFactorStage(LoginStage):
    """After the password: the page that asks for a code or a passkey. Until then the user is not logged in."""

    key = "second_factor"
    urlname = "mfa_authenticate"

    def handle(self) -> tuple[HttpResponse | None, bool]:
        user = self.login.user
        if not isinstance(user, User) or came_by_single_sign_on(self.request, user):  # second factors are the provider's matter then
            return None, True
        return self._page() if self._is_needed(user) else None, True

    def is_resumable(self, request: HttpRequest) -> bool:
        """No: the sign-in page stays open for another user."""
        return False

    def _is_needed(self, user: User) -> bool:
        return has_second_factor(user) and not did_use_passwordless_login(self.request, user)

    def _page(self) -> HttpResponse:
        self.request.session.cycle_key()
        self.state["of"] = self.login.user.get_session_auth_hash()
        return HttpResponseRedirect(reverse(self.urlname))


class SetUpStage(SecondFactorStage):
    """The page that sets up a second factor, for users who must have one."""

    key = "set_up_second_factor"
    urlname = "second-factor"

    def _is_needed(self, user: User) -> bool:
        return is_required_of(user) and not has_second_factor(user)


def pending_stage(request: HttpRequest, stage: type[SecondFactorStage]) -> SecondFactorStage | None:
    """Return the stage of a pending login; None after ten minutes, once the password has changed, or if the user may no longer log in."""
    found = None if request.user.is_authenticated else LoginStageController.enter(request, stage.key)
    if found is None:
        return None
    user = found.login.user
    if not (user and user.is_active and constant_time_compare(found.state.get("of", ""), user.get_session_auth_hash())):
        found.abort()
        return None
    return found


PROVED_AT = "workspace.proved_at"  # in the session, beside its beginning
REAUTHENTICATION_S = 15 * 60
LOCAL_SIGN_IN_OFF = OpenApiResponse(description="`local_sign_in_off`: the identity provider signs in.")
PASSWORD_NEEDED = OpenApiResponse(description="`password_needed`: say it at `/account/proof`.")


def note_reauthentication(session: Any, *, at_s: float | None = None) -> None:
    """Record that the user has authenticated in this session: now, or when the identity provider says."""
    session[PROVED_AT] = time.time() if at_s is None else at_s


def require_reauthentication(request: Request) -> None:
    """Raise ApiProblem 403 `password_needed` unless the user authenticated within 15 min, by a login or a reauthentication.

    A session that began by single sign-on proves nothing: the provider may have asked the user for nothing then.
    """
    row = getattr(request.session, "in_use", None)
    proves = row is not None and isinstance(request.user, User) and not came_by_single_sign_on(request, request.user)
    since_sign_in_s = (timezone.now() - row.began_at).total_seconds() if row is not None and proves else REAUTHENTICATION_S + 1.0
    since_reauthentication_s = time.time() - request.session.get(PROVED_AT, 0.0)
    if min(since_sign_in_s, since_reauthentication_s) > REAUTHENTICATION_S:
        raise ApiProblem(403, "password_needed", _("Say your password again for this."))
