"""The second factor: codes of an app after the password, recovery codes, and who may ask for it or take it away."""

from base64 import b32decode
from datetime import timedelta
from io import StringIO
from time import time
from typing import Any

import pytest
from allauth.account.internal.stagekit import LOGIN_SESSION_KEY
from django.core.cache import cache
from django.core.management import CommandError, call_command
from django.test import Client, override_settings
from django.utils import timezone

from accounts.second_factors import (
    TRIES,
    TooManyCodes,
    WrongCode,
    bare,
    code_of,
    encrypt_with_current_key,
    matching_step,
    new_recovery_codes,
    try_code,
)
from config.sign_in_settings import MFA_PENDING_S
from tests.accounts.authenticator_app import (
    SEED,
    code_now,
    is_in,
    seed_of,
    shown_recovery_codes,
    shown_seed,
    type_password,
    with_app,
)
from tests.accounts.users import a_user, client_of
from workspace.api_tokens import create_api_token
from workspace.models import AuditEntry, Organisation, RecoveryCode, Role, SecondFactor, SignInEntry, SignInOutcome, User

pytestmark = pytest.mark.django_db
PASSWORD = "inspect-the-lines"
RFC_6238_SEED = b"12345678901234567890"


@pytest.fixture(autouse=True)
def _no_tries_yet(settings: Any) -> None:
    cache.clear()
    settings.PASSWORD_HASHERS = ["django.contrib.auth.hashers.MD5PasswordHasher"]


@pytest.fixture
def ida() -> User:
    user = a_user()
    user.set_password(PASSWORD)
    user.save()
    return user


def answer_code(client: Client, code: str) -> bool:
    client.post("/sign-in/code", {"code": code})
    return is_in(client)


def history_of(user: User) -> list[str]:
    return list(AuditEntry.objects.filter(subject_type="user", subject_id=str(user.pk)).order_by("pk").values_list("action", flat=True))


