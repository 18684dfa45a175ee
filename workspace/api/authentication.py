"""Authentication: bearer tokens for programs, and permissions of roles in the admin."""

from typing import Any

from django.conf import settings
from django.contrib.auth.backends import ModelBackend
from django.db import DEFAULT_DB_ALIAS
from django.db.models import Model
from django.utils.translation import gettext as _
from drf_spectacular.extensions import OpenApiAuthenticationExtension
from drf_spectacular.plumbing import build_bearer_security_scheme_object
from rest_framework.authentication import BaseAuthentication
from rest_framework.exceptions import AuthenticationFailed
from rest_framework.request import Request

from workspace.api_tokens import hash_token, note_use
from workspace.models import ApiToken, Organisation, Role, TokenScope, User
from workspace.prepared_statements import prepared_rows

MAX_TOKEN_LENGTH = 200


class BearerTokenAuthentication(BaseAuthentication):
    """`Authorization: Bearer spw_…`. The response does not reveal whether a token is unknown, expired or revoked."""

    def authenticate(self, request: Request) -> tuple[User, ApiToken] | None:
        scheme, *rest = request.META.get("HTTP_AUTHORIZATION", "").encode("latin-1", "replace").strip().split(b" ", 1)
        if scheme.lower() != b"bearer":
            return None
        found = _valid_token(b"".join(rest).strip())
        if found is None:
            raise AuthenticationFailed(_("The token is not valid."))
        note_use(token=found.pk, last_used_at=found.last_used_at)
        return found.user, found

    def authenticate_header(self, request: Request) -> str:
        return "Bearer"


def bearer_token(scope: dict[str, Any]) -> bytes | None:
    """Return the token of a websocket's `Authorization: Bearer` header; None without one, in which case its session identifies the user."""
    authorization: bytes = dict(scope["headers"]).get(b"authorization", b"")
    return authorization[7:].strip() if authorization[:7].lower() == b"bearer " else None


def reader_of_token(token: bytes) -> User | None:
    """Return the token's user, if the token is valid and may read."""
    found = _valid_token(token)
    may_read = found is not None and (found.scopes is None or TokenScope.READ in found.scopes)
    return found.user if found is not None and may_read else None


def _valid_token(token: bytes) -> ApiToken | None:
    if not token.isascii() or len(token) > MAX_TOKEN_LENGTH:
        return None
    rows = prepared_rows(_VALID_TOKEN, [hash_token(token.decode("ascii"))])
    return _token_of(rows[0]) if rows else None


# The columns that nearly every request of a program reads; others are fetched on access.
_LOADED: dict[type[Model], tuple[str, ...]] = {
    ApiToken: ("id", "user_id", "scopes", "last_used_at"),
    User: ("id", "username", "is_active", "organisation_id", "role", "is_installation_operator", "is_service", "language"),
    Organisation: ("id", "name"),
}


def _columns(model: type[Model], table: str) -> str:
    return ", ".join(f'{table}."{name}"' for name in _LOADED[model])


def _token_of(row: tuple[Any, ...]) -> ApiToken:
    """Return the token with its user and organisation, from the columns of all three."""
    found: list[Any] = []
    for model, names in _LOADED.items():
        found.append(model.from_db(DEFAULT_DB_ALIAS, names, row[: len(names)]))
        row = row[len(names) :]
    token, token.user, token.user.organisation = found
    return token


# Every request of a program starts with this statement, so it is prepared once per connection.
_VALID_TOKEN = f"""
    SELECT {_columns(ApiToken, "token")}, {_columns(User, "holder")}, {_columns(Organisation, "organisation")}
    FROM workspace_apitoken AS token
    JOIN workspace_user AS holder ON holder.id = token.user_id
    JOIN workspace_organisation AS organisation ON organisation.id = holder.organisation_id
    WHERE token.token_sha256 = %s AND token.revoked_at IS NULL AND token.expires_at > statement_timestamp()
    AND holder.is_active"""  # noqa: S608


class BearerTokenScheme(OpenApiAuthenticationExtension):
    """Describes the bearer token in the OpenAPI document."""

    target_class = BearerTokenAuthentication
    name = "bearerToken"

    def get_security_definition(self, auto_schema: Any) -> dict[str, Any]:
        return build_bearer_security_scheme_object(header_name="Authorization", token_prefix="Bearer")  # noqa: S106 - the scheme's name


class RoleBackend(ModelBackend):
    """Authenticates by name and password; permissions in the admin follow from the role alone."""

    def user_can_authenticate(self, user: Any) -> bool:
        """Whether this account may log in and keep a session. Service accounts may not."""
        return not user.is_service and super().user_can_authenticate(user)

    def get_user(self, user_id: int) -> User | None:
        """Return the session's user with the organisation, which nearly every response needs."""
        user = User.objects.select_related("organisation").filter(pk=user_id).first()
        return user if user is not None and self.user_can_authenticate(user) else None

    def has_perm(self, user_obj: Any, perm: str, obj: Any = None) -> bool:
        return self.has_module_perms(user_obj, perm.partition(".")[0])

    def has_module_perms(self, user_obj: Any, app_label: str) -> bool:
        if not user_obj.is_active or user_obj.is_anonymous:
            return False
        return user_obj.role == Role.ADMINISTRATOR or (user_obj.role == Role.CURATOR and app_label in settings.CURATED_APPS)
