"""Permissions of roles in the API."""

from collections.abc import Collection
from typing import Any

from django.utils.translation import gettext as _
from django.utils.translation import gettext_lazy
from rest_framework.permissions import SAFE_METHODS, BasePermission
from rest_framework.request import Request

from workspace.models import ApiToken, Role, TokenScope, User

PLANNERS = frozenset({Role.OPERATOR, Role.ADMINISTRATOR})
CURATORS = frozenset({Role.CURATOR, Role.ADMINISTRATOR})
ADMINISTRATORS = frozenset({Role.ADMINISTRATOR})
EVERYBODY = frozenset(Role)
READING = frozenset({TokenScope.READ})
FLYING = frozenset({TokenScope.FLY})
CURATING = frozenset({TokenScope.CURATE})
ADMINISTERING = frozenset({TokenScope.ADMINISTER})
SEVERAL = {
    Role.VIEWER: gettext_lazy("Viewers"),
    Role.OPERATOR: gettext_lazy("Operators"),
    Role.CURATOR: gettext_lazy("Curators"),
    Role.ADMINISTRATOR: gettext_lazy("Administrators"),
}
ONE = {
    Role.VIEWER: gettext_lazy("viewer"),
    Role.OPERATOR: gettext_lazy("operator"),
    Role.CURATOR: gettext_lazy("curator"),
    Role.ADMINISTRATOR: gettext_lazy("administrator"),
}


class RolePermission(BasePermission):
    """Every authenticated user may read; a view's `write_roles` may write (default: operators).

    A token needs one of the scopes in `write_scopes` to write, by default those that belong to these roles.
    """

    def has_permission(self, request: Request, view: Any) -> bool:
        user = request.user
        if not user.is_authenticated:
            return False
        write_roles = getattr(view, "write_roles", PLANNERS)
        if request.method in SAFE_METHODS:
            return self.token_reaches(request, READING)
        if user.role in write_roles:
            return self.token_reaches(request, getattr(view, "write_scopes", None) or _scopes_for(write_roles))
        wanted: list[Role] = [role for role in Role if role in write_roles and role != Role.ADMINISTRATOR] or [Role.ADMINISTRATOR]
        self.message = _("{people} cannot do this. Ask an administrator for the {wanted} role.").format(
            people=SEVERAL[Role(user.role)], wanted=_(" or ").join(str(ONE[role]) for role in wanted)
        )
        return False

    def token_reaches(self, request: Request, scopes: Collection[str]) -> bool:
        """Whether the request has a session, or a token with one of these scopes."""
        token = request.auth
        if not isinstance(token, ApiToken) or token.scopes is None or not set(scopes).isdisjoint(token.scopes):
            return True
        self.message = _("This needs a token with the scope {scopes}.").format(scopes=_(" or ").join(sorted(scopes)))
        return False


def _scopes_for(roles: Collection[Role]) -> Collection[str]:
    """Return the scopes that a token needs where these roles may write; a request that viewers may make changes nothing."""
    if Role.VIEWER in roles:
        return READING
    found = {scope for role, scope in ((Role.OPERATOR, TokenScope.PLAN), (Role.CURATOR, TokenScope.CURATE)) if role in roles}
    return found or ADMINISTERING


class AdministratorsAlone(RolePermission):
    """Permission for administrators only, to read as well as to write: users, and the sign-in log."""

    def has_permission(self, request: Request, view: Any) -> bool:
        self.message = _("Only administrators see and change who works here.")
        if not (request.user.is_authenticated and request.user.role in ADMINISTRATORS):
            return False
        return self.token_reaches(request, ADMINISTERING)


class InTheBrowserAlone(RolePermission):
    """Refuses tokens for what could outlive a lost one: making tokens, changing a password, ending sessions."""

    def has_permission(self, request: Request, view: Any) -> bool:
        if request.auth is not None and request.method not in SAFE_METHODS:
            self.message = _("A token cannot do this. Sign in with a browser.")
            return False
        return super().has_permission(request, view)


class AdministratorsInTheBrowser(InTheBrowserAlone, AdministratorsAlone):
    """Administrators: tokens may read, but not change roles, as that could make an account that outlives a lost token."""


def may_change(actor: User, user: User) -> bool:
    """Whether the actor may change this account: only operators and the owner may change that of an installation operator."""
    return actor.operates_installation or actor.pk == user.pk or not user.operates_installation
