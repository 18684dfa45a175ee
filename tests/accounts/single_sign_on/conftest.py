"""An OpenID provider beside the tests of single sign-on."""

from collections.abc import Iterator
from typing import Any

import pytest
from django.core.cache import cache

from accounts.identity_claims import IdentityProvider
from accounts.identity_provider import documents
from tests.accounts.single_sign_on.openid_provider import CLIENT_ID, CLIENT_SECRET, OpenIdProvider, openid_provider


@pytest.fixture(scope="session")
def running() -> Iterator[OpenIdProvider]:
    with openid_provider() as running:
        yield running


@pytest.fixture
def provider(running: OpenIdProvider, settings: Any) -> OpenIdProvider:
    """The provider with its usual answers, and Spanwise that uses it."""
    running.claims, running.userinfo, running.sign = {"sub": "anna", "groups": ["pilots"]}, {}, None
    running.methods = ["client_secret_post"]
    running.answers, running.asked, running.codes = {}, [], {}
    settings.IDENTITY_PROVIDER = IdentityProvider(
        issuer=running.issuer, client_id=CLIENT_ID, client_secret=CLIENT_SECRET, name="Grid ID",
        role_claim="groups", roles={"admins": "administrator", "curators": "curator", "pilots": "operator"},
    )  # fmt: skip
    cache.clear()
    documents.clear()
    return running
