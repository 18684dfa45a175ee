"""Models of organisations, users, tokens, jobs and history."""

import uuid
from typing import Any, ClassVar

from django.conf import settings
from django.contrib.auth.models import AbstractUser
from django.contrib.auth.models import UserManager as DjangoUserManager
from django.contrib.postgres.fields import ArrayField
from django.db import models
from django.db.models.functions import Now
from django.utils.crypto import salted_hmac
from django.utils.translation import gettext_lazy as _

from workspace.leases import has_run_out
from workspace.sign_in_models import BrowserSession as BrowserSession
from workspace.sign_in_models import RecoveryCode as RecoveryCode
from workspace.sign_in_models import SecondFactor as SecondFactor


class Organisation(models.Model):
    """A team with its own UAVs and missions; assets, zones and the graph are shared by all organisations."""

    name = models.CharField(max_length=200, unique=True)
    time_zone = models.CharField(
        max_length=64, blank=True, default="", db_default="", help_text="IANA name, for users who chose none; empty: the browser's"
    )
    revision = models.PositiveIntegerField(default=1, db_default=1, editable=False, help_text="counts the changes; the ETag")
    requires_second_factor = models.BooleanField(default=False, db_default=False, help_text="of everybody, from the next sign-in on")
    created_at = models.DateTimeField(db_default=Now(), editable=False)

    class Meta:
        ordering = ["name"]

    def __str__(self) -> str:
        return self.name


DEFAULT_ORGANISATION_ID = 1  # made by the first migration: the default for new users


class Role(models.TextChoices):
    VIEWER = "viewer", _("Viewer")
    OPERATOR = "operator", _("Operator")
    CURATOR = "curator", _("Curator")
    ADMINISTRATOR = "administrator", _("Administrator")


class Theme(models.TextChoices):
    SYSTEM = "system", "As the system"
    LIGHT = "light", "Light"
    DARK = "dark", "Dark"


class Units(models.TextChoices):
    METRIC = "metric", "Metres, kilometres, metres per second"
    IMPERIAL = "imperial", "Feet, miles, miles per hour"


class UserManager(DjangoUserManager["User"]):
    """Django's staff and superuser flags follow from the role, so they are neither stored nor requested."""

    def create_user(self, username: str, email: str | None = None, password: str | None = None, **fields: Any) -> "User":
        user = self.model(username=self.model.normalize_username(username), email=self.normalize_email(email), **fields)
        user.set_password(password)
        user.save(using=self._db)
        return user

    def create_superuser(self, username: str, email: str | None = None, password: str | None = None, **fields: Any) -> "User":
        return self.create_user(username, email, password, **{"role": Role.ADMINISTRATOR, "is_installation_operator": True, **fields})


