"""How passwords are kept: Argon2id."""

from django.contrib.auth.hashers import Argon2PasswordHasher


class Argon2id(Argon2PasswordHasher):
    """Twice over 46 MiB on one thread: twice what OWASP's Password Storage Cheat Sheet asks for, 0.1 s of a core.

    Django's own figures take 100 MiB and eight threads each: a few people who sign in at once would hold all cores of a machine.
    """

    time_cost = 2
    memory_cost = 47_104  # KiB
    parallelism = 1
