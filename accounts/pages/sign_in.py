"""Login by password or passkey, and logout."""

from typing import Any

from allauth.account.forms import LoginForm
from allauth.account.internal.flows.login import perform_login
from allauth.account.models import Login
from allauth.account.utils import get_next_redirect_url
from allauth.account.views import LoginView
from allauth.mfa.base.internal.flows import post_authentication
from django.contrib.auth import views
from django.http import HttpRequest, HttpResponse, JsonResponse
from django.utils.decorators import method_decorator
from django.utils.translation import gettext as _
from django.views.decorators.cache import never_cache
from django.views.generic import View

from accounts.email_addresses import user_name_of
from accounts.identity_provider import identity_provider
from accounts.login import record_sign_in
from accounts.pages.single_sign_on import LocalSignInRequired, refuse_local_sign_in
from accounts.passkeys import PasskeyRefused, passkey_of_response, request_options
from accounts.single_sign_on import local_sign_in_is_on
from workspace.models import SignInOutcome, User
from workspace.sessions.sign_in_attempts import TRIES_OF_A_NETWORK, TooManyAttempts, address_of, count_attempt, network_of

PASSKEY_CHALLENGES = 200  # of one network in a quarter of an hour: each makes a session


class SignInForm(LoginForm):
    """The form of user name, or e-mail address, and password."""

    def clean_login(self) -> str:
        return user_name_of(User.normalize_username(super().clean_login()))


class SignInPage(LoginView):
    template_name = "sign_in.html"

    def get_context_data(self, **kwargs: Any) -> dict[str, Any]:
        facts = {"next": self.get_next_url() or "", "provider": identity_provider(), "local_sign_in": local_sign_in_is_on()}
        return super().get_context_data(**kwargs) | facts

    def post(self, request: HttpRequest, *args: Any, **kwargs: Any) -> HttpResponse:
        return super().post(request, *args, **kwargs) if local_sign_in_is_on() else refuse_local_sign_in(request)


@method_decorator(never_cache, name="dispatch")
class PasskeySignIn(LocalSignInRequired, View):
    """GET returns a challenge as JSON; POST takes its signature from the form of the sign-in page."""

    def get(self, request: HttpRequest) -> HttpResponse:
        try:
            count_attempt("passkey challenges to", network_of(address_of(request)), most=PASSKEY_CHALLENGES)
        except TooManyAttempts as held:
            return JsonResponse(
                {"message": _("Too many tries. Wait 15 min, then try again.")}, status=429, headers={"Retry-After": held.wait_s}
            )
        return JsonResponse(request_options(None))

    def post(self, request: HttpRequest) -> HttpResponse:
        try:
            passkey = passkey_of_response(request.POST.get("credential", ""))
        except PasskeyRefused:
            _record_refusal(request)
            return _refused(request)
        post_authentication(request, passkey, passwordless=True)
        return perform_login(request, Login(user=passkey.user, redirect_url=get_next_redirect_url(request)))


def _record_refusal(request: HttpRequest) -> None:
    """Record a refused passkey: passkeys cannot be guessed, so only the rows are limited."""
    outcome = SignInOutcome.WRONG
    try:
        count_attempt("refused passkeys of", network_of(address_of(request)), most=TRIES_OF_A_NETWORK)
    except TooManyAttempts:
        outcome = SignInOutcome.HELD_BACK
    record_sign_in(request, outcome)


def _refused(request: HttpRequest) -> HttpResponse:
    """Return the sign-in page that says so."""
    page = SignInPage()
    page.setup(request)
    form = page.get_form_class()(request=request)
    return page.render_to_response(
        page.get_context_data(form=form, fault=_("This passkey is not known here, or the page was open for too long. Try again."))
    )


class SignOutPage(views.LogoutView):
    """Ends the session; anonymous users are redirected to the login."""

    def post(self, request: HttpRequest, *args: Any, **kwargs: Any) -> HttpResponse:
        if isinstance(request.user, User):
            record_sign_in(request, SignInOutcome.SIGNED_OUT, user=request.user)
        return super().post(request, *args, **kwargs)