class User(AbstractUser):
    """A user, or a program (`is_service`). The role determines permissions: see workspace/api/permissions.py."""

    groups = None  # type: ignore[assignment]
    user_permissions = None  # type: ignore[assignment]
    organisation = models.ForeignKey(Organisation, on_delete=models.PROTECT, default=DEFAULT_ORGANISATION_ID, related_name="users")
    role = models.CharField(max_length=20, choices=Role.choices, default=Role.VIEWER)
    is_installation_operator = models.BooleanField(
        default=False, db_default=False, editable=False, help_text="as administrator: of all organisations, in the admin"
    )
    is_service = models.BooleanField(default=False, db_default=False, editable=False, help_text="of a program: nobody signs in with it")
    theme = models.CharField(max_length=10, choices=Theme.choices, default=Theme.SYSTEM)
    units = models.CharField(
        max_length=10, choices=Units.choices, default=Units.METRIC, help_text="what is shown; what is stored is metric"
    )
    time_zone = models.CharField(max_length=64, blank=True, help_text="IANA name; empty: the organisation's, else the browser's")
    language = models.CharField(max_length=10, blank=True, default="", help_text="code; empty: the browser's")
    single_keys = models.BooleanField(default=True, help_text="shortcuts of one key on the pages")
    map_view = models.JSONField(null=True, blank=True, editable=False, help_text="where maps open: zoom, longitude, latitude")
    last_seen_at = models.DateTimeField(null=True, blank=True, editable=False, help_text="to the minute")
    session_generation = models.PositiveIntegerField(default=0, editable=False, help_text="a session of an earlier one has ended")

    objects: ClassVar[UserManager] = UserManager()

    class Meta:
        constraints = [
            models.CheckConstraint(condition=models.Q(role__in=Role.values), name="user_role_known"),
            models.CheckConstraint(
                condition=models.Q(is_service=False) | models.Q(password__startswith="!", is_installation_operator=False),  # noqa: S106 - no password
                name="service_without_password",
            ),
        ]

    def _get_session_auth_hash(self, secret: str | None = None) -> str:
        """Return a hash that ends sessions after a new password, as in Django, and after a new generation."""
        text = f"{self.password}{self.session_generation or ''}"
        return salted_hmac("workspace.session", text, secret=secret, algorithm="sha256").hexdigest()

    @property
    def own_language(self) -> str:
        """Return the chosen language; empty for the browser's, also where the chosen one is no longer in locale/."""
        return self.language if self.language in dict(settings.LANGUAGES) else ""

    @property
    def shown_time_zone(self) -> str:
        """Return the zone in which pages show times: the user's, else the organisation's; empty for the browser's."""
        return self.time_zone or self.organisation.time_zone

    @property
    def display_name(self) -> str:
        """Return the full name, or the user name where there is none."""
        return self.get_full_name() or self.username

    @property
    def has_local_password(self) -> bool:
        """Whether the user signs in with a password of Spanwise."""
        return bool(settings.LOCAL_SIGN_IN and self.has_usable_password())

    @property
    def is_staff(self) -> bool:  # type: ignore[override]
        """Whether the user may enter the admin."""
        return self.can_curate

    @property
    def is_superuser(self) -> bool:  # type: ignore[override]
        return self.role == Role.ADMINISTRATOR

    @property
    def operates_installation(self) -> bool:
        """Whether the user sees and changes rows of all organisations in the admin. Granted only on the machine itself."""
        return self.is_installation_operator and self.role == Role.ADMINISTRATOR

    @property
    def can_plan(self) -> bool:
        return self.role in {Role.OPERATOR, Role.ADMINISTRATOR}

    @property
    def can_curate(self) -> bool:
        return self.role in {Role.CURATOR, Role.ADMINISTRATOR}


class TokenScope(models.TextChoices):
    """Uses of a token, within its owner's role."""

    READ = "read", _("Read")
    PLAN = "plan", _("Plan")
    FLY = "fly", _("Fly")
    CURATE = "curate", _("Curate")
    ADMINISTER = "administer", _("Administer")


SCOPES_OF_ROLE: dict[str, tuple[TokenScope, ...]] = {
    Role.VIEWER: (TokenScope.READ,),
    Role.OPERATOR: (TokenScope.READ, TokenScope.PLAN, TokenScope.FLY),
    Role.CURATOR: (TokenScope.READ, TokenScope.CURATE),
    Role.ADMINISTRATOR: tuple(TokenScope),
}


class ApiToken(models.Model):
    """A bearer token. Only its SHA-256 is stored; the token itself is shown once."""

    user = models.ForeignKey(User, on_delete=models.CASCADE, related_name="api_tokens")
    name = models.CharField(max_length=100, default="api")
    token_sha256 = models.CharField(max_length=64, unique=True, editable=False)
    scopes = ArrayField(
        models.CharField(max_length=20, choices=TokenScope.choices), null=True, blank=True, help_text="empty: all that the role has"
    )
    created_at = models.DateTimeField(db_default=Now(), editable=False)
    expires_at = models.DateTimeField()
    revoked_at = models.DateTimeField(null=True, blank=True)
    last_used_at = models.DateTimeField(null=True, blank=True, help_text="to the minute")

    class Meta:
        ordering = ["-created_at"]

    def __str__(self) -> str:
        return f"{self.name} of {self.user}"


