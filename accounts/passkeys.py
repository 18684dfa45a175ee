"""Passkeys (WebAuthn): registration, sign-in, reauthentication, removal. Each change is recorded in the history."""

import json
import struct
from typing import Any

from allauth.core import context
from allauth.mfa.models import Authenticator
from allauth.mfa.webauthn.forms import AddWebAuthnForm, AuthenticateWebAuthnForm, LoginWebAuthnForm
from allauth.mfa.webauthn.internal import auth, flows
from cryptography.exceptions import InvalidSignature, UnsupportedAlgorithm
from django.conf import settings
from django.db import transaction
from django.http import HttpRequest
from fido2.cose import CoseKey, UnsupportedKey
from fido2.utils import websafe_decode
from fido2.webauthn import CollectedClientData

from accounts.second_factors import passkeys_of
from workspace.audit import record_account_event
from workspace.models import User

MAX_PASSKEYS = 20  # of one user
MAX_NAME_LENGTH = 60
MAX_RESPONSE_LENGTH = 32_768  # of one that is stored: each sign-in of the user reads it


class PasskeyRefused(Exception):
    """Raised for a response of an authenticator that is damaged, expired, or of another user, key or host."""


class TooManyPasskeys(Exception):
    """Raised at the limit of passkeys: old ones must be removed first."""


def creation_options(user: User) -> dict[str, Any]:
    """Return the options of `navigator.credentials.create` in its JSON form; their challenge stays in the session."""
    options: dict[str, Any] = auth.begin_registration(user, True)["publicKey"]
    return options


def request_options(user: User | None) -> dict[str, Any]:
    """Return the options of `navigator.credentials.get` in its JSON form: of the user's passkeys, without a user of any of this host."""
    options: dict[str, Any] = auth.begin_authentication(user)["publicKey"]
    return options


def add_passkey(*, request: HttpRequest, user: User, name: str, credential: Any) -> Authenticator:
    """Store the passkey of an authenticator's response. Raises PasskeyRefused, TooManyPasskeys."""
    text = json.dumps(credential)
    if len(text) > MAX_RESPONSE_LENGTH:
        raise PasskeyRefused
    form = AddWebAuthnForm({"name": name, "credential": text, "passwordless": True}, user=user)
    _check(form)
    if isinstance(_public_key_of(form.cleaned_data["credential"]), UnsupportedKey):
        raise PasskeyRefused  # of an algorithm that was not offered: it could sign nothing that is checked here
    with transaction.atomic():
        User.objects.select_for_update().get(pk=user.pk)
        if passkeys_of(user).count() >= MAX_PASSKEYS:
            raise TooManyPasskeys
        added: Authenticator = flows.add_authenticator(request, form.cleaned_data["name"], form.cleaned_data["credential"])[0]
        record_account_event(user, user, "passkey added")
    return added


def remove_passkey(*, passkey: Authenticator, user: User) -> None:
    with transaction.atomic():
        passkey.delete()
        record_account_event(user, user, "passkey removed")


def passkey_of_response(credential: str) -> Authenticator:
    """Return the passkey that signed the challenge of this session, to sign in with it alone. Raises PasskeyRefused."""
    return _check(LoginWebAuthnForm({"credential": credential}))


def confirm_with_passkey(*, user: User, credential: str) -> None:
    """Accept the response of one of the user's passkeys as second factor or as reauthentication. Raises PasskeyRefused."""
    form = AuthenticateWebAuthnForm({"credential": credential}, user=user)
    _check(form)
    form.save()


_DAMAGED = (
    ArithmeticError, AssertionError, AttributeError, InvalidSignature, LookupError, RuntimeError, TypeError, UnsupportedAlgorithm,
    ValueError, struct.error,
)  # fmt: skip


def _check(form: Any) -> Any:
    """Return the passkey of a valid form. The library lets several errors of damaged responses pass, and subdomains and other ports."""
    try:
        if form.is_valid() and _origin_of(json.loads(form.data["credential"])) in _own_origins():
            return form.cleaned_data["credential"]
    except _DAMAGED as error:
        raise PasskeyRefused from error
    raise PasskeyRefused


def _public_key_of(credential: Any) -> CoseKey:
    data = auth.parse_registration_response(credential).response.attestation_object.auth_data.credential_data
    return data.public_key


def _origin_of(credential: Any) -> str:
    return CollectedClientData(websafe_decode(credential["response"]["clientDataJSON"])).origin


def _own_origins() -> set[str]:
    """Return the origins from which forms are accepted, too."""
    request = context.request
    return {f"{request.scheme}://{request.get_host()}", *settings.CSRF_TRUSTED_ORIGINS}
