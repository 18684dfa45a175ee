"""E-mail addresses: sign-in by address, and their verification by a mailed link."""

from allauth.account.internal.flows.email_verification import verify_email
from allauth.account.models import EmailAddress, EmailConfirmationHMAC
from django.core.mail import send_mail
from django.db import IntegrityError, transaction
from django.http import HttpRequest
from django.template.loader import render_to_string
from django.urls import reverse
from django.utils.translation import gettext as _

from accounts.invitations import mail_leaves_here, public_address
from workspace.audit import record_account_event
from workspace.models import User


class LinkInvalid(Exception):
    """Raised for a link that is damaged or expired, or whose address is verified or no longer that of the user."""


class AddressTaken(Exception):
    """Raised when another user has verified the address."""


def user_name_of(typed: str) -> str:
    """Return the user name of what was typed at sign-in: a name, or an e-mail address that is verified or of one user only."""
    if "@" not in typed or User.objects.filter(username=typed).exists():
        return typed
    verified = EmailAddress.objects.filter(email=typed.lower(), verified=True, user__email__iexact=typed)  # and the user's still
    owner = verified.values_list("user__username", flat=True).first()
    if owner is not None:
        return owner
    names = list(User.objects.filter(email__iexact=typed, is_active=True, is_service=False).values_list("username", flat=True)[:2])
    return names[0] if len(names) == 1 else typed


def is_verified(user: User) -> bool:
    return bool(user.email) and EmailAddress.objects.filter(user=user, email=user.email.lower(), verified=True).exists()


def send_verification(*, request: HttpRequest, user: User) -> bool:
    """Send the user a link that verifies the address; returns whether the mail server accepted it."""
    if not (user.email and mail_leaves_here()) or is_verified(user):
        return False
    address, _made = EmailAddress.objects.get_or_create(user=user, email=user.email.lower())
    link = public_address(request) + reverse("account_confirm_email", args=[EmailConfirmationHMAC.create(address).key])
    text = render_to_string("account/email_address_mail.txt", {"user": user, "link": link})
    try:
        return bool(send_mail(_("Your e-mail address at Spanwise"), text, None, [user.email]))
    except OSError:  # includes SMTP's errors
        return False


def user_of_link(key: str) -> User:
    """Return whose address a link verifies. Raises LinkInvalid."""
    return _address_of(key).user


def verify(*, request: HttpRequest, key: str) -> User:
    """Verify the address of a link. Raises LinkInvalid, AddressTaken."""
    try:
        with transaction.atomic():
            User.objects.select_for_update().get(pk=_address_of(key).user_id)  # nobody changes the address meanwhile
            return _verify(request, _address_of(key))
    except IntegrityError as error:  # another user verified it at the same time
        raise AddressTaken from error


def _verify(request: HttpRequest, address: EmailAddress) -> User:
    stored = address.user.email
    if not verify_email(request, address):
        raise AddressTaken
    user: User = address.user
    User.objects.filter(pk=user.pk).update(email=stored)  # as it was typed
    record_account_event(user, user, "address verified")
    return user


def _address_of(key: str) -> EmailAddress:
    found = EmailConfirmationHMAC.from_key(key)
    if found is None or found.email_address.email != found.email_address.user.email.lower() or not found.email_address.user.is_active:
        raise LinkInvalid
    return found.email_address
