"""Codes of an authenticator app (RFC 6238: SHA-1, 6 digits, 30 s), and codes for whoever has lost the app."""

import secrets
from urllib.parse import quote, urlencode

from cryptography.hazmat.primitives.hashes import SHA1
from cryptography.hazmat.primitives.twofactor import InvalidToken
from cryptography.hazmat.primitives.twofactor.hotp import HOTP

STEP_S = 30
DIGITS = 6
SEED_BYTES = 20  # RFC 4226, 4: 160 bits are recommended
STEPS_BESIDE = 1  # clocks of telephones differ, and people type: RFC 6238, 5.2
RECOVERY_CODES = 8
RECOVERY_GROUPS, RECOVERY_GROUP = 6, 4
RECOVERY_LETTERS = "23456789abcdefghjkmnpqrstuvwxyz"  # 31: 24 of them are 118 bits
ISSUER = "Spanwise"


def new_seed() -> bytes:
    return secrets.token_bytes(SEED_BYTES)


def code_of(seed: bytes, step: int) -> str:
    return _generator(seed).generate(step).decode()


def matching_step(code: str, seed: bytes, *, at_s: float, after: int) -> int | None:
    """The step of 30 s whose code this is, later than `after`; None if it is none of now. `at_s`: seconds since 1970."""
    now = int(at_s // STEP_S)
    generator = _generator(seed)
    for step in range(max(now - STEPS_BESIDE, after + 1), now + STEPS_BESIDE + 1):
        try:
            generator.verify(code.encode(), step)  # takes as long for every code
        except InvalidToken:
            continue
        return step
    return None


def address_for_apps(seed_text: str, account: str) -> str:
    """What the QR code says: the key-URI of authenticator apps."""
    facts = urlencode({"secret": seed_text, "issuer": ISSUER, "algorithm": "SHA1", "digits": DIGITS, "period": STEP_S}, quote_via=quote)
    return f"otpauth://totp/{quote(ISSUER)}:{quote(account, safe='')}?{facts}"


def new_recovery_codes() -> list[str]:
    """Such as "k3pm-9vxq-…": no letter that is taken for another one."""
    return ["-".join(_group() for _ in range(RECOVERY_GROUPS)) for _ in range(RECOVERY_CODES)]


def bare(code: str) -> str:
    """As it is compared: without what people type between the letters."""
    return "".join(character for character in code.lower() if character.isalnum())


def is_of_an_app(code: str) -> bool:
    return len(code) == DIGITS and code.isascii() and code.isdigit()


def _group() -> str:
    return "".join(secrets.choice(RECOVERY_LETTERS) for _ in range(RECOVERY_GROUP))


def _generator(seed: bytes) -> HOTP:
    return HOTP(seed, DIGITS, SHA1())  # noqa: S303 - the algorithm that every app knows; HMAC does not rest on collisions
