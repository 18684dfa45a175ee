"""Settings of django-allauth, which signs users in: accounts/adapters.py says what differs from its defaults."""

import os
from typing import Any

from accounts.identity_claims import MAX_ISSUER_LENGTH, ROLES_BY_RANK, IdentityProvider, is_secure
from config.environment import entries, flag, secret

MFA_PENDING_S = 10 * 60  # for the second factor, after the password
APPS = ["allauth", "allauth.account", "allauth.mfa", "allauth.socialaccount"]
MIDDLEWARE = "allauth.account.middleware.AccountMiddleware"


class WrongSignInSettings(ValueError):
    """Raised for settings of single sign-on that contradict each other. The message names the variable, never a secret."""


def identity_provider() -> IdentityProvider | None:
    """Return the provider of single sign-on; None without SPANWISE_OIDC_ISSUER. Raises WrongSignInSettings."""
    issuer, client_id = os.environ.get("SPANWISE_OIDC_ISSUER", ""), os.environ.get("SPANWISE_OIDC_CLIENT_ID", "")
    if not issuer:
        if client_id:
            raise WrongSignInSettings("SPANWISE_OIDC_CLIENT_ID is set, but not SPANWISE_OIDC_ISSUER.")
        return None
    if not is_secure(issuer) or any(sign in issuer for sign in "?# ") or len(issuer) > MAX_ISSUER_LENGTH:
        raise WrongSignInSettings("SPANWISE_OIDC_ISSUER begins with https://, has no query, and has at most 200 characters.")
    client_secret = secret("SPANWISE_OIDC_CLIENT_SECRET")
    if not (client_id and client_secret):
        raise WrongSignInSettings("SPANWISE_OIDC_ISSUER needs SPANWISE_OIDC_CLIENT_ID and SPANWISE_OIDC_CLIENT_SECRET.")
    role_claim, roles = _mapping("SPANWISE_OIDC_ROLE_CLAIM", "SPANWISE_OIDC_ROLES")
    organisation_claim, organisations = _mapping("SPANWISE_OIDC_ORGANISATION_CLAIM", "SPANWISE_OIDC_ORGANISATIONS")
    default_role = os.environ.get("SPANWISE_OIDC_DEFAULT_ROLE", "")
    if unknown := sorted({*roles.values(), *filter(None, [default_role])} - {*ROLES_BY_RANK}):
        raise WrongSignInSettings(f"SPANWISE_OIDC_ROLES and SPANWISE_OIDC_DEFAULT_ROLE know no role {unknown[0]!r}.")
    if default_role == "administrator":
        raise WrongSignInSettings("SPANWISE_OIDC_DEFAULT_ROLE=administrator would make everybody one. Map a value of a claim to it.")
    if not (roles or default_role):
        raise WrongSignInSettings("SPANWISE_OIDC_ROLES and SPANWISE_OIDC_DEFAULT_ROLE are empty: nobody would have a role.")
    scopes = tuple(os.environ.get("SPANWISE_OIDC_SCOPES", "openid profile email").split())
    if "openid" not in scopes:
        raise WrongSignInSettings("SPANWISE_OIDC_SCOPES lacks openid.")
    return IdentityProvider(
        issuer=issuer, client_id=client_id, client_secret=client_secret, scopes=scopes, default_role=default_role,
        name=os.environ.get("SPANWISE_OIDC_NAME") or "OpenID Connect",
        role_claim=role_claim, roles=roles, organisation_claim=organisation_claim, organisations=organisations,
    )  # fmt: skip


def local_sign_in(provider: IdentityProvider | None) -> bool:
    """Whether passwords and passkeys of Spanwise sign in. Raises WrongSignInSettings where nothing else would."""
    is_on = flag("SPANWISE_LOCAL_SIGN_IN", default=True)
    if provider is None and not is_on:
        raise WrongSignInSettings("SPANWISE_LOCAL_SIGN_IN=0 without SPANWISE_OIDC_ISSUER: nobody could sign in.")
    return is_on


def _mapping(claim_name: str, mapping_name: str) -> tuple[str, dict[str, str]]:
    """Return a claim and what its values stand for: `value=meaning`, commas between. Raises WrongSignInSettings."""
    claim, pairs = os.environ.get(claim_name, ""), entries(mapping_name, "")
    if bool(claim) != bool(pairs):
        raise WrongSignInSettings(f"{claim_name} and {mapping_name} are set both or not at all.")
    found = {value.strip(): meaning.strip() for value, _sign, meaning in (pair.rpartition("=") for pair in pairs)}
    if not all(value and meaning for value, meaning in found.items()) or len(found) != len(pairs):
        raise WrongSignInSettings(f"{mapping_name} is a list of value=meaning, commas between, each value once.")
    return claim, found


def sign_in_settings() -> dict[str, Any]:
    """Return the settings of allauth's apps. Limits on guessing are ours: its limits lock accounts, and count in the cache only."""
    return {
        "LOGIN_URL": "account_login",
        "LOGIN_REDIRECT_URL": "missions",
        "LOGOUT_REDIRECT_URL": "account_login",
        "ACCOUNT_ADAPTER": "accounts.adapters.AccountAdapter",
        "ACCOUNT_LOGIN_METHODS": {"username"},  # accounts/email_addresses.py finds the name of an e-mail address
        "ACCOUNT_SIGNUP_FIELDS": ["username*", "email", "password1*", "password2*"],
        "ACCOUNT_FORMS": {"login": "accounts.pages.sign_in.SignInForm"},
        "ACCOUNT_EMAIL_VERIFICATION": "none",  # not asked for at sign-in
        "ACCOUNT_LOGIN_TIMEOUT": MFA_PENDING_S,
        "ACCOUNT_PRESERVE_USERNAME_CASING": True,
        "ACCOUNT_RATE_LIMITS": False,
        "ACCOUNT_SESSION_REMEMBER": True,
        "MFA_ADAPTER": "accounts.adapters.MFAAdapter",
        "MFA_SUPPORTED_TYPES": ["webauthn"],  # codes are checked by accounts/second_factors.py
        "MFA_PASSKEY_LOGIN_ENABLED": True,
        "MFA_RATE_LIMITS": False,
        "MFA_WEBAUTHN_USER_VERIFICATION": "required",
    }
