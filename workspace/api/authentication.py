"""Who is asking: bearer tokens for programs, and what a role may do in the admin."""

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
    """`Authorization: Bearer spw_…`. The answer never tells whether a token is unknown, expired or revoked."""

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
    """What a websocket's `Authorization: Bearer` says; None where it sends none: then its session tells whose it is."""
    authorization: bytes = dict(scope["headers"]).get(b"authorization", b"")
    return authorization[7:].strip() if authorization[:7].lower() == b"bearer " else None


def reader_of_token(token: bytes) -> User | None:
    """Whose token it is, if it is valid and may read."""
    found = _valid_token(token)
    may_read = found is not None and (found.scopes is None or TokenScope.READ in found.scopes)
    return found.user if found is not None and may_read else None


def _valid_token(token: bytes) -> ApiToken | None:
    if not token.isascii() or len(token) > MAX_TOKEN_LENGTH:
        return None
    rows = prepared_rows(_VALID_TOKEN, [hash_token(token.decode("ascii"))])
    return _token_of(rows[0]) if rows else None


# What nearly every request of a program asks of these rows; whatever else is asked of them is fetched then.
_LOADED: dict[type[Model], tuple[str, ...]] = {
    ApiToken: ("id", "user_id", "scopes", "last_used_at"),
    User: ("id", "username", "is_active", "organisation_id", "role", "is_installation_operator", "is_service", "language"),
    Organisation: ("id", "name"),
}


def _columns(model: type[Model], table: str) -> str:
    return ", ".join(f'{table}."{name}"' for name in _LOADED[model])


def _token_of(row: tuple[Any, ...]) -> ApiToken:
    """The token with its user and organisation, from the columns of all three."""
    found: list[Any] = []
    for model, names in _LOADED.items():
        found.append(model.from_db(DEFAULT_DB_ALIAS, names, row[: len(names)]))
        row = row[len(names) :]
    token, token.user, token.user.organisation = found
    return token


# Each request of a program begins with this: it is prepared once per connection.
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
    """Signs in by name and password; permissions in the admin follow from the role and from nothing else."""

    def user_can_authenticate(self, user: Any) -> bool:
        """Whether somebody may sign in as this user, and keep a session: nobody as a service account."""
        return not user.is_service and super().user_can_authenticate(user)

    def get_user(self, user_id: int) -> User | None:
        """Whose session it is, with their organisation, which nearly every answer asks for."""
        user = User.objects.select_related("organisation").filter(pk=user_id).first()
        return user if user is not None and self.user_can_authenticate(user) else None

    def has_perm(self, user_obj: Any, perm: str, obj: Any = None) -> bool:
        return self.has_module_perms(user_obj, perm.partition(".")[0])

    def has_module_perms(self, user_obj: Any, app_label: str) -> bool:
        if not user_obj.is_active or user_obj.is_anonymous:
            return False
        return user_obj.role == Role.ADMINISTRATOR or (user_obj.role == Role.CURATOR and app_label in settings.CURATED_APPS)
