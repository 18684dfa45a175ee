"""Requests whose user has signed in: what a view that anonymous users cannot reach knows of its request."""

from django.core.exceptions import PermissionDenied
from django.http import HttpRequest
from rest_framework.request import Request

from workspace.models import User


class SignedInRequest(Request):
    """A request to the API whose view refuses anonymous users. A name for type checks: no object is made of it."""

    user: User


class SignedInPageRequest(HttpRequest):
    """A request of a page behind `LoginRequiredMixin`. A name for type checks: no object is made of it."""

    user: User


def user_of(request: HttpRequest) -> User:
    """Return the user who has signed in, where the type of the request cannot say so: in the admin.

    Raises PermissionDenied if nobody has signed in.
    """
    if not isinstance(request.user, User):
        raise PermissionDenied
    return request.user
