"""Login with limits, and logout."""

from typing import Any

from django.contrib.auth import views
from django.contrib.auth.forms import AuthenticationForm
from django.core.exceptions import ValidationError
from django.http import HttpRequest, HttpResponse
from django.utils.translation import gettext as _
from django.utils.translation import ngettext

from accounts.login import let_in, record_sign_in
from workspace.models import SignInOutcome, User
from workspace.sessions.sign_in_attempts import TooManyAttempts, address_of, mark_of, try_to_sign_in


class SignInForm(AuthenticationForm):
    """Django's form, with limits on wrong tries and one message that does not reveal which part was wrong."""

    request: HttpRequest  # always set by the page

    def clean(self) -> dict[str, Any]:
        name = self.cleaned_data.get("username", "")
        request = self.request
        if not (name and self.cleaned_data.get("password")):
            return super().clean()
        try:
            this_try = try_to_sign_in(name=name, address=address_of(request), trusted_device=mark_of(request, name))
        except TooManyAttempts as held:
            record_sign_in(request, SignInOutcome.HELD_BACK, name=name)
            raise ValidationError(_held_back(held), code="locked") from held
        try:
            cleaned = super().clean()
        except ValidationError as error:
            record_sign_in(request, SignInOutcome.WRONG, name=name)
            raise ValidationError(_wrong(this_try.left), code="invalid_login") from error
        this_try.succeeded()
        return cleaned


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


class SignInPage(views.LoginView):
    template_name = "sign_in.html"
    authentication_form = SignInForm
    redirect_authenticated_user = True

    def form_valid(self, form: AuthenticationForm) -> HttpResponse:
        return let_in(self.request, form.get_user(), self.get_success_url())


class SignOutPage(views.LogoutView):
    """Ends the session; anonymous users are redirected to the login."""

    def post(self, request: HttpRequest, *args: Any, **kwargs: Any) -> HttpResponse:
        if isinstance(request.user, User):
            record_sign_in(request, SignInOutcome.SIGNED_OUT, user=request.user)
        return super().post(request, *args, **kwargs)
