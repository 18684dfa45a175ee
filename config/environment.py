"""Environment variables as settings: flags, lists, numbers, and secrets from files.

A secret may be named by a file, as container platforms hand them over: NAME_FILE in place of NAME.
"""

import os
from pathlib import Path


class SecretUnreadable(Exception):
    """The file that a variable names cannot be read. The message names the variable and the file, never what is in it."""


def secret(name: str, default: str = "") -> str:
    """The variable `name`, else the text of the file that `name`_FILE leads to without the line's end, else `default`.

    Raises SecretUnreadable: a program that would go on with a default in a secret's place is worse than one that does not start.
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
    """The entries of a list with commas."""
    return [entry.strip() for entry in os.environ.get(name, default).split(",") if entry.strip()]


def number(name: str, default: float) -> float:
    """The variable as a number. Raises ValueError."""
    return float(os.environ.get(name, default))


def mebibytes(name: str, default: int) -> int:
    """The variable, in MiB, as bytes."""
    return int(number(name, default) * 1024 * 1024)
