"""A curator and their client."""

import pytest
from django.test import Client

from tests.accounts.users import a_user, client_of
from workspace.models import Role, User


@pytest.fixture
def curator(db: None) -> User:
    return a_user(Role.CURATOR)


@pytest.fixture
def client(curator: User) -> Client:
    return client_of(curator)
