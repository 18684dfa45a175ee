"""Passwords are kept as Argon2id; older ones let their owner in and are made anew."""

import pytest
from django.contrib.auth import authenticate
from django.contrib.auth.hashers import identify_hasher, make_password
from django.test import RequestFactory

from tests.accounts.users import a_user

pytestmark = pytest.mark.django_db
PASSWORD = "north-abutment-41"


def test_a_new_password_is_argon2id_with_the_stated_cost() -> None:
    hashed = make_password(PASSWORD)
    assert hashed.startswith("argon2$argon2id$v=19$m=47104,t=2,p=1$")
    assert not identify_hasher(hashed).must_update(hashed)


@pytest.mark.long
def test_an_older_password_lets_in_and_is_made_anew() -> None:
    user = a_user()
    user.password = make_password(PASSWORD, hasher="pbkdf2_sha256")
    user.save()
    asked = RequestFactory().post("/sign-in")
    assert authenticate(asked, username=user.username, password="another") is None
    assert authenticate(asked, username=user.username, password=PASSWORD) == user
    user.refresh_from_db()
    assert user.password.startswith("argon2$")
    assert authenticate(asked, username=user.username, password=PASSWORD) == user
