"""Validation of new passwords, and their hashing."""

import re
from typing import Any

from django.conf import settings
from django.contrib.auth.hashers import Argon2PasswordHasher
from django.core.exceptions import ValidationError
from django.utils.translation import gettext as _

PRODUCT_AND_TRADE = (
    "spanwise", "inspection", "inspector", "inspect", "powerline", "pylon", "tower", "bridge", "railway", "uav", "drone", "mavlink",
    "pilot", "operator", "curator", "viewer", "administrator", "admin", "mission", "password", "passwort", "kennwort", "inspektion",
    "stromleitung", "leitung", "freileitung", "strommast", "mast", "turm", "brücke", "bruecke", "bahn", "eisenbahn", "drohne", "flug",
    "bediener", "kurator", "betrachter", "verwalter", "geheim", "willkommen", "sommer", "winter", "herbst", "frühling",
)  # fmt: skip
MIN_WORD_LENGTH = 3  # of an organisation's name: shorter words are in every password
MIN_REST_LENGTH = 8  # required characters besides the words
LIKE_LETTERS = str.maketrans({"0": "o", "1": "i", "!": "i", "3": "e", "4": "a", "@": "a", "5": "s", "$": "s", "7": "t"})


def context_words(organisation: str) -> set[str]:
    """Return the words as they are compared: lower-case letters and digits, transliterated."""
    site = [host for host in settings.ALLOWED_HOSTS if not re.fullmatch(r"[\d.:\[\]*]+|localhost", host)]
    named = re.findall(r"[^\W_]+", " ".join([organisation, *site, *settings.PASSWORD_WORDS]).casefold())
    return {_plain(word) for word in (*PRODUCT_AND_TRADE, *named) if len(word) >= MIN_WORD_LENGTH}


def rest_beside(password: str, words: set[str]) -> str:
    """Return a password without such words, with digits read as letters and separators removed."""
    rest = _plain(password)
    for word in sorted(words, key=len, reverse=True):
        rest = rest.replace(word, "")
    return rest


class ContextWordsValidator:
    """Refuses passwords that are mostly such a word: "Spanwise2026!", but not a long sentence that contains one."""

    def validate(self, password: str, user: Any = None) -> None:
        organisation = "" if user is None else user.organisation.name
        words = context_words(organisation)
        rest = rest_beside(password, words)
        if rest != _plain(password) and len(rest) < MIN_REST_LENGTH:
            message = _("This is made of words that everybody here would try first. Add something of your own, 8 characters or more.")
            raise ValidationError(message, code="password_of_context_words")

    def get_help_text(self) -> str:
        return _("Not only the name of this program, of your organisation, or of what you do here.")


def _plain(text: str) -> str:
    return re.sub(r"[\W_]", "", text.casefold().translate(LIKE_LETTERS))


class Argon2id(Argon2PasswordHasher):
    """Argon2id with 46 MiB, twice, on one thread: twice what OWASP's Password Storage Cheat Sheet recommends, 0.1 s of a core.

    Django's own parameters use 100 MiB and eight threads each: a few concurrent logins would occupy all cores.
    """

    time_cost = 2
    memory_cost = 47_104  # KiB
    parallelism = 1
