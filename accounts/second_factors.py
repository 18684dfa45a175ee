"""Second factors: setup of an authenticator app, its codes, recovery codes, removal. Each change is recorded in the history."""

import secrets
from base64 import b32encode
from datetime import timedelta
from urllib.parse import quote, urlencode

from allauth.mfa.models import Authenticator
from cryptography.hazmat.primitives.hashes import SHA1
from cryptography.hazmat.primitives.twofactor import InvalidToken
from cryptography.hazmat.primitives.twofactor.hotp import HOTP
from django.conf import settings
from django.db import transaction
from django.db.models import Exists, OuterRef, QuerySet
from django.utils import timezone

from accounts.services import end_sessions
from workspace.api_tokens import hash_token
from workspace.audit import record_account_event, record_change
from workspace.field_encryption import CannotDecrypt, decrypt, encrypt
from workspace.models import Organisation, RecoveryCode, SecondFactor, User

STEP_S = 30
DIGITS = 6
SEED_BYTES = 20  # RFC 4226, 4: 160 bits are recommended
STEPS_BESIDE = 1  # for clock differences and typing: RFC 6238, 5.2
RECOVERY_CODES = 8
RECOVERY_GROUPS, RECOVERY_GROUP = 6, 4
RECOVERY_LETTERS = "23456789abcdefghjkmnpqrstuvwxyz"  # 31: 24 of them are 118 bits
ISSUER = "Spanwise"


def new_seed() -> bytes:
    return secrets.token_bytes(SEED_BYTES)


def code_of(seed: bytes, step: int) -> str:
    return _generator(seed).generate(step).decode()


