"""Authentication on the UAV link: by a UAV's token, never by a user."""

from dataclasses import dataclass
from typing import Any

from django.contrib.auth.models import AnonymousUser
from drf_spectacular.extensions import OpenApiAuthenticationExtension
from drf_spectacular.plumbing import build_bearer_security_scheme_object
from rest_framework.authentication import BaseAuthentication, get_authorization_header
from rest_framework.exceptions import AuthenticationFailed, NotAuthenticated
from rest_framework.permissions import BasePermission
from rest_framework.request import Request

from missions.models import CredentialKind, UavState
from missions.services.fleet.credentials import note_link_token_use
from workspace.api.authentication import MAX_TOKEN_LENGTH
from workspace.api.errors import ApiProblem
from workspace.api.throttling import ScopedRate
from workspace.api_tokens import hash_token
from workspace.prepared_statements import prepared_rows
from workspace.sessions.sign_in_attempts import TooManyAttempts, address_of, count_attempt, network_of

WRONG_TOKENS = 30  # per network in 15 minutes; a valid token is never throttled
GUESSING = "guessing tokens of UAVs"


@dataclass(frozen=True)
class UavAccess:
    """The authenticated UAV, and its last position: longitude, latitude."""

    uav_id: int
    organisation_id: int
    place: tuple[float, float]


class UavTokenAuthentication(BaseAuthentication):
    """`Authorization: Bearer spu_…`. The response does not reveal whether a token is unknown or revoked, or its UAV retired."""

    def authenticate(self, request: Request) -> tuple[AnonymousUser, UavAccess] | None:
        scheme, *rest = get_authorization_header(request).strip().split(b" ", 1)
        if scheme.lower() != b"bearer":
            return None
        access = _access_of(b"".join(rest).strip())
        if access is None:
            self._count_a_guess(request)
            raise AuthenticationFailed("The token is not valid.")
        return AnonymousUser(), access

    def authenticate_header(self, request: Request) -> str:
        return "Bearer"

    @staticmethod
    def _count_a_guess(request: Request) -> None:
        try:
            count_attempt(GUESSING, network_of(address_of(request)), most=WRONG_TOKENS)
        except TooManyAttempts as error:
            raise ApiProblem(429, "throttled", "Too many wrong tokens from this network.", retry_after_s=error.wait_s) from error


class UavsAlone(BasePermission):
    """Permits UAVs only."""

    def has_permission(self, request: Request, view: Any) -> bool:
        return isinstance(request.auth, UavAccess)


def uav_access(request: Request) -> UavAccess:
    """Return the authenticated UAV, in a view for UAVs only. Raises NotAuthenticated without one."""
    if not isinstance(request.auth, UavAccess):
        raise NotAuthenticated
    return request.auth


class UavRate(ScopedRate):
    """Throttles requests per UAV."""

    def get_cache_key(self, request: Request, view: Any) -> str:
        return str(self.cache_format % {"scope": self.scope, "ident": f"uav:{uav_access(request).uav_id}"})


_ACCESS = f"""
    SELECT credential.id, credential.last_used_at, uav.id, uav.organisation_id, ST_X(uav.location), ST_Y(uav.location)
    FROM missions_uavcredential AS credential JOIN missions_uav AS uav ON uav.id = credential.uav_id
    WHERE credential.token_sha256 = %s AND credential.kind = '{CredentialKind.LINK_TOKEN.value}' AND credential.revoked_at IS NULL
        AND uav.state <> '{UavState.RETIRED.value}'"""  # noqa: S608 - constants


def _access_of(token: bytes) -> UavAccess | None:
    if not token.isascii() or len(token) > MAX_TOKEN_LENGTH:
        return None
    rows = prepared_rows(_ACCESS, [hash_token(token.decode("ascii"))])
    if not rows:
        return None
    credential_id, last_used_at, uav_id, organisation_id, longitude, latitude = rows[0]
    note_link_token_use(credential_id=credential_id, last_used_at=last_used_at)
    return UavAccess(uav_id, organisation_id, (longitude, latitude))


class UavTokenScheme(OpenApiAuthenticationExtension):
    """OpenAPI description of the UAV's token."""

    target_class = UavTokenAuthentication
    name = "uavToken"

    def get_security_definition(self, auto_schema: Any) -> dict[str, Any]:
        return build_bearer_security_scheme_object(header_name="Authorization", token_prefix="Bearer")  # noqa: S106 - the scheme's name
