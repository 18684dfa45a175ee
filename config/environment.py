"""Environment variables as settings: flags, lists, numbers, secrets from files, mail and log.

A secret may come from a file, as on container platforms: NAME_FILE in place of NAME.
"""

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlsplit

from django.utils.text import capfirst
from django.utils.translation import get_language_info, to_language

BACKENDS = {"console": "console", "file": "filebased", "memory": "locmem", "smtp": "smtp", "smtp+tls": "smtp", "smtp+ssl": "smtp"}
PORTS = {"smtp": 25, "smtp+tls": 587, "smtp+ssl": 465}
TIMEOUT_S = 10


class WrongMailAddress(ValueError):
    """Raised for an invalid SPANWISE_EMAIL_URL. The message does not repeat it, as it may hold a password."""


def mail_settings(address: str) -> dict[str, Any]:
    """Return Django's settings for console://, file:///folder, smtp://, smtp+tls:// (STARTTLS) or smtp+ssl://. Raises WrongMailAddress."""
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


def media_storage(folder: Path) -> dict[str, Any]:
    """Return Django's storage of photos and videos: a bucket of SPANWISE_MEDIA_BUCKET, else a folder that only this user reads.

    The folder is SPANWISE_MEDIA_DIR, else the given one. boto3 reads credentials and region from its own variables.
    """
    if bucket := os.environ.get("SPANWISE_MEDIA_BUCKET"):
        endpoint = os.environ.get("SPANWISE_MEDIA_ENDPOINT") or None
        options: dict[str, Any] = {
            "bucket_name": bucket,
            "endpoint_url": endpoint,
            "addressing_style": "path" if endpoint else "auto",  # own servers have no name for each bucket
            "signature_version": "s3v4",
            "file_overwrite": True,  # names are hashes
            "max_memory_size": 16 * 2**20,
        }
        return {"BACKEND": "storages.backends.s3.S3Storage", "OPTIONS": options}
    location = os.environ.get("SPANWISE_MEDIA_DIR") or str(folder)
    options = {"location": location, "file_permissions_mode": 0o600, "directory_permissions_mode": 0o700}
    return {"BACKEND": "django.core.files.storage.FileSystemStorage", "OPTIONS": options}


def log_settings(environment: Mapping[str, str]) -> dict[str, Any]:
    """Return Django's LOGGING: everything to the console, in one of two formats."""
    form = "json" if environment.get("SPANWISE_LOG_FORMAT") == "json" else "line"
    return {
        "version": 1,
        "disable_existing_loggers": False,
        "formatters": {
            "line": {"()": "operation.json_lines.LineFormatter"},
            "json": {"()": "operation.json_lines.JsonFormatter", "program": environment.get("SPANWISE_PROGRAM", "")},
        },
        "handlers": {"console": {"class": "logging.StreamHandler", "formatter": form}},
        "root": {"handlers": ["console"], "level": environment.get("SPANWISE_LOG_LEVEL", "INFO")},
    }


def languages(locale: Path) -> list[tuple[str, str]]:
    """Return the code of English and of each language with texts in `locale`, with its own name for itself."""
    codes = ["en", *sorted(to_language(path.parts[-3]) for path in locale.glob("*/LC_MESSAGES/django.po"))]
    return [(code, capfirst(str(get_language_info(code)["name_local"]))) for code in codes]


class SecretUnreadable(Exception):
    """Raised when the file that a variable names cannot be read. The message names both, never the content."""


def secret(name: str, default: str = "") -> str:
    """Return the variable `name`, else the text of the file in `name`_FILE without the line's end, else `default`.

    Raises SecretUnreadable: a program must not start with a default in place of a secret.
    """
    if value := os.environ.get(name):
        return value
    path = os.environ.get(f"{name}_FILE")
    if not path:
        return default
    try:
        return Path(path).read_text().rstrip("\r\n")
    except (OSError, UnicodeDecodeError) as error:
        raise SecretUnreadable(f"{name}_FILE leads to {path}, which cannot be read: {type(error).__name__}") from None


def flag(name: str, default: bool) -> bool:
    """Whether the variable is 1, true, yes or on."""
    return os.environ.get(name, "1" if default else "0").lower() in {"1", "true", "yes", "on"}


def entries(name: str, default: str) -> list[str]:
    """Return the entries of a comma-separated list."""
    return [entry.strip() for entry in os.environ.get(name, default).split(",") if entry.strip()]


def number(name: str, default: float) -> float:
    """Return the variable as a number. Raises ValueError."""
    return float(os.environ.get(name, default))


def mebibytes(name: str, default: int) -> int:
    """Return the variable, in MiB, as bytes."""
    return int(number(name, default) * 1024 * 1024)
