"""Password pages of an account: change it, or reset a lost one by mail."""

import logging
from threading import Thread
from typing import Any

from django.contrib.auth import views
from django.contrib.auth.forms import PasswordChangeForm, PasswordResetForm, SetPasswordForm
from django.core.exceptions import ValidationError
from django.http import HttpResponse
from django.urls import reverse_lazy
from django.utils import translation
from django.utils.translation import gettext as _

from accounts.invitations import mail_leaves_here, public_address
from accounts.pages.single_sign_on import LocalSignInRequired
from accounts.services import revoke_tokens
from workspace.sessions.sign_in_attempts import PASSWORD_CHANGES, TooManyAttempts, address_of, count_attempt, network_of, remember

logger = logging.getLogger(__name__)


class LostPasswordForm(PasswordResetForm):
    """Django's form with a limit: a few mails per account and client address in a quarter of an hour."""

    def __init__(self, *args: Any, address: str = "", **options: Any) -> None:
        super().__init__(*args, **options)
        self.address = address

    def clean_email(self) -> str:
        email: str = self.cleaned_data["email"]
        try:
            count_attempt("mails to", email)
            count_attempt("mails from", network_of(self.address))
        except TooManyAttempts as error:
            raise ValidationError(_("Too many mails were asked for. Wait 15 min, then try again."), code="locked") from error
        return email

    def send_mail(self, *args: Any, **options: Any) -> None:
        """Send the mail in a thread, in the page's language: the response time must not reveal whether the account exists.

        On the console backend nothing is sent: the link would be in a log, whose readers could set the password.
        """
        if not mail_leaves_here():
            logger.warning("a link to a new password was asked for, and SPANWISE_EMAIL_URL names no way for mail")
            return
        in_its_language = translation.override(translation.get_language())(super().send_mail)
        Thread(target=in_its_language, args=args, kwargs=options, name="mail with a link", daemon=True).start()


class LostPasswordPage(LocalSignInRequired, views.PasswordResetView):
    """Sends a link if the address belongs to an account. The response is the same if it does not."""

    template_name = "account/lost_password.html"
    email_template_name = "account/lost_password_mail.txt"
    subject_template_name = "account/lost_password_subject.txt"
    form_class = LostPasswordForm
    success_url = reverse_lazy("lost-password-sent")

    def get_form_kwargs(self) -> dict[str, Any]:
        scheme, _separator, host = public_address(self.request).partition("://")
        self.extra_email_context = {"protocol": scheme, "domain": host}
        return super().get_form_kwargs() | {"address": address_of(self.request)}


class LostPasswordSentPage(LocalSignInRequired, views.PasswordResetDoneView):
    template_name = "account/lost_password_sent.html"


class NewPasswordPage(LocalSignInRequired, views.PasswordResetConfirmView):
    """The page behind the mail's link, which works once and for an hour."""

    template_name = "account/new_password.html"
    success_url = reverse_lazy("new-password-set")

    def form_valid(self, form: SetPasswordForm) -> HttpResponse:
        """Set the password and trust this browser: limits caused by others' attempts no longer affect its owner here."""
        response = super().form_valid(form)
        revoke_tokens(user=form.user, actor=form.user)  # made by users of the old password, perhaps
        remember(self.request, response, form.user.get_username())
        return response


class NewPasswordSetPage(LocalSignInRequired, views.PasswordResetCompleteView):
    template_name = "account/new_password_set.html"


class ChangePasswordForm(PasswordChangeForm):
    """Django's form with a limit, against guessing in an unattended browser."""

    def clean_old_password(self) -> str:
        try:
            count_attempt(PASSWORD_CHANGES, str(self.user.pk))
        except TooManyAttempts as error:
            raise ValidationError(_("Too many tries. Wait 15 min, then try again."), code="locked") from error
        return str(super().clean_old_password())


class ChangePasswordPage(LocalSignInRequired, views.PasswordChangeView):
    template_name = "account/change_password.html"
    form_class = ChangePasswordForm
    success_url = reverse_lazy("password-changed")


class PasswordChangedPage(views.PasswordChangeDoneView):
    template_name = "account/password_changed.html"
