"""Settings of django-allauth, which signs users in: accounts/adapters.py says what differs from its defaults."""

from typing import Any

MFA_PENDING_S = 10 * 60  # for the second factor, after the password
APPS = ["allauth", "allauth.account", "allauth.mfa", "allauth.socialaccount"]
MIDDLEWARE = "allauth.account.middleware.AccountMiddleware"


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
