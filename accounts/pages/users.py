"""Pages of the own account, of user administration, and behind an invitation's link."""

from typing import Any

from allauth.account.internal.flows.login import perform_login
from allauth.account.models import Login
from django.conf import settings
from django.contrib.auth.forms import BaseUserCreationForm, UserCreationForm
from django.contrib.auth.mixins import UserPassesTestMixin
from django.db import IntegrityError, transaction
from django.http import HttpRequest, HttpResponse
from django.shortcuts import render, resolve_url
from django.utils.decorators import method_decorator
from django.utils.translation import gettext as _
from django.views.decorators.cache import never_cache
from django.views.generic import FormView, TemplateView

from accounts.email_addresses import AddressTaken, LinkInvalid, is_verified, user_of_link, verify
from accounts.identity_provider import identity_provider
from accounts.invitations import InvitationGone, accept_invitation, mail_leaves_here, open_invitation
from accounts.pages.single_sign_on import refuse_local_sign_in
from accounts.second_factors import has_authenticator_app, is_required_of, passkeys_of, recovery_codes_left
from accounts.single_sign_on import identity_of, is_of_provider_alone, local_sign_in_is_on
from workspace.models import SCOPES_OF_ROLE, User
from workspace.pages import SignedInPage
from workspace.sessions.preferences import TIME_ZONES

NAMED_ZONES = sorted(zone for zone in TIME_ZONES if "/" in zone or zone == "UTC")


class AccountPage(SignedInPage):
    template_name = "account.html"
    extra_context = {"section": "account", "time_zones": NAMED_ZONES}

    def get_context_data(self, **kwargs: Any) -> dict[str, Any]:
        user = self.request.user
        has_one = has_authenticator_app(user)
        provider = identity_provider()
        return super().get_context_data(**kwargs) | {
            "provider": provider if provider and identity_of(user) else None,
            "has_local_sign_in": local_sign_in_is_on() and not is_of_provider_alone(user),
            "has_authenticator_app": has_one,
            "has_passkeys": passkeys_of(user).exists(),
            "second_factor_is_required": is_required_of(user),
            "codes_left": recovery_codes_left(user) if has_one else 0,
            "address_is_verified": is_verified(user),
            "mail_leaves_here": mail_leaves_here(),
            "languages": settings.LANGUAGES,
            "token_scopes": [(scope.value, scope.label) for scope in SCOPES_OF_ROLE[user.role]],
        }


@method_decorator(never_cache, name="dispatch")
class EmailAddressPage(TemplateView):
    """The page behind a mailed link. Its button verifies the address: programs that read mail open links, too."""

    template_name = "account/email_address.html"

    def get_context_data(self, **kwargs: Any) -> dict[str, Any]:
        try:
            person = user_of_link(kwargs["key"])
        except LinkInvalid:
            person = None
        return super().get_context_data(**kwargs) | {"person": person}

    def post(self, request: HttpRequest, key: str) -> HttpResponse:
        try:
            verify(request=request, key=key)
        except LinkInvalid:
            return self.get(request, key=key)
        except AddressTaken:
            return self.render_to_response(self.get_context_data(key=key) | {"is_taken": True})
        return self.render_to_response({"is_verified": True})


class AdministrationPage(UserPassesTestMixin, SignedInPage):
    """Users, invitations and the sign-in log, for administrators."""

    template_name = "administration.html"
    extra_context = {"section": "administration", "time_zones": NAMED_ZONES}

    def test_func(self) -> bool:
        return bool(self.request.user.is_authenticated and self.request.user.is_superuser)

    def page(self, **kwargs: Any) -> dict[str, Any]:
        return {"mailLeavesHere": mail_leaves_here()}


class NewAccountForm(UserCreationForm):
    """Form of a new account; the invitation sets role and organisation."""

    class Meta(BaseUserCreationForm.Meta):
        model = User
        fields = ("username", "first_name", "last_name", "email")


@method_decorator(never_cache, name="dispatch")
class InvitationPage(FormView):
    """Makes the account and logs in. An invalid link is reported as such without the reason."""

    template_name = "account/invitation.html"
    form_class = NewAccountForm

    def dispatch(self, request: HttpRequest, *args: Any, **kwargs: Any) -> Any:
        if not local_sign_in_is_on():
            return refuse_local_sign_in(request)
        try:
            self.invitation = open_invitation(kwargs["token"])
        except InvitationGone:
            return self._gone()
        if request.user.is_authenticated:
            return render(request, "account/invitation_signed_in.html")
        return super().dispatch(request, *args, **kwargs)

    def get_initial(self) -> dict[str, Any]:
        return {"email": self.invitation.email}

    def get_form_kwargs(self) -> dict[str, Any]:
        newcomer = User(organisation=self.invitation.organisation)  # whose name must not be the password
        return super().get_form_kwargs() | {"instance": newcomer}

    def get_context_data(self, **kwargs: Any) -> dict[str, Any]:
        return super().get_context_data(**kwargs) | {"invitation": self.invitation}

    def form_valid(self, form: NewAccountForm) -> HttpResponse:
        try:
            with transaction.atomic():
                user = accept_invitation(token=self.kwargs["token"], user=form.save(commit=False))
        except InvitationGone:
            return self._gone()
        except IntegrityError:  # two users chose the same name concurrently
            form.add_error("username", _("Somebody has this name already."))
            return self.form_invalid(form)
        return perform_login(self.request, Login(user=user, redirect_url=resolve_url("missions")))

    def _gone(self) -> HttpResponse:
        return render(self.request, "account/invitation_gone.html", status=410)
