"""Who is asking: bearer tokens for programs, and what a role may do in the admin."""

from typing import Any, NamedTuple

from django.conf import settings
from django.contrib.auth.backends import ModelBackend
from django.db import DEFAULT_DB_ALIAS
from django.db.models import Model
from django.http import HttpRequest
from django.utils.translation import gettext as _
from drf_spectacular.extensions import OpenApiAuthenticationExtension
from drf_spectacular.plumbing import build_bearer_security_scheme_object
from rest_framework.authentication import BaseAuthentication, SessionAuthentication, get_authorization_header
from rest_framework.exceptions import AuthenticationFailed
from rest_framework.request import Request

from workspace.api_tokens import hash_token, note_use
from workspace.models import ApiToken, Organisation, Role, TokenScope, User
from workspace.prepared_statements import prepared_rows

MAX_TOKEN_LENGTH = 200


class BearerTokenAuthentication(BaseAuthentication):
    """`Authorization: Bearer spw_…`. The answer never tells whether a token is unknown, expired or revoked."""

    def authenticate(self, request: Request) -> tuple[User, ApiToken] | None:
        scheme, *rest = get_authorization_header(request).strip().split(b" ", 1)
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


class Holder(NamedTuple):
    """Whom a token or a session belongs to, as far as the plainest requests need to know."""

    key: int
    role: Role
    scopes: list[str] | None = None  # of the token; None: all of the role


def holder_of(authorization: str) -> Holder | None:
    """Who asks with this header, whose use is noted; None where BearerTokenAuthentication has to look itself."""
    scheme, *rest = authorization.encode("latin-1", "replace").strip().split(b" ", 1)
    rows = _rows_of(_HOLDER, b"".join(rest).strip()) if scheme.lower() == b"bearer" else []
    if not rows:
        return None
    token_key, last_used_at, holder, role, scopes = rows[0]
    note_use(token=token_key, last_used_at=last_used_at)
    return Holder(holder, Role(role), scopes)


def holder_of_session(request: HttpRequest) -> Holder | None:
    """Who has signed in and asks with the CSRF token of their page; None, or an APIException, where SessionAuthentication has to look."""
    if not isinstance(request.user, User) or not request.user.is_active:
        return None
    SessionAuthentication().enforce_csrf(request)  # type: ignore[arg-type] # it hands any request to Django's own check
    return Holder(request.user.pk, Role(request.user.role))


def _valid_token(token: bytes) -> ApiToken | None:
    rows = _rows_of(_VALID_TOKEN, token)
    return _token_of(rows[0]) if rows else None


def _rows_of(statement: str, token: bytes) -> list[tuple[Any, ...]]:
    if not token.isascii() or len(token) > MAX_TOKEN_LENGTH:
        return []
    return prepared_rows(statement, [hash_token(token.decode("ascii"))])


def _columns(model: type[Model], table: str) -> str:
    return ", ".join(f'{table}."{field.column}"' for field in model._meta.concrete_fields)


def _token_of(row: tuple[Any, ...]) -> ApiToken:
    """The token with its user and organisation, from the columns of all three."""
    found: list[Any] = []
    for model in (ApiToken, User, Organisation):
        names = [field.attname for field in model._meta.concrete_fields]
        found.append(model.from_db(DEFAULT_DB_ALIAS, names, row[: len(names)]))
        row = row[len(names) :]
    token, token.user, token.user.organisation = found[0], found[1], found[2]
    return token


# Each request of a program begins with one of these: they are prepared once per connection, and say with the same words what is valid.
_HELD = "workspace_apitoken AS token JOIN workspace_user AS holder ON holder.id = token.user_id"
_VALID = "token.token_sha256 = %s AND token.revoked_at IS NULL AND token.expires_at > statement_timestamp() AND holder.is_active"
_VALID_TOKEN = f"""
    SELECT {_columns(ApiToken, "token")}, {_columns(User, "holder")}, {_columns(Organisation, "organisation")}
    FROM {_HELD} JOIN workspace_organisation AS organisation ON organisation.id = holder.organisation_id WHERE {_VALID}"""  # noqa: S608
_HOLDER = f"SELECT token.id, token.last_used_at, holder.id, holder.role, token.scopes FROM {_HELD} WHERE {_VALID}"  # noqa: S608


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

    def has_perm(self, user_obj: Any, perm: str, obj: Any = None) -> bool:
        return self.has_module_perms(user_obj, perm.partition(".")[0])

    def has_module_perms(self, user_obj: Any, app_label: str) -> bool:
        if not user_obj.is_active or user_obj.is_anonymous:
            return False
        return user_obj.role == Role.ADMINISTRATOR or (user_obj.role == Role.CURATOR and app_label in settings.CURATED_APPS)
