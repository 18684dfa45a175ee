"""What a role may do in the API."""

from typing import Any

from django.utils.translation import gettext as _
from django.utils.translation import gettext_lazy
from rest_framework.permissions import SAFE_METHODS, BasePermission
from rest_framework.request import Request

from workspace.models import Role

PLANNERS = frozenset({Role.OPERATOR, Role.ADMINISTRATOR})
CURATORS = frozenset({Role.CURATOR, Role.ADMINISTRATOR})
ADMINISTRATORS = frozenset({Role.ADMINISTRATOR})
EVERYBODY = frozenset(Role)
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
    """Whoever is signed in may read; a view says with `write_roles` who may change things (operators if it says nothing)."""

    def has_permission(self, request: Request, view: Any) -> bool:
        user = request.user
        if not user.is_authenticated:
            return False
        write_roles = getattr(view, "write_roles", PLANNERS)
        if request.method in SAFE_METHODS or user.role in write_roles:
            return True
        wanted: list[Role] = [role for role in Role if role in write_roles and role != Role.ADMINISTRATOR] or [Role.ADMINISTRATOR]
        self.message = _("{people} cannot do this. Ask an administrator for the {wanted} role.").format(
            people=SEVERAL[Role(user.role)], wanted=_(" or ").join(str(ONE[role]) for role in wanted)
        )
        return False


class AdministratorsAlone(RolePermission):
    """Who works here, and who came to the door, is for administrators to see, too."""

    def has_permission(self, request: Request, view: Any) -> bool:
        self.message = _("Only administrators see and change who works here.")
        return bool(request.user.is_authenticated and request.user.role in ADMINISTRATORS)


class InTheBrowserAlone(RolePermission):
    """What could outlive a lost token: no token makes another one, changes a password or ends sessions."""

    def has_permission(self, request: Request, view: Any) -> bool:
        if request.auth is not None and request.method not in SAFE_METHODS:
            self.message = _("A token cannot do this. Sign in with a browser.")
            return False
        return super().has_permission(request, view)


class AdministratorsInTheBrowser(InTheBrowserAlone, AdministratorsAlone):
    """Who gives somebody a role could make an account that outlives a lost token: reading is for tokens, too, giving is not."""
