"""Encryption of secrets in the database: AES-256-GCM with a key derived from the secret key."""

from base64 import b64decode, b64encode
from secrets import token_bytes

from cryptography.exceptions import InvalidTag
from cryptography.hazmat.primitives.ciphers.aead import AESGCM
from django.conf import settings
from django.utils.crypto import salted_hmac

NONCE_BYTES = 12  # SP 800-38D, 5.2.1.1
SALT = "workspace.sealing"


class CannotDecrypt(Exception):
    """Raised for a value that was encrypted for something else, or with a secret key that is no longer configured."""


def encrypt(secret: bytes, *, of: str) -> str:
    """Return the encrypted secret. `of` binds it to its owner, so that it cannot be moved to another row."""
    nonce = token_bytes(NONCE_BYTES)
    return b64encode(nonce + _cipher(settings.SECRET_KEY).encrypt(nonce, secret, of.encode())).decode()


def decrypt(encrypted: str, *, of: str) -> bytes:
    """Return the secret, also if it was encrypted with an old secret key that is still configured. Raises CannotDecrypt."""
    content = b64decode(encrypted)
    for key in (settings.SECRET_KEY, *settings.SECRET_KEY_FALLBACKS):
        try:
            return _cipher(key).decrypt(content[:NONCE_BYTES], content[NONCE_BYTES:], of.encode())
        except InvalidTag:
            continue
    raise CannotDecrypt


def _cipher(secret_key: str) -> AESGCM:
    return AESGCM(salted_hmac(SALT, "AES-256-GCM", secret=secret_key, algorithm="sha256").digest())
