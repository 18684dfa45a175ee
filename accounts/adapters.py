"""What differs from django-allauth's defaults: limits on guessing, stages of a login, and what is recorded."""

from typing import Any

from allauth.account.adapter import DefaultAccountAdapter
from allauth.mfa.adapter import DefaultMFAAdapter
from allauth.mfa.models import Authenticator
from django.contrib.auth import authenticate
from django.core.exceptions import ValidationError
from django.http import HttpRequest, HttpResponse, HttpResponseRedirect
from django.shortcuts import resolve_url
from django.utils.http import url_has_allowed_host_and_scheme
from django.utils.translation import gettext as _
from django.utils.translation import ngettext

from accounts.login import SecondFactorStage, SetUpStage, record_sign_in
from accounts.second_factors import has_second_factor
from accounts.single_sign_on import local_sign_in_is_on, local_sign_in_off
from workspace.models import SignInOutcome, User
from workspace.sessions.browser_sessions import note_session
from workspace.sessions.preferences import visitor_ip
from workspace.sessions.sign_in_attempts import TooManyAttempts, address_of, mark_of, remember, try_to_sign_in


class AccountAdapter(DefaultAccountAdapter):
    """Passwords, and the session after the last stage of a login."""

    def authenticate(self, request: HttpRequest, **credentials: Any) -> User:
        """Return the user of this name and password. Raises ValidationError with one message that does not reveal which part was wrong."""
        if not local_sign_in_is_on():
            raise ValidationError(local_sign_in_off(), code="local_sign_in_off")
        name = credentials["username"]
        try:
            this_try = try_to_sign_in(name=name, address=address_of(request), trusted_device=mark_of(request, name))
        except TooManyAttempts as held:
            record_sign_in(request, SignInOutcome.HELD_BACK, name=name)
            raise ValidationError(_held_back(held), code="locked") from held
        user = authenticate(request, **credentials)
        if not isinstance(user, User):
            record_sign_in(request, SignInOutcome.WRONG, name=name)
            raise ValidationError(_wrong(this_try.left), code="invalid_login")
        this_try.succeeded()
        return user

    def get_login_stages(self) -> list[str]:
        return [f"{stage.__module__}.{stage.__qualname__}" for stage in (SecondFactorStage, SetUpStage)]

    def post_login(self, request: HttpRequest, user: User, **facts: Any) -> HttpResponse:
        """Write the log, begin the session's times, and remember the browser as a trusted device."""
        response: HttpResponse = super().post_login(request, user, **facts)
        agent = request.headers.get("User-Agent", "")
        note_session(request.session, user, is_act=True, user_agent=agent, address=visitor_ip(request))
        record_sign_in(request, SignInOutcome.SIGNED_IN, user=user)
        remember(request, response, user.username)
        return response

    def respond_user_inactive(self, request: HttpRequest, user: Any) -> HttpResponse:
        return HttpResponseRedirect(resolve_url("account_login"))

    def is_safe_url(self, url: str) -> bool:
        """Whether a login may lead there: to this host only."""
        request = self.request
        return url_has_allowed_host_and_scheme(url, allowed_hosts={request.get_host()}, require_https=request.is_secure())

    def is_reauthentication_required(self, *, app: str, **_facts: Any) -> bool:
        """No: pages and endpoints ask for it themselves (accounts/login.py)."""
        return False

    def is_ajax(self, request: HttpRequest) -> bool:
        """No: the sign-in page answers with a page whatever is accepted. The library's JSON repeats the password and drops cookies."""
        return False

    def add_message(self, *args: Any, **facts: Any) -> None:
        """Pages say themselves what has happened."""


class MFAAdapter(DefaultMFAAdapter):
    """Passkeys beside the codes of accounts/second_factors.py."""

    def is_mfa_enabled(self, user: Any, types: Any = None) -> bool:
        return isinstance(user, User) and has_second_factor(user)

    def _get_site_name(self) -> str:
        return "Spanwise"

    def _get_user_identifier(self, user: User) -> str:
        return user.username

    def generate_authenticator_name(self, user: Any, type: Authenticator.Type) -> str:
        return _("Passkey")


def _held_back(held: TooManyAttempts) -> str:
    if held.name_is_slow:
        return _(
            "Somebody is guessing the password of this name from many places. Use a browser in which you have signed in before, "
            "ask for a link by mail, or try again in {seconds} s."
        ).format(seconds=held.wait_s)
    return _("Too many wrong tries. Wait 15 min, then try again.")


def _wrong(tries_left: int | None) -> str:
    if tries_left is None:
        return _("User name or password is wrong.")
    if tries_left == 0:
        return _("User name or password is wrong. No tries left for 15 min.")
    words = ngettext(
        "User name or password is wrong. {count} try left for 15 min.",
        "User name or password is wrong. {count} tries left for 15 min.",
        tries_left,
    )
    return words.format(count=tries_left)
