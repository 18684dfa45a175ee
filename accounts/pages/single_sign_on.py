"""Pages of single sign-on: to the identity provider, back from it, and why it did not work."""

import logging
import time
from typing import Any

from allauth.account.internal.flows.login import perform_login, record_authentication
from allauth.account.models import Login
from allauth.account.utils import get_next_redirect_url
from allauth.socialaccount.internal import statekit
from allauth.socialaccount.providers.oauth2.utils import generate_code_challenge
from django.contrib.auth.mixins import LoginRequiredMixin
from django.http import Http404, HttpRequest, HttpResponse, HttpResponseRedirect
from django.shortcuts import render, resolve_url
from django.urls import reverse
from django.utils.crypto import get_random_string
from django.utils.decorators import method_decorator
from django.utils.translation import gettext as _
from django.views.decorators.cache import never_cache
from django.views.generic import View

from accounts.identity_claims import IdentityProvider
from accounts.identity_provider import LEEWAY_S, ProviderUnavailable, WrongAnswer, authorization_address, claims_of_code, identity_provider
from accounts.invitations import public_address
from accounts.login import note_reauthentication, record_sign_in
from accounts.single_sign_on import (
    METHOD,
    SignInRefusal,
    SignInRefused,
    identity_of,
    local_sign_in_is_on,
    local_sign_in_off,
    user_of_claims,
)
from workspace.models import SignInOutcome, User
from workspace.sessions.sign_in_attempts import TooManyAttempts, address_of, count_attempt, network_of

STARTS_OF_A_NETWORK = 200  # in a quarter of an hour: each makes a session
MAX_CODE_LENGTH = 4_096
FRESH = {"prompt": "login", "max_age": "0"}  # the provider must ask again; its ID token then says when: OpenID Connect Core 1.0, 3.1.2.1
ANOTHER_ACCOUNT = {"prompt": "select_account"}

logger = logging.getLogger(__name__)


def refuse_local_sign_in(request: HttpRequest) -> HttpResponse:
    """Return the page that names the only way to sign in."""
    provider = identity_provider()
    facts = {"provider": provider and provider.name, "title": local_sign_in_off(), "advice": ""}
    return render(request, "account/single_sign_on.html", facts, status=403)


class LocalSignInRequired:
    """Mixin of pages about local passwords: 403 where they are switched off."""

    def dispatch(self, request: HttpRequest, *args: Any, **kwargs: Any) -> Any:
        return super().dispatch(request, *args, **kwargs) if local_sign_in_is_on() else refuse_local_sign_in(request)  # type: ignore[misc]


@method_decorator(never_cache, name="dispatch")
class _SingleSignOnView(View):
    provider: IdentityProvider

    def dispatch(self, request: HttpRequest, *args: Any, **kwargs: Any) -> Any:
        provider = identity_provider()
        if provider is None:
            raise Http404
        self.provider = provider
        return super().dispatch(request, *args, **kwargs)

    def to_provider(self, request: HttpRequest, *, of: int | None = None, more: dict[str, str] | None = None) -> HttpResponse:
        """Redirect to the provider. State, nonce and code verifier stay in this session and work once, for ten minutes."""
        proof = generate_code_challenge()
        begun: dict[str, Any] = {
            "nonce": get_random_string(43), "verifier": proof["code_verifier"], "next": get_next_redirect_url(request), "of": of,
            "redirect": public_address(request) + reverse("single-sign-on-callback"), "at": time.time(),
        }  # fmt: skip
        state, challenge = get_random_string(43), proof["code_challenge"].decode()
        try:
            address = authorization_address(
                self.provider, redirect=begun["redirect"], state=state, nonce=begun["nonce"], challenge=challenge, more=more or {}
            )
        except ProviderUnavailable as error:
            return self.unavailable(request, error)
        except WrongAnswer as error:
            return self.mistrusted(request, error)
        statekit.stash_state(request, provider_id=self.provider.issuer, state=begun, state_id=state)
        return HttpResponseRedirect(address)

    def fails(self, request: HttpRequest, status: int, title: str, advice: str) -> HttpResponse:
        facts = {"provider": self.provider.name, "title": title, "advice": advice, "can_switch": status == 403}
        return render(request, "account/single_sign_on.html", facts, status=status)

    def unavailable(self, request: HttpRequest, error: ProviderUnavailable) -> HttpResponse:
        logger.warning("single sign-on: %s", error)
        advice = _("Try again in a minute. If it goes on, tell an administrator of your organisation.")
        return self.fails(request, 503, _("{provider} does not answer").format(provider=self.provider.name), advice)

    def mistrusted(self, request: HttpRequest, error: WrongAnswer) -> HttpResponse:
        logger.warning("single sign-on: %s", error)
        record_sign_in(request, SignInOutcome.REFUSED)
        advice = _("Start again. If it goes on, tell an administrator: the program’s log says what was wrong.")
        title = _("The answer of {provider} is not trusted").format(provider=self.provider.name)
        return self.fails(request, 403, title, advice)

    def expired(self, request: HttpRequest) -> HttpResponse:
        advice = _("It was used already, took more than ten minutes, or began in another browser. Start again.")
        return self.fails(request, 400, _("This sign-in has expired"), advice)


