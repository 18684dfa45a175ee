"""Secrets that have to be read again, kept so that the database alone does not tell them: AES-256-GCM with a key of the secret key."""

from base64 import b64decode, b64encode
from secrets import token_bytes

from cryptography.exceptions import InvalidTag
from cryptography.hazmat.primitives.ciphers.aead import AESGCM
from django.conf import settings
from django.utils.crypto import salted_hmac

NONCE_BYTES = 12  # SP 800-38D, 5.2.1.1
SALT = "workspace.sealing"


class CannotDecrypt(Exception):
    """It was sealed for something else, or with a key that is not named any more."""


def encrypt(secret: bytes, *, of: str) -> str:
    """`of` says what it belongs to: nobody can put it elsewhere."""
    nonce = token_bytes(NONCE_BYTES)
    return b64encode(nonce + _cipher(settings.SECRET_KEY).encrypt(nonce, secret, of.encode())).decode()


def decrypt(encrypted: str, *, of: str) -> bytes:
    """Also what was sealed with an old secret key that is still named. Raises CannotDecrypt."""
    content = b64decode(encrypted)
    for key in (settings.SECRET_KEY, *settings.SECRET_KEY_FALLBACKS):
        try:
            return _cipher(key).decrypt(content[:NONCE_BYTES], content[NONCE_BYTES:], of.encode())
        except InvalidTag:
            continue
    raise CannotDecrypt


def _cipher(secret_key: str) -> AESGCM:
    return AESGCM(salted_hmac(SALT, "AES-256-GCM", secret=secret_key, algorithm="sha256").digest())
