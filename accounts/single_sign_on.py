"""Single sign-on: the account, role and organisation of an identity of the provider. Changes are recorded in the history."""

import logging
from collections.abc import Mapping
from enum import StrEnum
from typing import Any

from allauth.account.internal.flows.login import get_authentication_records
from allauth.account.models import EmailAddress
from allauth.socialaccount.models import SocialAccount
from django.conf import settings
from django.core.exceptions import ValidationError
from django.core.validators import validate_email
from django.db import transaction
from django.http import HttpRequest
from django.utils.translation import gettext as _
from rest_framework.request import Request

from accounts.identity_claims import IdentityProvider, free_user_name, organisations_of, role_of, wanted_user_name
from accounts.identity_provider import identity_provider
from accounts.users import NoAdministratorLeft, save_user
from workspace.api.errors import ApiProblem
from workspace.audit import record_account_event
from workspace.leases import lock_until_end
from workspace.models import DEFAULT_ORGANISATION_ID, Organisation, User

NEW_IDENTITIES_LOCK = 0x05A7_0051  # advisory lock: first sign-ins are serialised, so that each makes one account
METHOD = "socialaccount"  # in the session's records of authentication

logger = logging.getLogger(__name__)


class SignInRefusal(StrEnum):
    ORGANISATION = "organisation"
    ROLE = "role"
    INACTIVE = "inactive"


class SignInRefused(Exception):
    """Raised for an identity that is genuine, but may not sign in. `user` is its account, if it has one."""

    def __init__(self, refusal: SignInRefusal, user: User | None = None) -> None:
        super().__init__(refusal)
        self.refusal, self.user = refusal, user


def local_sign_in_is_on() -> bool:
    """Whether users may sign in with passwords and passkeys of Spanwise."""
    return bool(settings.LOCAL_SIGN_IN)


def require_local_sign_in() -> None:
    """Raise ApiProblem 403 `local_sign_in_off` where passwords and passkeys are switched off."""
    if not local_sign_in_is_on():
        raise ApiProblem(403, "local_sign_in_off", local_sign_in_off())


def local_sign_in_off() -> str:
    provider = identity_provider()
    return _("Passwords and passkeys are switched off here. Sign in with {provider}.").format(provider=provider.name if provider else "")


def identity_of(user: User) -> SocialAccount | None:
    """Return the user's identity at the provider of now."""
    provider = identity_provider()
    return None if provider is None else SocialAccount.objects.filter(user=user, provider=provider.issuer).first()


def is_of_provider_alone(user: User) -> bool:
    """Whether the provider alone signs this user in. A passkey would outlive the account there."""
    return not user.has_usable_password() and identity_of(user) is not None


def came_by_single_sign_on(request: HttpRequest | Request, user: User) -> bool:
    """Whether this session began at the provider, or is beginning there."""
    return any(record.get("method") == METHOD for record in get_authentication_records(request, user))


def user_of_claims(claims: Mapping[str, Any], provider: IdentityProvider) -> User:
    """Return the account of an identity, made or linked at the first time, with the role and organisation of the claims.

    Raises SignInRefused; then nothing is stored.
    """
    with transaction.atomic():
        known = _account_of(claims, provider)
        user = known.user if known else None
        if user is not None and (not user.is_active or user.is_service):
            raise SignInRefused(SignInRefusal.INACTIVE, user)
        organisation, role = _organisation_of(claims, provider, user), role_of(claims, provider)
        if not role:
            raise SignInRefused(SignInRefusal.ROLE, user)
        if user is None:
            user = _first_sign_in(claims, provider, organisation, role)
        else:
            _follow(user, organisation, role)
            if known is not None:
                known.save(update_fields=["last_login"])
    return user


def _account_of(claims: Mapping[str, Any], provider: IdentityProvider) -> SocialAccount | None:
    known = SocialAccount.objects.filter(provider=provider.issuer, uid=claims["sub"])
    found = known.select_related("user__organisation").first()
    if found is None:
        lock_until_end(NEW_IDENTITIES_LOCK)
        found = known.select_related("user__organisation").first()
    return found


def _organisation_of(claims: Mapping[str, Any], provider: IdentityProvider, user: User | None) -> Organisation:
    if not provider.organisation_claim:
        return Organisation.objects.get(pk=DEFAULT_ORGANISATION_ID)
    names = organisations_of(claims, provider)
    found = list(Organisation.objects.filter(name__in=names))
    if len(names) != 1 or not found:
        logger.warning("single sign-on: the claim stands for %d organisations, of which %d exist", len(names), len(found))
        raise SignInRefused(SignInRefusal.ORGANISATION, user)
    return found[0]


def _first_sign_in(claims: Mapping[str, Any], provider: IdentityProvider, organisation: Organisation, role: str) -> User:
    user = _local_user_of_address(claims, provider, organisation)
    if user is None:
        user = _new_user(claims, organisation, role)
    else:
        _follow(user, organisation, role)
    SocialAccount.objects.create(provider=provider.issuer, uid=claims["sub"], user=user)
    record_account_event(user, None, "single sign-on linked")
    return user


def _local_user_of_address(claims: Mapping[str, Any], provider: IdentityProvider, organisation: Organisation) -> User | None:
    """Return the user to link: of this organisation, with the address verified here and there, and without an identity yet.

    An account that operates the installation is never linked: only a command on the machine gives that power.
    """
    if not claims["email_verified"]:
        return None
    here = EmailAddress.objects.filter(email=claims["email"].lower(), verified=True).select_related("user__organisation").first()
    user = here.user if here else None
    is_fitting = (
        isinstance(user, User)
        and user.email.lower() == claims["email"].lower()
        and user.is_active
        and not (user.is_service or user.is_installation_operator)
        and user.organisation_id == organisation.pk
        and not SocialAccount.objects.filter(user=user, provider=provider.issuer).exists()
    )
    return user if is_fitting else None


def _new_user(claims: Mapping[str, Any], organisation: Organisation, role: str) -> User:
    wanted = wanted_user_name(claims)
    taken = {name.lower() for name in User.objects.filter(username__istartswith=wanted[:100]).values_list("username", flat=True)}
    first_of_name, _blank, last_of_name = _text(claims.get("name"), 300).rpartition(" ")
    user = User(
        username=free_user_name(wanted, taken),
        first_name=_text(claims.get("given_name", first_of_name), 150),
        last_name=_text(claims.get("family_name", last_of_name), 150),
        email=_address(claims.get("email")),
        organisation=organisation,
        role=role,
    )
    user.set_unusable_password()
    save_user(user=user, actor=None)
    lower = user.email.lower()
    if user.email and claims["email_verified"] and not EmailAddress.objects.filter(email=lower, verified=True).exists():
        EmailAddress.objects.create(user=user, email=lower, verified=True, primary=True)
    return user


def _follow(user: User, organisation: Organisation, role: str) -> None:
    """Give the user the role and organisation of the claims. The last administrator keeps theirs: nobody else could give it back."""
    if (user.role, user.organisation_id) == (role, organisation.pk):
        return
    user.role, user.organisation = role, organisation
    try:
        save_user(user=user, actor=None)
    except NoAdministratorLeft:
        user.refresh_from_db()
        logger.warning("single sign-on: %s stays the last administrator, against the claims", user.pk)


def _text(claim: Any, longest: int) -> str:
    return "".join(character for character in claim if character.isprintable())[:longest].strip() if isinstance(claim, str) else ""


def _address(claim: Any) -> str:
    try:
        validate_email(claim)
    except (ValidationError, TypeError):
        return ""
    return claim if isinstance(claim, str) and len(claim) <= 254 else ""