def matching_step(code: str, seed: bytes, *, at_s: float, after: int) -> int | None:
    """Return the 30 s step of this code, later than `after`; None if it is no current code. `at_s`: seconds since 1970."""
    now = int(at_s // STEP_S)
    generator = _generator(seed)
    for step in range(max(now - STEPS_BESIDE, after + 1), now + STEPS_BESIDE + 1):
        try:
            generator.verify(code.encode(), step)  # constant time
        except InvalidToken:
            continue
        return step
    return None


def address_for_apps(seed_text: str, account: str) -> str:
    """Return the content of the QR code: the key URI of authenticator apps."""
    facts = urlencode({"secret": seed_text, "issuer": ISSUER, "algorithm": "SHA1", "digits": DIGITS, "period": STEP_S}, quote_via=quote)
    return f"otpauth://totp/{quote(ISSUER)}:{quote(account, safe='')}?{facts}"


def new_recovery_codes() -> list[str]:
    """Return codes such as "k3pm-9vxq-…", without letters that are easily confused."""
    return ["-".join(_group() for _ in range(RECOVERY_GROUPS)) for _ in range(RECOVERY_CODES)]


def bare(code: str) -> str:
    """Return the code as it is compared: without separators."""
    return "".join(character for character in code.lower() if character.isalnum())


def is_of_an_app(code: str) -> bool:
    return len(code) == DIGITS and code.isascii() and code.isdigit()


def _group() -> str:
    return "".join(secrets.choice(RECOVERY_LETTERS) for _ in range(RECOVERY_GROUP))


def _generator(seed: bytes) -> HOTP:
    return HOTP(seed, DIGITS, SHA1())  # noqa: S303 - the algorithm that every app supports; HMAC does not depend on collision resistance


TRIES = 5  # wrong codes of one user, from any address: they already know the password
WINDOW = timedelta(minutes=15)


class WrongCode(Exception):
    """Raised for a code that is not current, or was used before. `left` is the number of tries left in the window."""

    def __init__(self, left: int) -> None:
        super().__init__(f"wrong code, {left} left")
        self.left = left


class TooManyCodes(Exception):
    """Raised while codes are not checked after too many wrong ones."""


class SetUpFirst(Exception):
    """Raised when an administrator without a second factor would require one of all users."""


def has_authenticator_app(user: User) -> bool:
    return SecondFactor.objects.filter(user=user).exists()


def passkeys_of(user: User) -> QuerySet[Authenticator]:
    """Return the user's passkeys, the oldest first."""
    return Authenticator.objects.filter(user=user, type=Authenticator.Type.WEBAUTHN).order_by("pk")


def has_second_factor(user: User) -> bool:
    return has_authenticator_app(user) or passkeys_of(user).exists()


def with_second_factor(users: QuerySet[User]) -> QuerySet[User]:
    """Add `has_second_factor` to the rows."""
    passkeys = Authenticator.objects.filter(user=OuterRef("pk"), type=Authenticator.Type.WEBAUTHN)
    return users.annotate(has_second_factor=Exists(SecondFactor.objects.filter(user=OuterRef("pk"))) | Exists(passkeys))


def is_required_of(user: User) -> bool:
    """Whether the user's organisation or the installation requires a second factor."""
    return bool(settings.REQUIRES_SECOND_FACTOR or user.organisation.requires_second_factor)


def seed_text(seed: bytes) -> str:
    """Return the seed as users type it, and apps read it."""
    return b32encode(seed).decode()


def set_up(*, user: User, seed: bytes, code: str) -> list[str]:
    """Store the seed if the code matches it, and return the recovery codes, which cannot be shown again. Raises WrongCode."""
    step = matching_step(bare(code), seed, at_s=timezone.now().timestamp(), after=-1)
    if step is None:
        raise WrongCode(TRIES)
    with transaction.atomic():
        SecondFactor.objects.filter(user=user).delete()
        factor = SecondFactor.objects.create(user=user, sealed_seed=encrypt(seed, of=_name_of(user)), last_step=step)
        codes = _keep_recovery_codes(factor)
        record_account_event(user, user, "second factor set up")
    return codes


def try_code(*, user: User, code: str) -> None:
    """Accept a code of the app, or a recovery code; each works once. Raises WrongCode, TooManyCodes; SecondFactor.DoesNotExist.

    After too many wrong codes, codes of the app are refused for a while; a recovery code, which cannot be guessed, is still accepted.
    """
    with transaction.atomic():  # one try at a time: concurrent ones gain nothing
        factor = SecondFactor.objects.select_for_update().select_related("user").get(user=user)
        is_held_back = _is_in_window(factor) and factor.wrong_tries >= TRIES
        is_right = (not is_held_back and _take_code(factor, bare(code))) or _take_recovery_code(factor, bare(code))
        if is_right:
            factor.wrong_tries, factor.wrong_since = 0, None
        elif not is_held_back:
            _count_wrong(factor)
        factor.save(update_fields=["last_step", "wrong_tries", "wrong_since"])
    if is_held_back and not is_right:
        raise TooManyCodes
    if not is_right:
        raise WrongCode(TRIES - factor.wrong_tries)


def renew_recovery_codes(*, user: User) -> list[str]:
    """Return eight new codes and invalidate the old ones."""
    with transaction.atomic():
        factor = SecondFactor.objects.select_for_update().get(user=user)
        factor.recovery_codes.all().delete()
        codes = _keep_recovery_codes(factor)
        record_account_event(user, user, "recovery codes made")
    return codes


def recovery_codes_left(user: User) -> int:
    return RecoveryCode.objects.filter(second_factor__user=user, used_at=None).count()


def remove_authenticator_app(*, user: User) -> None:
    with transaction.atomic():
        SecondFactor.objects.filter(user=user).delete()
        record_account_event(user, user, "second factor removed")


def reset_second_factors(*, user: User, actor: User | None) -> bool:
    """Remove the authenticator app and the passkeys of another user, whose sessions end. Returns False if there were none."""
    with transaction.atomic():
        deleted = SecondFactor.objects.filter(user=user).delete()[0] + passkeys_of(user).delete()[0]
        if deleted:
            record_account_event(user, actor, "second factor reset")
            end_sessions(user=user, actor=actor)
    return bool(deleted)


def require_second_factor(*, actor: User, required: bool) -> None:
    """Require a second factor of all users of the organisation from their next login on, or no longer. Raises SetUpFirst."""
    if required and not has_second_factor(actor):
        raise SetUpFirst
    with transaction.atomic():
        organisation = Organisation.objects.select_for_update().get(pk=actor.organisation_id)
        before = organisation.requires_second_factor
        if before != required:
            organisation.requires_second_factor = required
            organisation.save(update_fields=["requires_second_factor"])
            record_change(
                organisation=organisation,
                actor=actor,
                action="second factor rule",
                subject_type="organisation",
                subject_id=organisation.pk,
                before={"requires_second_factor": before},
                after={"requires_second_factor": required},
            )


def encrypt_with_current_key() -> int:
    """Encrypt seeds of old secret keys again, so that the old keys can be removed. Returns how many were checked."""
    if not settings.SECRET_KEY_FALLBACKS:
        return 0
    factors = SecondFactor.objects.select_related("user")
    count = 0
    for factor in factors:
        name = _name_of(factor.user)
        try:
            encrypted = encrypt(decrypt(factor.sealed_seed, of=name), of=name)
        except CannotDecrypt:
            continue
        count += SecondFactor.objects.filter(pk=factor.pk, sealed_seed=factor.sealed_seed).update(sealed_seed=encrypted)
    return count


def _name_of(user: User) -> str:
    return f"second factor of {user.pk}"


def _is_in_window(factor: SecondFactor) -> bool:
    return factor.wrong_since is not None and timezone.now() - factor.wrong_since < WINDOW


def _count_wrong(factor: SecondFactor) -> None:
    if not _is_in_window(factor):
        factor.wrong_tries, factor.wrong_since = 0, timezone.now()
    factor.wrong_tries += 1


def _take_code(factor: SecondFactor, code: str) -> bool:
    if not is_of_an_app(code):
        return False
    try:
        seed = decrypt(factor.sealed_seed, of=_name_of(factor.user))
    except CannotDecrypt:
        return False
    step = matching_step(code, seed, at_s=timezone.now().timestamp(), after=factor.last_step)
    if step is None:
        return False
    factor.last_step = step
    return True


def _take_recovery_code(factor: SecondFactor, code: str) -> bool:
    unused = factor.recovery_codes.filter(code_sha256=hash_token(code), used_at=None)
    if not unused.update(used_at=timezone.now()):
        return False
    record_account_event(factor.user, factor.user, "recovery code used")
    return True


def _keep_recovery_codes(factor: SecondFactor) -> list[str]:
    codes = new_recovery_codes()
    RecoveryCode.objects.bulk_create([RecoveryCode(second_factor=factor, code_sha256=hash_token(bare(code))) for code in codes])
    return codes