class SingleSignOn(_SingleSignOnView):
    """Leads to the provider. It is opened by a link: the pages' policy forbids forms that lead elsewhere."""

    def get(self, request: HttpRequest) -> HttpResponse:
        if request.user.is_authenticated:
            return HttpResponseRedirect(get_next_redirect_url(request) or resolve_url("missions"))
        if request.headers.get("Sec-Fetch-Site") == "cross-site":  # nobody is signed in by the page of another site
            return HttpResponseRedirect(f"{resolve_url('account_login')}?{request.GET.urlencode()}")
        try:
            count_attempt("single sign-on from", network_of(address_of(request)), most=STARTS_OF_A_NETWORK)
        except TooManyAttempts:
            return self.fails(request, 429, _("Too many tries"), _("Wait 15 min, then try again."))
        return self.to_provider(request, more=ANOTHER_ACCOUNT if "another" in request.GET else None)


class SingleSignOnReauthentication(LoginRequiredMixin, _SingleSignOnView):
    """Leads to the provider, which must ask the user again."""

    def get(self, request: HttpRequest) -> HttpResponse:
        if not isinstance(request.user, User) or identity_of(request.user) is None:
            raise Http404
        return self.to_provider(request, of=request.user.pk, more=FRESH)


class SingleSignOnCallback(_SingleSignOnView):
    """Takes the provider's answer: signs in, or notes the reauthentication."""

    def get(self, request: HttpRequest) -> HttpResponse:
        begun = statekit.unstash_state(request, provider_id=self.provider.issuer, state_id=request.GET.get("state", ""))
        if begun is None or request.GET.get("iss", self.provider.issuer) != self.provider.issuer:  # RFC 9207
            return self.expired(request)
        if begun["of"] is None and request.user.is_authenticated:  # meanwhile, in another tab
            return HttpResponseRedirect(begun["next"] or resolve_url("missions"))
        if "error" in request.GET:
            return self._denied(request, request.GET["error"])
        code = request.GET.get("code", "")
        if not 0 < len(code) <= MAX_CODE_LENGTH:
            return self.expired(request)
        try:
            claims = claims_of_code(self.provider, code=code, redirect=begun["redirect"], verifier=begun["verifier"], nonce=begun["nonce"])
            if begun["of"] is not None:
                return self._reauthenticated(request, begun, claims)
            return self._signed_in(request, begun, claims)
        except ProviderUnavailable as error:
            return self.unavailable(request, error)
        except WrongAnswer as error:
            return self.mistrusted(request, error)
        except SignInRefused as refused:
            return self._refused(request, refused)

    def _signed_in(self, request: HttpRequest, begun: dict[str, Any], claims: dict[str, Any]) -> HttpResponse:
        user = user_of_claims(claims, self.provider)
        record_authentication(request, user, METHOD, provider=self.provider.issuer, uid=claims["sub"])
        response = perform_login(request, Login(user=user, redirect_url=begun["next"]))
        if isinstance(authenticated_at := claims.get("auth_time"), int):
            note_reauthentication(request.session, at_s=min(authenticated_at, time.time()))
        return response

    def _reauthenticated(self, request: HttpRequest, begun: dict[str, Any], claims: dict[str, Any]) -> HttpResponse:
        """Note the reauthentication, if the provider has asked the same user since it was begun."""
        user = request.user
        identity = identity_of(user) if isinstance(user, User) and user.pk == begun["of"] else None
        if identity is None:
            return self.expired(request)
        if identity.uid != claims["sub"]:
            raise WrongAnswer("another user has authenticated")
        authenticated_at = claims.get("auth_time")
        if not isinstance(authenticated_at, int) or not begun["at"] - LEEWAY_S <= authenticated_at <= time.time() + LEEWAY_S:
            raise WrongAnswer("auth_time does not say that the user has authenticated anew")
        note_reauthentication(request.session)
        return HttpResponseRedirect(begun["next"] or resolve_url("account"))

    def _denied(self, request: HttpRequest, error: str) -> HttpResponse:
        logger.warning("single sign-on: the provider answers with the error %s", "".join(filter(str.isprintable, error[:60])))
        if error in {"server_error", "temporarily_unavailable"}:
            return self.unavailable(request, ProviderUnavailable(error[:60]))
        title, advice = _("{provider} did not sign you in"), _("You have cancelled, or {provider} does not let you use Spanwise.")
        return self.fails(request, 403, title.format(provider=self.provider.name), advice.format(provider=self.provider.name))

    def _refused(self, request: HttpRequest, refused: SignInRefused) -> HttpResponse:
        record_sign_in(request, SignInOutcome.REFUSED, user=refused.user)
        advice = {
            SignInRefusal.ORGANISATION: _("{provider} names no organisation of yours that is known here. Ask an administrator for access."),
            SignInRefusal.ROLE: _("{provider} gives you no role in Spanwise. Ask an administrator to put you into a group that has one."),
            SignInRefusal.INACTIVE: _("Your account is disabled. Ask an administrator of your organisation."),
        }[refused.refusal]
        return self.fails(request, 403, _("You have no access to Spanwise"), advice.format(provider=self.provider.name))
