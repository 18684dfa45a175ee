"""Second factor pages: entering the code at login, setup at login or later, new recovery codes, removal."""

from typing import Any

import segno
from django import forms
from django.contrib.auth.mixins import AccessMixin, LoginRequiredMixin
from django.http import Http404, HttpRequest, HttpResponse, HttpResponseRedirect
from django.shortcuts import render, resolve_url
from django.utils.decorators import method_decorator
from django.utils.translation import gettext as _
from django.utils.translation import gettext_lazy, ngettext
from django.views.decorators.cache import never_cache
from django.views.generic import FormView

from accounts import second_factors
from accounts.login import record_sign_in, sign_in, user_with_mfa_pending
from accounts.second_factors import TooManyCodes, WrongCode, address_for_apps, new_seed
from workspace.api.signed_in import SignedInPageRequest
from workspace.field_encryption import CannotDecrypt, decrypt, encrypt
from workspace.models import SignInOutcome, User
from workspace.sessions.sign_in_attempts import PASSWORD_CHANGES, TooManyAttempts, count_attempt

SEED = "workspace.new_seed"  # in the session, encrypted, until an app has produced a code
MAX_CODE_LENGTH = 60


class CodeForm(forms.Form):
    code = forms.CharField(max_length=MAX_CODE_LENGTH, error_messages={"required": gettext_lazy("Type the code.")})


class CodeAndPasswordForm(CodeForm):
    """Form for actions that an unattended browser must not allow."""

    password = forms.CharField(strip=False, max_length=4_096, error_messages={"required": gettext_lazy("Type your password.")})

    def __init__(self, *args: Any, user: User, **options: Any) -> None:
        super().__init__(*args, **options)
        self.user = user

    def clean_password(self) -> str:
        try:
            count_attempt(PASSWORD_CHANGES, str(self.user.pk))
        except TooManyAttempts as error:
            raise forms.ValidationError(_("Too many tries. Wait 15 min, then try again.")) from error
        password: str = self.cleaned_data["password"]
        if not self.user.check_password(password):
            raise forms.ValidationError(_("This is not your password."))
        return password


def words_of(error: Exception) -> str:
    """Return the text why a code was refused."""
    if isinstance(error, TooManyCodes):
        return _("Too many wrong codes. Wait 15 min, then try again.")
    left = error.left if isinstance(error, WrongCode) else 0
    words = ngettext(
        "This is no code of now, or it was used already. {count} try left for 15 min.",
        "This is no code of now, or it was used already. {count} tries left for 15 min.",
        left,
    )
    return words.format(count=left)


@method_decorator(never_cache, name="dispatch")
class CodePage(FormView):
    """Asks for the code after the password. Without a password in this session it redirects to the login."""

    template_name = "account/sign_in_code.html"
    form_class = CodeForm

    def dispatch(self, request: HttpRequest, *args: Any, **kwargs: Any) -> Any:
        mfa_pending = user_with_mfa_pending(request)
        if mfa_pending is None or not second_factors.has_second_factor(mfa_pending.user):
            return HttpResponseRedirect(resolve_url("sign-in"))
        self.mfa_pending = mfa_pending
        return super().dispatch(request, *args, **kwargs)

    def form_valid(self, form: CodeForm) -> HttpResponse:
        user = self.mfa_pending.user
        try:
            second_factors.try_code(user=user, code=form.cleaned_data["code"])
        except (WrongCode, TooManyCodes) as error:
            outcome = SignInOutcome.HELD_BACK if isinstance(error, TooManyCodes) else SignInOutcome.WRONG_CODE
            record_sign_in(self.request, outcome, user=user, name=user.username)
            form.add_error("code", words_of(error))
            return self.form_invalid(form)
        response = HttpResponseRedirect(self.mfa_pending.wanted)
        sign_in(self.request, response, user)
        return response


