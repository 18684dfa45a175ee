"""What a role may do in the API."""

from typing import Any

from rest_framework.permissions import SAFE_METHODS, BasePermission
from rest_framework.request import Request

from workspace.models import Role

PLANNERS = frozenset({Role.OPERATOR, Role.ADMINISTRATOR})
CURATORS = frozenset({Role.CURATOR, Role.ADMINISTRATOR})
ADMINISTRATORS = frozenset({Role.ADMINISTRATOR})


class RolePermission(BasePermission):
    """Whoever is signed in may read; a view says with `write_roles` who may change things (operators if it says nothing)."""

    def has_permission(self, request: Request, view: Any) -> bool:
        user = request.user
        if not user.is_authenticated:
            return False
        write_roles = getattr(view, "write_roles", PLANNERS)
        if request.method in SAFE_METHODS or user.role in write_roles:
            return True
        wanted = " or ".join(role.label.lower() for role in Role if role in write_roles and role != Role.ADMINISTRATOR)
        self.message = f"{Role(user.role).label}s cannot do this. Ask an administrator for the {wanted or 'administrator'} role."
        return False
