"""Secrets that the environment names by a file, as container platforms hand them over: NAME_FILE in place of NAME."""

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
