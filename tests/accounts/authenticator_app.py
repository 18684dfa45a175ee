"""An authenticator app, and people who have one."""

import re
from html import unescape

from django.test import Client
from django.utils import timezone

from accounts.second_factors import STEP_S, code_of, set_up
from workspace.field_encryption import decrypt
from workspace.models import SecondFactor, User

SEED = b"0123456789abcdefghij"


def code_now(seed: bytes = SEED, *, steps: int = 0) -> str:
    return code_of(seed, int(timezone.now().timestamp() // STEP_S) + steps)


def with_app(user: User) -> list[str]:
    """Gives somebody a second factor, as if set up long ago; its recovery codes."""
    codes = set_up(user=user, seed=SEED, code=code_now())
    SecondFactor.objects.filter(user=user).update(last_step=-1)
    return codes


def seed_of(user: User) -> bytes:
    return decrypt(user.second_factor.sealed_seed, of=f"second factor of {user.pk}")


def shown_seed(page: str) -> str:
    """What the page says for typing it into an app."""
    found = re.search(r'<p class="seed">(.*?)</p>', page, flags=re.DOTALL)
    assert found is not None
    return "".join(re.findall(r"<span>(\w+)</span>", found[1]))


def shown_recovery_codes(page: str) -> list[str]:
    return [unescape(code) for code in re.findall(r"<li>([\w-]+)</li>", page)]


def type_password(client: Client, user: User, password: str) -> str:
    """Where the door leads to then."""
    return str(client.post("/sign-in", {"login": user.username, "password": password}).headers.get("Location", ""))


def is_in(client: Client) -> bool:
    return bool(client.get("/api/v1/account").status_code == 200)
