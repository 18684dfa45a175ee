"""How mail leaves: one address such as smtp+tls://user:password@host:587, as the other servers have one."""

from typing import Any
from urllib.parse import unquote, urlsplit

BACKENDS = {"console": "console", "file": "filebased", "memory": "locmem", "smtp": "smtp", "smtp+tls": "smtp", "smtp+ssl": "smtp"}
PORTS = {"smtp": 25, "smtp+tls": 587, "smtp+ssl": 465}
TIMEOUT_S = 10


class WrongMailAddress(ValueError):
    """SPANWISE_EMAIL_URL cannot be understood. The message does not repeat it: it may hold a password."""


def mail_settings(address: str) -> dict[str, Any]:
    """Django's settings for console://, file:///folder, smtp://, smtp+tls:// (STARTTLS) or smtp+ssl://. Raises WrongMailAddress."""
    try:
        parts = urlsplit(address)
        port = parts.port
    except ValueError as error:
        raise WrongMailAddress("SPANWISE_EMAIL_URL is no address.") from error
    if parts.scheme not in BACKENDS:
        raise WrongMailAddress(f"SPANWISE_EMAIL_URL begins with one of {', '.join(f'{scheme}://' for scheme in BACKENDS)}.")
    settings: dict[str, Any] = {"EMAIL_BACKEND": f"django.core.mail.backends.{BACKENDS[parts.scheme]}.EmailBackend"}
    if parts.scheme == "file":
        settings["EMAIL_FILE_PATH"] = parts.path
    if parts.scheme in PORTS:
        if not parts.hostname:
            raise WrongMailAddress("SPANWISE_EMAIL_URL names no host.")
        settings |= {
            "EMAIL_HOST": parts.hostname, "EMAIL_PORT": port or PORTS[parts.scheme], "EMAIL_TIMEOUT": TIMEOUT_S,
            "EMAIL_HOST_USER": unquote(parts.username or ""), "EMAIL_HOST_PASSWORD": unquote(parts.password or ""),
            "EMAIL_USE_TLS": parts.scheme == "smtp+tls", "EMAIL_USE_SSL": parts.scheme == "smtp+ssl",
        }  # fmt: skip
    return settings