@pytest.mark.parametrize(("at_s", "code"), [(59, "287082"), (1111111109, "081804"), (1234567890, "005924"), (20000000000, "353130")])
def test_codes_are_those_of_the_standard(at_s: int, code: str) -> None:
    """RFC 6238, appendix B, SHA-1, the last six digits."""
    assert code_of(RFC_6238_SEED, at_s // 30) == code
    assert matching_step(code, RFC_6238_SEED, at_s=at_s, after=-1) == at_s // 30


def test_a_code_is_taken_one_step_beside_now_and_no_further() -> None:
    code = code_of(SEED, 100)
    taken = [step for step in range(95, 106) if matching_step(code, SEED, at_s=step * 30 + 15, after=-1) is not None]
    assert taken == [99, 100, 101]


def test_without_a_second_factor_the_password_lets_in(ida: User) -> None:
    client = Client()
    assert type_password(client, ida, PASSWORD) == "/"
    assert is_in(client)


def test_with_one_the_password_alone_opens_nothing(ida: User) -> None:
    with_app(ida)
    client = Client()
    assert type_password(client, ida, PASSWORD) == "/sign-in/code"
    assert not is_in(client)
    assert client.get("/account").status_code == 302
    assert not SignInEntry.objects.filter(outcome=SignInOutcome.SIGNED_IN).exists()
    assert answer_code(client, code_now())
    assert SignInEntry.objects.filter(outcome=SignInOutcome.SIGNED_IN, user=ida).count() == 1


def test_after_the_code_one_is_where_one_wanted_to_go(ida: User) -> None:
    with_app(ida)
    client = Client()
    client.post("/sign-in", {"login": ida.username, "password": PASSWORD, "next": "/live"})
    assert client.post("/sign-in/code", {"code": code_now()}).headers["Location"] == "/live"


def test_a_code_is_taken_once(ida: User) -> None:
    with_app(ida)
    code = code_now()
    first, second = Client(), Client()
    for client in (first, second):
        type_password(client, ida, PASSWORD)
    assert answer_code(first, code)
    assert not answer_code(second, code)


def test_the_code_that_set_it_up_lets_nobody_in(ida: User) -> None:
    with_app(ida)
    SecondFactor.objects.update(last_step=int(timezone.now().timestamp() // 30))
    with pytest.raises(WrongCode):
        try_code(user=ida, code=code_now())


def test_without_the_password_the_code_page_leads_to_the_door() -> None:
    assert Client().get("/sign-in/code").headers["Location"] == "/sign-in"


def test_the_password_counts_for_ten_minutes_and_while_it_is_the_password(ida: User) -> None:
    with_app(ida)
    late, changed = Client(), Client()
    for client in (late, changed):
        type_password(client, ida, PASSWORD)
    session = late.session
    session[LOGIN_SESSION_KEY] = session[LOGIN_SESSION_KEY] | {"initiated_at": time() - MFA_PENDING_S - 1}
    session.save()
    assert not answer_code(late, code_now())
    ida.set_password("another-one-altogether")
    ida.save()
    assert not answer_code(changed, code_now())


def test_wrong_codes_are_limited_wherever_they_come_from_and_logged(ida: User) -> None:
    with_app(ida)
    for place in range(TRIES):
        client = Client(REMOTE_ADDR=f"198.51.100.{place}")
        type_password(client, ida, PASSWORD)
        assert not answer_code(client, "000000")
    client = Client()
    type_password(client, ida, PASSWORD)
    assert not answer_code(client, code_now()), "the right one is not looked at, either"
    with pytest.raises(TooManyCodes):
        try_code(user=ida, code=code_now())
    assert SignInEntry.objects.filter(user=ida, outcome=SignInOutcome.WRONG_CODE).count() == TRIES
    SecondFactor.objects.update(wrong_since=timezone.now() - timedelta(minutes=16))
    assert answer_code(client, code_now())


def test_somebody_sets_one_up_with_the_code_of_the_app_and_the_password(ida: User) -> None:
    client = client_of(ida)
    page = client.get("/second-factor").content.decode()
    assert page.count("<svg") > 1, "the QR code is in the page, from nowhere else"
    seed = b32decode(shown_seed(page))
    assert client.post("/second-factor", {"code": code_now(seed), "password": "wrong"}).status_code == 200
    assert client.post("/second-factor", {"code": "000000", "password": PASSWORD}).status_code == 200
    assert not SecondFactor.objects.exists()
    answer = client.post("/second-factor", {"code": code_now(seed), "password": PASSWORD})
    codes = shown_recovery_codes(answer.content.decode())
    assert len(codes) == len(set(codes)) == 8
    assert "no-store" in answer["Cache-Control"]
    assert history_of(ida) == ["second factor set up"]
    assert client.get("/second-factor").headers["Location"] == "/second-factor/codes"


def test_neither_seed_nor_recovery_codes_can_be_read_in_the_database(ida: User) -> None:
    codes = with_app(ida)
    rows = str([*SecondFactor.objects.values(), *RecoveryCode.objects.values()])
    assert seed_of(ida) == SEED
    assert SEED.decode() not in rows
    assert not any(code in rows or bare(code) in rows for code in codes)


def test_a_sealed_seed_of_somebody_else_makes_no_codes(ida: User) -> None:
    with_app(ida)
    other = a_user()
    with_app(other)
    SecondFactor.objects.filter(user=other).update(sealed_seed=ida.second_factor.sealed_seed)
    with pytest.raises(WrongCode):
        try_code(user=other, code=code_now())


def test_a_recovery_code_lets_in_once_however_it_is_typed(ida: User) -> None:
    code = with_app(ida)[0]
    first, second = Client(), Client()
    for client in (first, second):
        type_password(client, ida, PASSWORD)
    assert answer_code(first, code.upper().replace("-", " "))
    assert not answer_code(second, code)
    assert "recovery code used" in history_of(ida)
    assert first.get("/account").content.decode().count("7 recovery codes are left") == 1


def test_wrong_codes_of_a_stranger_do_not_lock_out_whoever_has_a_recovery_code(ida: User) -> None:
    codes = with_app(ida)
    stranger, owner = Client(), Client()
    for client in (stranger, owner):
        type_password(client, ida, PASSWORD)
    for _ in range(TRIES):
        assert not answer_code(stranger, "000000")
    assert not answer_code(owner, code_now())
    assert answer_code(owner, codes[0])
    assert not answer_code(stranger, codes[0])


def test_recovery_codes_are_made_of_118_random_bits() -> None:
    codes = {bare(code) for _ in range(20) for code in new_recovery_codes()}
    assert len(codes) == 160
    assert {len(code) for code in codes} == {24}
    assert len(set("".join(codes))) == 31


def test_new_recovery_codes_take_the_place_of_the_old_ones(ida: User) -> None:
    old = with_app(ida)[0]
    answer = client_of(ida).post("/second-factor/codes", {"code": code_now(), "password": PASSWORD})
    new = shown_recovery_codes(answer.content.decode())[0]
    with pytest.raises(WrongCode):
        try_code(user=ida, code=old)
    try_code(user=ida, code=new)


def test_it_is_removed_with_password_and_code_alone(ida: User) -> None:
    with_app(ida)
    client = client_of(ida)
    client.post("/second-factor/remove", {"code": code_now(), "password": "wrong"})
    client.post("/second-factor/remove", {"code": "000000", "password": PASSWORD})
    assert SecondFactor.objects.exists()
    assert client.post("/second-factor/remove", {"code": code_now(), "password": PASSWORD}).status_code == 302
    assert not SecondFactor.objects.exists()
    assert history_of(ida) == ["second factor set up", "second factor removed"]


def test_whoever_has_none_finds_nothing_to_change(ida: User) -> None:
    for page in ("/second-factor/codes", "/second-factor/remove"):
        assert client_of(ida).get(page).status_code == 404


def test_where_it_is_required_the_door_leads_to_setting_it_up(ida: User) -> None:
    Organisation.objects.update(requires_second_factor=True)
    client = Client()
    assert type_password(client, ida, PASSWORD) == "/second-factor"
    assert not is_in(client)
    seed = b32decode(shown_seed(client.get("/second-factor").content.decode()))
    assert not is_in(client)
    answer = client.post("/second-factor", {"code": code_now(seed)})
    assert len(shown_recovery_codes(answer.content.decode())) == 8
    assert is_in(client)
    assert type_password(Client(), ida, PASSWORD) == "/sign-in/code"


def test_it_is_not_asked_of_programs(ida: User) -> None:
    with_app(ida)
    Organisation.objects.update(requires_second_factor=True)
    token = create_api_token(user=ida, name="script", expires_at=timezone.now() + timedelta(days=1))
    assert Client().get("/api/v1/account", headers={"Authorization": f"Bearer {token}"}).status_code == 200


def test_administrators_who_have_one_ask_everybody_for_it() -> None:
    boss = a_user(Role.ADMINISTRATOR)
    client = client_of(boss)

    def ask(required: bool) -> int:
        return client.put("/api/v1/second-factor-rule", {"required": required}, content_type="application/json").status_code

    assert ask(True) == 409
    with_app(boss)
    assert ask(True) == 200
    assert client_of(a_user()).get("/api/v1/second-factor-rule").json()["required"] is True
    assert ask(False) == 200
    rules = AuditEntry.objects.filter(action="second factor rule").values_list("after", flat=True)
    assert list(rules) == [{"requires_second_factor": False}, {"requires_second_factor": True}]


def test_a_token_does_not_change_the_rule_or_reset_anybody(ida: User) -> None:
    boss = a_user(Role.ADMINISTRATOR)
    with_app(boss)
    with_app(ida)
    token = create_api_token(user=boss, name="script", expires_at=timezone.now() + timedelta(days=1))
    client = Client(headers={"Authorization": f"Bearer {token}"})
    assert client.put("/api/v1/second-factor-rule", {"required": True}, content_type="application/json").status_code == 403
    assert client.delete(f"/api/v1/users/{ida.pk}/second-factor").status_code == 403


def test_an_administrator_resets_it_of_their_own_people_and_not_of_themselves(ida: User) -> None:
    boss, stranger = a_user(Role.ADMINISTRATOR), a_user(organisation=Organisation.objects.create(name="Others"))
    for user in (boss, stranger, ida):
        with_app(user)
    client, hers = client_of(boss), client_of(ida)
    answers = [client.delete(f"/api/v1/users/{user.pk}/second-factor").status_code for user in (ida, stranger, boss)]
    assert answers == [204, 404, 409]
    assert set(SecondFactor.objects.values_list("user", flat=True)) == {boss.pk, stranger.pk}
    assert not is_in(hers), "whoever has the telephone is signed out"
    entry = AuditEntry.objects.filter(action="second factor reset").get()
    assert (entry.actor, entry.subject_id) == (boss, str(ida.pk))


def test_the_last_administrator_is_helped_at_the_machine() -> None:
    boss = a_user(Role.ADMINISTRATOR)
    with_app(boss)
    call_command("reset_second_factor", boss.username, stdout=StringIO())
    assert not SecondFactor.objects.exists()
    assert AuditEntry.objects.get(action="second factor reset").actor is None
    with pytest.raises(CommandError, match="has no second factor"):
        call_command("reset_second_factor", boss.username)


def test_a_new_password_by_mail_does_not_get_round_it(ida: User) -> None:
    with_app(ida)
    ida.set_password("new-one-by-mail")
    ida.save()
    client = Client()
    assert type_password(client, ida, "new-one-by-mail") == "/sign-in/code"
    assert not is_in(client)


def test_seeds_outlive_a_change_of_the_secret_key(ida: User) -> None:
    with override_settings(SECRET_KEY="the-key-of-before", SECRET_KEY_FALLBACKS=[]):
        with_app(ida)
    with override_settings(SECRET_KEY="the-key-of-today", SECRET_KEY_FALLBACKS=["the-key-of-before"]):
        assert encrypt_with_current_key() == 1
    with override_settings(SECRET_KEY="the-key-of-today", SECRET_KEY_FALLBACKS=[]):
        try_code(user=ida, code=code_now())


def test_whoever_runs_the_installation_asks_for_it_of_everybody(ida: User, settings: Any) -> None:
    settings.REQUIRES_SECOND_FACTOR = True
    assert type_password(Client(), ida, PASSWORD) == "/second-factor"
    assert client_of(ida).get("/api/v1/second-factor-rule").json() == {"required": True, "is_of_the_installation": True}


def test_the_login_of_somebody_who_is_deleted_meanwhile_ends(ida: User) -> None:
    with_app(ida)
    client = Client()
    type_password(client, ida, PASSWORD)
    ida.delete()
    assert client.get("/sign-in/code").headers["Location"] == "/sign-in"
