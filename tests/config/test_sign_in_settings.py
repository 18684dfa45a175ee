"""Settings of single sign-on: what they mean, and that wrong ones stop the start."""

from pathlib import Path

import pytest

from accounts.identity_claims import IdentityProvider
from config.sign_in_settings import WrongSignInSettings, identity_provider, local_sign_in

RIGHT = {
    "ISSUER": "https://id.example/realms/grid",
    "CLIENT_ID": "spanwise",
    "CLIENT_SECRET": "a secret",
    "DEFAULT_ROLE": "viewer",
}


def having(monkeypatch: pytest.MonkeyPatch, **values: str) -> None:
    for name, value in values.items():
        monkeypatch.setenv(f"SPANWISE_OIDC_{name}", value)


def test_without_an_issuer_there_is_no_single_sign_on() -> None:
    assert identity_provider() is None
    assert local_sign_in(None)


def test_all_settings_are_read(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    (tmp_path / "secret").write_text("from a file\n")
    having(
        monkeypatch, **RIGHT | {"CLIENT_SECRET": ""}, CLIENT_SECRET_FILE=str(tmp_path / "secret"), NAME="Grid ID", SCOPES="openid groups",
        ROLE_CLAIM="realm_access.roles", ROLES="CN=admins=administrator, pilots=operator",
        ORGANISATION_CLAIM="tenant", ORGANISATIONS="n=Grid North",
    )  # fmt: skip
    found = identity_provider()
    assert found == IdentityProvider(
        issuer="https://id.example/realms/grid", client_id="spanwise", client_secret="from a file", name="Grid ID",
        scopes=("openid", "groups"), role_claim="realm_access.roles", roles={"CN=admins": "administrator", "pilots": "operator"},
        organisation_claim="tenant", organisations={"n": "Grid North"}, default_role="viewer",
    )  # fmt: skip
    assert "from a file" not in repr(found)


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"ISSUER": "http://id.example"}, "begins with https://"),
        ({"ISSUER": "id.example"}, "begins with https://"),
        ({"ISSUER": "https://id.example/?realm=grid"}, "no query"),
        ({"ISSUER": "https://id.example/" + "x" * 200}, "200 characters"),
        ({"CLIENT_ID": ""}, "SPANWISE_OIDC_CLIENT_ID"),
        ({"CLIENT_SECRET": ""}, "SPANWISE_OIDC_CLIENT_SECRET"),
        ({"ISSUER": ""}, "not SPANWISE_OIDC_ISSUER"),
        ({"DEFAULT_ROLE": ""}, "nobody would have a role"),
        ({"DEFAULT_ROLE": "pilot"}, "no role 'pilot'"),
        ({"DEFAULT_ROLE": "administrator"}, "make everybody one"),
        ({"ROLE_CLAIM": "groups"}, "both or not at all"),
        ({"ROLES": "pilots=operator"}, "both or not at all"),
        ({"ROLE_CLAIM": "groups", "ROLES": "pilots"}, "value=meaning"),
        ({"ROLE_CLAIM": "groups", "ROLES": "=operator"}, "value=meaning"),
        ({"ROLE_CLAIM": "groups", "ROLES": "a=operator,a=viewer"}, "each value once"),
        ({"ROLE_CLAIM": "groups", "ROLES": "pilots=flyer"}, "no role 'flyer'"),
        ({"ORGANISATIONS": "n=North"}, "both or not at all"),
        ({"SCOPES": "profile"}, "lacks openid"),
    ],
)
def test_wrong_settings_stop_the_start_and_name_the_variable(monkeypatch: pytest.MonkeyPatch, values: dict[str, str], words: str) -> None:
    having(monkeypatch, **RIGHT | values)
    with pytest.raises(WrongSignInSettings, match=words) as raised:
        identity_provider()
    assert "SPANWISE_OIDC_" in str(raised.value)
    assert "a secret" not in str(raised.value)


def test_local_sign_in_is_not_switched_off_where_nothing_else_signs_in(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SPANWISE_LOCAL_SIGN_IN", "0")
    with pytest.raises(WrongSignInSettings, match="nobody could sign in"):
        local_sign_in(None)
    having(monkeypatch, **RIGHT)
    assert not local_sign_in(identity_provider())