class Invitation(models.Model):
    """A link with which one user makes an account with a role. Only its SHA-256 is stored; the link itself is shown once."""

    organisation = models.ForeignKey(Organisation, on_delete=models.CASCADE, default=DEFAULT_ORGANISATION_ID, related_name="invitations")
    email = models.EmailField(blank=True, help_text="where the link was sent; empty: handed over by other means")
    role = models.CharField(max_length=20, choices=Role.choices, default=Role.VIEWER)
    token_sha256 = models.CharField(max_length=64, unique=True, editable=False)
    invited_by = models.ForeignKey(User, on_delete=models.SET_NULL, null=True, blank=True, related_name="invitations_sent")
    created_at = models.DateTimeField(db_default=Now(), editable=False)
    expires_at = models.DateTimeField()
    revoked_at = models.DateTimeField(null=True, blank=True)
    accepted_at = models.DateTimeField(null=True, blank=True)
    accepted_by = models.OneToOneField(User, on_delete=models.SET_NULL, null=True, blank=True, related_name="invitation")

    class Meta:
        ordering = ["-created_at"]
        constraints = [models.CheckConstraint(condition=models.Q(role__in=Role.values), name="invitation_role_known")]

    def __str__(self) -> str:
        return f"{self.get_role_display()} {self.email or self.pk}"


class SignInOutcome(models.TextChoices):
    SIGNED_IN = "signed-in", "Signed in"
    WRONG = "wrong", "Wrong name or password"
    WRONG_CODE = "wrong-code", "Wrong code"
    HELD_BACK = "held-back", "Too many tries"
    SIGNED_OUT = "signed-out", "Signed out"
    REFUSED = "refused", "Refused after single sign-on"


class SignInEntry(models.Model):
    """A login attempt or a logout. Unknown names are not stored: users type passwords there."""

    user = models.ForeignKey(User, on_delete=models.CASCADE, null=True, blank=True, related_name="sign_ins")
    outcome = models.CharField(max_length=12, choices=SignInOutcome.choices)
    address = models.CharField(max_length=45, blank=True, help_text="IP address")
    user_agent = models.CharField(max_length=200, blank=True)
    recorded_at = models.DateTimeField(db_default=Now(), editable=False)

    class Meta:
        ordering = ["-recorded_at", "-pk"]
        verbose_name_plural = "sign-in entries"
        constraints = [models.CheckConstraint(condition=models.Q(outcome__in=SignInOutcome.values), name="sign_in_outcome_known")]
        indexes = [
            models.Index(fields=["-recorded_at", "-id"], name="sign_in_newest_idx"),
            models.Index(fields=["user", "-recorded_at"], name="sign_in_of_user_idx"),
        ]

    def __str__(self) -> str:
        return f"{self.get_outcome_display()} {self.user or 'unknown'}"


class JobState(models.TextChoices):
    QUEUED = "queued", "Queued"
    RUNNING = "running", "Running"
    DONE = "done", "Done"
    FAILED = "failed", "Failed"
    CANCELLED = "cancelled", "Cancelled"


OPEN_STATES = (JobState.QUEUED, JobState.RUNNING)