@method_decorator(never_cache, name="dispatch")
class SetUpPage(AccessMixin, FormView):
    """Shows a QR code for an app, and checks a code of it. Part of the login for users who must have one, else opened from the account."""

    template_name = "account/second_factor.html"

    def dispatch(self, request: HttpRequest, *args: Any, **kwargs: Any) -> Any:
        self.mfa_pending = None if request.user.is_authenticated else user_with_mfa_pending(request)
        if self.mfa_pending is not None:
            self.person = self.mfa_pending.user
        elif isinstance(request.user, User):
            self.person = request.user
        else:
            return self.handle_no_permission()
        if second_factors.has_second_factor(self.person):
            return HttpResponseRedirect(resolve_url("sign-in-code" if self.mfa_pending else "second-factor-codes"))
        return super().dispatch(request, *args, **kwargs)

    def get_form_class(self) -> type[CodeForm]:
        return CodeForm if self.mfa_pending else CodeAndPasswordForm

    def get_form_kwargs(self) -> dict[str, Any]:
        return super().get_form_kwargs() | ({} if self.mfa_pending else {"user": self.person})

    def get_context_data(self, **kwargs: Any) -> dict[str, Any]:
        text = second_factors.seed_text(self._seed())
        address = address_for_apps(text, self.person.username)
        return super().get_context_data(**kwargs) | {
            "person": self.person,
            "is_required": self.mfa_pending is not None,
            "qr_code": segno.make(address, error="m", micro=False).svg_inline(border=3, light="#fff", omitsize=True),
            "address": address,
            "seed_groups": [text[place : place + 4] for place in range(0, len(text), 4)],
        }

    def form_valid(self, form: CodeForm) -> HttpResponse:
        try:
            codes = second_factors.set_up(user=self.person, seed=self._seed(), code=form.cleaned_data["code"])
        except WrongCode:
            form.add_error("code", _("This is not the app’s code of now. Wait for the next one. The telephone’s clock has to be right."))
            return self.form_invalid(form)
        del self.request.session[SEED]
        response = show_codes(self.request, codes, self.mfa_pending.wanted if self.mfa_pending else resolve_url("account"))
        if self.mfa_pending:
            sign_in(self.request, response, self.person)
        return response

    def _seed(self) -> bytes:
        """Return the seed, unchanged while the page is open: an app may have read it."""
        name = f"new second factor of {self.person.pk}"
        try:
            return decrypt(self.request.session[SEED], of=name)
        except (KeyError, CannotDecrypt):
            seed = new_seed()
            self.request.session[SEED] = encrypt(seed, of=name)
            return seed


class _OwnCodePage(LoginRequiredMixin, FormView):
    """Base of pages that ask for password and code again; 404 for users without a second factor."""

    request: SignedInPageRequest
    form_class = CodeAndPasswordForm

    def get_form_kwargs(self) -> dict[str, Any]:
        return super().get_form_kwargs() | {"user": self.request.user}

    def get(self, request: HttpRequest, *args: Any, **kwargs: Any) -> HttpResponse:
        self._or_404()
        return super().get(request, *args, **kwargs)

    def post(self, request: HttpRequest, *args: Any, **kwargs: Any) -> HttpResponse:
        self._or_404()
        return super().post(request, *args, **kwargs)

    def form_valid(self, form: CodeAndPasswordForm) -> HttpResponse:
        try:
            second_factors.try_code(user=form.user, code=form.cleaned_data["code"])
        except (WrongCode, TooManyCodes) as error:
            form.add_error("code", words_of(error))
            return self.form_invalid(form)
        return self.done(form.user)

    def done(self, user: User) -> HttpResponse:
        raise NotImplementedError

    def _or_404(self) -> None:
        if not second_factors.has_second_factor(self.request.user):
            raise Http404


@method_decorator(never_cache, name="dispatch")
class NewCodesPage(_OwnCodePage):
    """Makes new recovery codes and invalidates the old ones."""

    template_name = "account/second_factor_codes.html"

    def get_context_data(self, **kwargs: Any) -> dict[str, Any]:
        return super().get_context_data(**kwargs) | {"left": second_factors.recovery_codes_left(self.request.user)}

    def done(self, user: User) -> HttpResponse:
        return show_codes(self.request, second_factors.renew_recovery_codes(user=user), resolve_url("account"))


@method_decorator(never_cache, name="dispatch")
class RemovePage(_OwnCodePage):
    """Removes the second factor. If the organisation requires one, the next login asks to set up another."""

    template_name = "account/second_factor_remove.html"

    def get_context_data(self, **kwargs: Any) -> dict[str, Any]:
        return super().get_context_data(**kwargs) | {"is_required": second_factors.is_required_of(self.request.user)}

    def done(self, user: User) -> HttpResponse:
        second_factors.take_away(user=user, actor=user)
        return HttpResponseRedirect(resolve_url("account"))


def show_codes(request: HttpRequest, codes: list[str], go_on: str) -> HttpResponse:
    """Show the recovery codes once; only their hashes are stored."""
    return render(request, "account/recovery_codes.html", {"codes": codes, "go_on": go_on})
