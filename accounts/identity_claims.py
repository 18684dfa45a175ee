"""The identity provider of single sign-on as it is set, and what its claims about a user mean here."""

import re
import unicodedata
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from typing import Any
from urllib.parse import urlsplit

MAX_USER_NAME_LENGTH = 150
MAX_ISSUER_LENGTH = 200  # of the column that binds a user to an issuer
OWN_MACHINE = {"127.0.0.1", "localhost", "::1"}
ROLES_BY_RANK = ("administrator", "curator", "operator", "viewer")
_NOT_IN_NAMES = re.compile(r"[^\w.+-]+")


@dataclass(frozen=True)
class IdentityProvider:
    """The settings. `roles` and `organisations` map values of a claim; without an organisation claim all users are of the first one."""

    issuer: str
    client_id: str
    client_secret: str = field(repr=False)
    name: str
    scopes: tuple[str, ...] = ("openid", "profile", "email")
    role_claim: str = ""
    roles: Mapping[str, str] = field(default_factory=dict)
    organisation_claim: str = ""
    organisations: Mapping[str, str] = field(default_factory=dict)
    default_role: str = ""


def is_secure(address: str) -> bool:
    """Whether an address begins with https://, or leads to this machine."""
    try:
        parts = urlsplit(address)
        host = parts.hostname
    except ValueError:
        return False
    return bool(host) and (parts.scheme == "https" or (parts.scheme == "http" and host in OWN_MACHINE))


def role_of(claims: Mapping[str, Any], provider: IdentityProvider) -> str:
    """Return the highest role of the claim's values, else the default role; empty without either."""
    found = {provider.roles[value] for value in _values(claims, provider.role_claim) if value in provider.roles}
    return next((role for role in ROLES_BY_RANK if role in found), provider.default_role)


def organisations_of(claims: Mapping[str, Any], provider: IdentityProvider) -> set[str]:
    """Return the names of the organisations that the claim's values stand for."""
    values = _values(claims, provider.organisation_claim)
    return {provider.organisations[value] for value in values if value in provider.organisations}


def merged(id_token: Mapping[str, Any], userinfo: Mapping[str, Any]) -> dict[str, Any]:
    """Return the claims of both, those of the signed ID token first. An address is verified if the source that names it says so."""
    claims = {**userinfo, **id_token}
    verified = [source.get("email") for source in (id_token, userinfo) if str(source.get("email_verified")).lower() == "true"]
    return claims | {"email_verified": isinstance(claims.get("email"), str) and claims["email"] in verified}


def wanted_user_name(claims: Mapping[str, Any]) -> str:
    """Return `preferred_username`, else the address, as a user name without the part from its @ on.

    A name that looks like an address could be taken for the verified address of another user.
    """
    names = (_bare_name(claims.get(name)) for name in ("preferred_username", "email"))
    return next(filter(None, names), "user")


def free_user_name(wanted: str, taken: Collection[str]) -> str:
    """Return the name, with a number where it is taken. `taken` holds names in lower case."""
    candidate, number = wanted, 1
    while candidate.lower() in taken:
        number += 1
        candidate = f"{wanted[: MAX_USER_NAME_LENGTH - 8]}-{number}"
    return candidate


def _bare_name(claim: Any) -> str:
    local = unicodedata.normalize("NFKC", claim).partition("@")[0] if isinstance(claim, str) else ""
    return _NOT_IN_NAMES.sub("-", local).strip("-.")[:MAX_USER_NAME_LENGTH]


def _values(claims: Mapping[str, Any], path: str) -> set[str]:
    """Return the texts of a claim, which is a text or a list of texts. Its name is tried as a whole, then as a path with dots."""
    if not path:
        return set()
    found: Any = claims.get(path)
    if found is None:
        found = claims
        for step in path.split("."):
            found = found.get(step) if isinstance(found, Mapping) else None
    entries = found if isinstance(found, list) else [found]
    return {entry for entry in entries if isinstance(entry, str)}