class Job(models.Model):
    """Work that takes longer than a request. The row is authoritative; the queue is a hint.

    A worker holds a job by a lease. A job with an expired lease, or that was never picked up, is queued again. The attempt number
    identifies the lease: writes of an earlier attempt match no row.
    """

    id = models.UUIDField(primary_key=True, default=uuid.uuid4, editable=False)
    organisation = models.ForeignKey(Organisation, on_delete=models.CASCADE, default=DEFAULT_ORGANISATION_ID, related_name="jobs")
    created_by = models.ForeignKey(User, on_delete=models.SET_NULL, null=True, blank=True, related_name="jobs")
    task = models.CharField(max_length=100, help_text="dotted name of the Celery task that does it")
    state = models.CharField(max_length=20, choices=JobState.choices, default=JobState.QUEUED)
    parameters = models.JSONField(default=dict)
    progress = models.FloatField(default=0.0, help_text="0 to 1")
    message = models.CharField(max_length=300, blank=True)
    message_why = models.JSONField(null=True, blank=True, help_text="the same as reasons; see reason_texts.py")
    best = models.JSONField(null=True, blank=True, help_text="the best found so far, while it runs")
    result = models.JSONField(null=True, blank=True)
    error = models.JSONField(null=True, blank=True)
    attempts = models.PositiveSmallIntegerField(default=0)
    lease_expires_at = models.DateTimeField(null=True, blank=True)
    cancel_requested_at = models.DateTimeField(null=True, blank=True)
    created_at = models.DateTimeField(db_default=Now(), editable=False)
    started_at = models.DateTimeField(null=True, blank=True)
    finished_at = models.DateTimeField(null=True, blank=True)

    class Meta:
        ordering = ["-created_at"]
        constraints = [
            models.CheckConstraint(condition=models.Q(state__in=JobState.values), name="job_state_known"),
            models.CheckConstraint(condition=models.Q(progress__gte=0, progress__lte=1), name="job_progress_share"),
        ]
        indexes = [
            models.Index(fields=["state", "lease_expires_at"], name="job_open_idx"),
            models.Index(fields=["created_by"], condition=models.Q(state__in=["queued", "running"]), name="job_open_of_user_idx"),
        ]

    def __str__(self) -> str:
        return f"{self.task} {self.id}"

    @property
    def is_open(self) -> bool:
        return self.state in OPEN_STATES

    @property
    def is_held(self) -> bool:
        """Whether a worker with a valid lease runs it."""
        return self.state == JobState.RUNNING and not has_run_out(self.lease_expires_at)


class AuditEntry(models.Model):
    """One change: who, what, before and after. Never updated, never deleted by the program."""

    organisation = models.ForeignKey(Organisation, on_delete=models.CASCADE, default=DEFAULT_ORGANISATION_ID, related_name="audit_entries")
    actor = models.ForeignKey(User, on_delete=models.SET_NULL, null=True, blank=True, related_name="audit_entries")
    action = models.CharField(max_length=50)
    subject_type = models.CharField(max_length=50)
    subject_id = models.CharField(max_length=50)
    before = models.JSONField(null=True, blank=True)
    after = models.JSONField(null=True, blank=True)
    recorded_at = models.DateTimeField(db_default=Now(), editable=False)

    class Meta:
        ordering = ["-recorded_at", "-pk"]
        verbose_name_plural = "audit entries"
        indexes = [models.Index(fields=["subject_type", "subject_id", "-recorded_at"], name="audit_subject_idx")]

    def __str__(self) -> str:
        return f"{self.action} {self.subject_type} {self.subject_id}"


class IdempotencyKey(models.Model):
    """The response to a POST with an `Idempotency-Key`, so that a repeated request creates nothing new."""

    user = models.ForeignKey(User, on_delete=models.CASCADE, related_name="idempotency_keys")
    key = models.CharField(max_length=200)
    request_sha256 = models.CharField(max_length=64, help_text="of method, path and body")
    status = models.PositiveSmallIntegerField(null=True, help_text="empty only inside the transaction that makes the answer")
    headers = models.JSONField(default=dict)
    body = models.JSONField(null=True)
    created_at = models.DateTimeField(db_default=Now(), editable=False)

    class Meta:
        ordering = ["-created_at"]
        constraints = [models.UniqueConstraint(fields=["user", "key"], name="idempotency_key_unique")]
        indexes = [models.Index(fields=["created_at"], name="idempotency_age_idx")]

    def __str__(self) -> str:
        return f"{self.key} of {self.user}"
