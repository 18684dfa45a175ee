"""Models of the login: second factors with their recovery codes, and browser sessions."""

from django.db import models
from django.db.models.functions import Now


class SecondFactor(models.Model):
    """A user's authenticator app. The seed is encrypted (workspace/field_encryption.py): the database alone makes no codes."""

    user = models.OneToOneField("workspace.User", on_delete=models.CASCADE, related_name="second_factor")
    sealed_seed = models.CharField(max_length=200, editable=False)
    last_step = models.BigIntegerField(help_text="the 30 s, counted from 1970, of the last code that was taken; none is taken twice")
    wrong_tries = models.PositiveSmallIntegerField(default=0)
    wrong_since = models.DateTimeField(null=True, blank=True, help_text="the first of the wrong tries")
    created_at = models.DateTimeField(db_default=Now(), editable=False)

    def __str__(self) -> str:
        return f"second factor of {self.user}"


class RecoveryCode(models.Model):
    """A code that replaces one of the app once. Only its SHA-256 is stored; it is made of 118 random bits."""

    second_factor = models.ForeignKey(SecondFactor, on_delete=models.CASCADE, related_name="recovery_codes")
    code_sha256 = models.CharField(max_length=64, editable=False)
    used_at = models.DateTimeField(null=True, blank=True)

    class Meta:
        constraints = [models.UniqueConstraint(fields=["second_factor", "code_sha256"], name="recovery_code_unique")]

    def __str__(self) -> str:
        return f"recovery code {self.pk}"


class BrowserSession(models.Model):
    """The user and the use of a Django session. A session from an earlier version has no row until its next request.

    There is no database constraint: the previous version deletes sessions without this table.
    """

    session = models.OneToOneField(
        "sessions.Session", on_delete=models.CASCADE, db_constraint=False, db_column="session_key", related_name="in_use"
    )
    user = models.ForeignKey("workspace.User", on_delete=models.CASCADE, related_name="browser_sessions")
    user_agent = models.CharField(max_length=200, blank=True)
    address = models.GenericIPAddressField(null=True, blank=True, help_text="of the last request that was noted")
    began_at = models.DateTimeField()
    acted_at = models.DateTimeField(help_text="when a page was opened or something was sent, to the minute")
    present_at = models.DateTimeField(help_text="when an open page was last heard of, to the minute")

    class Meta:
        ordering = ["-present_at", "-pk"]

    def __str__(self) -> str:
        return f"session of {self.user} since {self.began_at:%Y-%m-%d %H:%M}"
