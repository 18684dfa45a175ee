"""Second factor pages: entering the code at login, setup at login or later, new recovery codes, removal."""

from typing import Any

import qrcode
from django import forms
from django.contrib.auth.mixins import AccessMixin, LoginRequiredMixin
from django.http import Http404, HttpRequest, HttpResponse, HttpResponseRedirect
from django.shortcuts import render, resolve_url
from django.utils.decorators import method_decorator
from django.utils.translation import gettext as _
from django.utils.translation import gettext_lazy, ngettext
from django.views.decorators.cache import never_cache
from django.views.generic import FormView
from qrcode.image.svg import SvgPathFillImage

from accounts import second_factors
from accounts.login import SecondFactorStage, SetUpStage, pending_stage, record_sign_in
from accounts.passkeys import PasskeyRefused, confirm_with_passkey, request_options
from accounts.second_factors import TooManyCodes, WrongCode, address_for_apps, new_seed, passkeys_of
from workspace.api.signed_in import SignedInPageRequest
from workspace.field_encryption import CannotDecrypt, decrypt, encrypt
from workspace.models import SecondFactor, SignInOutcome, User
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
    """Asks for a code or a passkey after the password. Without a password in this session it redirects to the login."""

    template_name = "account/sign_in_code.html"
    form_class = CodeForm

    def dispatch(self, request: HttpRequest, *args: Any, **kwargs: Any) -> Any:
        stage = pending_stage(request, SecondFactorStage)
        if stage is None:
            return HttpResponseRedirect(resolve_url("account_login"))
        self.stage, self.person = stage, stage.login.user
        return super().dispatch(request, *args, **kwargs)

    def get_context_data(self, **kwargs: Any) -> dict[str, Any]:
        has_passkey = passkeys_of(self.person).exists()
        return super().get_context_data(**kwargs) | {
            "has_app": second_factors.has_authenticator_app(self.person),
            "passkey_options": request_options(self.person) if has_passkey else None,
        }

    def post(self, request: HttpRequest, *args: Any, **kwargs: Any) -> HttpResponse:
        return self._with_passkey(request.POST["credential"]) if "credential" in request.POST else super().post(request, *args, **kwargs)

    def form_valid(self, form: CodeForm) -> HttpResponse:
        try:
            second_factors.try_code(user=self.person, code=form.cleaned_data["code"])
        except SecondFactor.DoesNotExist:
            return HttpResponseRedirect(resolve_url("account_login"))
        except (WrongCode, TooManyCodes) as error:
            outcome = SignInOutcome.HELD_BACK if isinstance(error, TooManyCodes) else SignInOutcome.WRONG_CODE
            record_sign_in(self.request, outcome, user=self.person, name=self.person.username)
            form.add_error("code", words_of(error))
            return self.form_invalid(form)
        return self.stage.exit()

    def _with_passkey(self, credential: str) -> HttpResponse:
        try:
            confirm_with_passkey(user=self.person, credential=credential)
        except PasskeyRefused:
            record_sign_in(self.request, SignInOutcome.WRONG_CODE, user=self.person)
            fault = _("This passkey is not known here, or the page was open for too long. Try again.")
            return self.render_to_response(self.get_context_data(form=CodeForm(), fault=fault))
        return self.stage.exit()


@method_decorator(never_cache, name="dispatch")
class SetUpPage(AccessMixin, FormView):
    """Shows a QR code for an app, and checks a code of it. Part of the login for users who must have one, else opened from the account."""

    template_name = "account/second_factor.html"

    def dispatch(self, request: HttpRequest, *args: Any, **kwargs: Any) -> Any:
        self.stage = pending_stage(request, SetUpStage)
        if self.stage is not None:
            self.person = self.stage.login.user
        elif isinstance(request.user, User):
            self.person = request.user
        else:
            return self.handle_no_permission()
        if self.stage is not None and second_factors.has_second_factor(self.person):  # a passkey, meanwhile
            return HttpResponseRedirect(resolve_url("account_login"))
        if second_factors.has_authenticator_app(self.person):
            return HttpResponseRedirect(resolve_url("second-factor-codes"))
        return super().dispatch(request, *args, **kwargs)

    def get_form_class(self) -> type[CodeForm]:
        return CodeForm if self.stage else CodeAndPasswordForm

    def get_form_kwargs(self) -> dict[str, Any]:
        return super().get_form_kwargs() | ({} if self.stage else {"user": self.person})

    def get_context_data(self, **kwargs: Any) -> dict[str, Any]:
        text = second_factors.seed_text(self._seed())
        address = address_for_apps(text, self.person.username)
        return super().get_context_data(**kwargs) | {
            "person": self.person,
            "is_required": self.stage is not None,
            "qr_code": _drawn(address),
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
        if self.stage is None:
            return show_codes(self.request, codes, resolve_url("account"))
        signed_in = self.stage.exit()
        response = show_codes(self.request, codes, signed_in.headers["Location"])
        response.cookies.update(signed_in.cookies)  # that of a trusted device
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
        if not second_factors.has_authenticator_app(self.request.user):
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
    """Removes the app. If the organisation requires a second factor and there is no passkey, the next login asks to set up another."""

    template_name = "account/second_factor_remove.html"

    def get_context_data(self, **kwargs: Any) -> dict[str, Any]:
        user = self.request.user
        facts = {"has_passkeys": passkeys_of(user).exists(), "is_required": second_factors.is_required_of(user)}
        return super().get_context_data(**kwargs) | facts

    def done(self, user: User) -> HttpResponse:
        second_factors.remove_authenticator_app(user=user)
        return HttpResponseRedirect(resolve_url("account"))


def _drawn(address: str) -> str:
    """Return the QR code as SVG."""
    code = qrcode.QRCode(error_correction=qrcode.ERROR_CORRECT_M, border=3, image_factory=SvgPathFillImage)
    code.add_data(address)
    return code.make_image().to_string(encoding="unicode")


def show_codes(request: HttpRequest, codes: list[str], go_on: str) -> HttpResponse:
    """Show the recovery codes once; only their hashes are stored."""
    return render(request, "account/recovery_codes.html", {"codes": codes, "go_on": go_on})
