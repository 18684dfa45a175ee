"""Types of requests whose user is authenticated."""

from django.core.exceptions import PermissionDenied
from django.http import HttpRequest
from rest_framework.request import Request

from workspace.models import User


class SignedInRequest(Request):
    """A request to the API whose view refuses anonymous users. For type checks only; never instantiated."""

    user: User


class SignedInPageRequest(HttpRequest):
    """A request of a page behind `LoginRequiredMixin`. For type checks only; never instantiated."""

    user: User


def user_of(request: HttpRequest) -> User:
    """Return the authenticated user where the request's type cannot express it: in the admin.

    Raises PermissionDenied for an anonymous user.
    """
    if not isinstance(request.user, User):
        raise PermissionDenied
    return request.user
