"""Somebody of a role, and clients that are signed in as them."""

from itertools import count

from django.test import Client

from workspace.models import DEFAULT_ORGANISATION_ID, Organisation, Role, User

_numbers = count(1)


def a_user(role: Role = Role.OPERATOR, organisation: Organisation | None = None) -> User:
    organisation_id = organisation.pk if organisation else DEFAULT_ORGANISATION_ID
    return User.objects.create_user(f"{role.value}-{next(_numbers)}", role=role, organisation_id=organisation_id)


def client_of(user: User) -> Client:
    """Signed in by session; a fault inside the program is answered as it would be, not raised."""
    client = Client(raise_request_exception=False)
    client.force_login(user)
    return client
