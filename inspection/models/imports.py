"""Imported files, and incoming ones: parts of an upload, and proposals for a curator's review."""

import uuid

from django.conf import settings
from django.contrib.gis.db import models
from django.db.models import Q
from django.db.models.functions import Now

from inspection.models.regions import Region
from workspace.models import DEFAULT_ORGANISATION_ID, Job

MAX_REMOVED_PERCENT = 5.0  # of auto_apply, unless stated otherwise


class ImportKind(models.TextChoices):
    OSM = "osm", "OpenStreetMap"
    ZONES = "zones", "No-fly zones"
    ASSETS = "assets", "Asset file"
    TERRAIN = "terrain", "Terrain"


class DataImport(models.Model):
    """One imported file: the data's source, licence and content."""

    kind = models.CharField(max_length=20, choices=ImportKind.choices)
    region = models.ForeignKey(Region, on_delete=models.SET_NULL, null=True, blank=True, related_name="imports")
    file_name = models.CharField(max_length=255)
    sha256 = models.CharField(max_length=64)
    attribution = models.CharField(max_length=300, blank=True)
    licence = models.CharField(max_length=200, blank=True)
    source_address = models.URLField(max_length=500, blank=True, help_text="where the file was fetched; empty for one that somebody sent")
    fetched_at = models.DateTimeField(null=True, blank=True)
    valid_from = models.DateTimeField(null=True, blank=True, help_text="as the file states it")
    valid_until = models.DateTimeField(null=True, blank=True, help_text="as the file states it")
    is_synthetic = models.BooleanField(default=False, help_text="made data, such as the demo region; said wherever it is shown")
    data_timestamp = models.DateTimeField(null=True, blank=True, help_text="how fresh the file says that its data is")
    counts = models.JSONField(default=dict)
    imported_at = models.DateTimeField(db_default=Now(), editable=False)
    imported_by = models.ForeignKey(settings.AUTH_USER_MODEL, on_delete=models.SET_NULL, null=True, blank=True)

    class Meta:
        ordering = ["-imported_at", "-pk"]

    def __str__(self) -> str:
        return self.file_name


class Upload(models.Model):
    """A file that arrives part by part; received parts survive a lost connection.

    The bytes are in the database, so that any web process can receive them and any worker can read them.
    """

    id = models.UUIDField(primary_key=True, default=uuid.uuid4, editable=False)
    created_by = models.ForeignKey(settings.AUTH_USER_MODEL, on_delete=models.SET_NULL, null=True, blank=True)
    file_name = models.CharField(max_length=255)
    size_bytes = models.BigIntegerField()
    received_bytes = models.BigIntegerField(default=0, help_text="without a gap from the start")
    sha256 = models.CharField(max_length=64, blank=True, help_text="of the whole file, once it is here")
    created_at = models.DateTimeField(db_default=Now(), editable=False)
    updated_at = models.DateTimeField(auto_now=True)

    class Meta:
        ordering = ["-created_at"]
        constraints = [
            models.CheckConstraint(
                condition=Q(received_bytes__gte=0, received_bytes__lte=models.F("size_bytes")), name="upload_within_size"
            ),
        ]

    def __str__(self) -> str:
        return self.file_name

    @property
    def is_complete(self) -> bool:
        return self.received_bytes == self.size_bytes


class UploadPart(models.Model):
    upload = models.ForeignKey(Upload, on_delete=models.CASCADE, related_name="parts")
    first_byte = models.BigIntegerField()
    content = models.BinaryField()

    class Meta:
        ordering = ["first_byte"]
        constraints = [models.UniqueConstraint(fields=["upload", "first_byte"], name="upload_part_place")]

    def __str__(self) -> str:
        return f"{self.upload_id} from byte {self.first_byte}"


class ProposalState(models.TextChoices):
    READING = "reading", "Reading"
    REFUSED = "refused", "Refused"  # the file has faults; none of it counts
    READY = "ready", "Ready to look at"
    APPLYING = "applying", "Applying"
    APPLIED = "applied", "Applied"
    DISCARDED = "discarded", "Discarded"


class ProposalOrigin(models.TextChoices):
    UPLOAD = "upload", "Uploaded file"
    OVERPASS = "overpass", "Overpass"
    SUBSCRIPTION = "subscription", "Subscription"
    ROLL_BACK = "roll_back", "Roll-back"


class ImportProposal(models.Model):
    """The changes that a file would make. A curator reviews the difference and applies or discards it; until then none of it counts."""

    id = models.UUIDField(primary_key=True, default=uuid.uuid4, editable=False)
    kind = models.CharField(max_length=20, choices=ImportKind.choices)
    origin = models.CharField(max_length=20, choices=ProposalOrigin.choices, default=ProposalOrigin.UPLOAD)
    state = models.CharField(max_length=20, choices=ProposalState.choices, default=ProposalState.READING)
    upload = models.ForeignKey(Upload, on_delete=models.SET_NULL, null=True, blank=True, related_name="proposals")
    file_name = models.CharField(max_length=255, blank=True)
    parameters = models.JSONField(default=dict, blank=True, help_text="such as the zone set's name, the column mapping, the vertical datum")
    provenance = models.JSONField(default=dict, blank=True, help_text="source_address, licence, attribution, fetched_at")
    job = models.ForeignKey(Job, on_delete=models.SET_NULL, null=True, blank=True, related_name="+", help_text="that reads or applies it")
    faults = models.JSONField(default=list, blank=True, help_text='[{"place", "message", "position"}] of a refused file')
    summary = models.JSONField(default=dict, blank=True, help_text="what is in the file")
    difference = models.JSONField(default=dict, blank=True, help_text="numbers of changes by action")
    ground_revision = models.PositiveBigIntegerField(null=True, blank=True, help_text="the ground that the difference was taken against")
    auto_apply = models.BooleanField(default=False, db_default=False, help_text="applied once it is read, if it keeps to the bounds")
    max_removed_percent = models.FloatField(
        default=MAX_REMOVED_PERCENT, db_default=MAX_REMOVED_PERCENT, help_text="bound of auto_apply: of the rows that the source has had"
    )
    held_back = models.JSONField(
        default=list, db_default=[], blank=True, help_text='[{"code", "message"}] why it was not applied although auto_apply was asked'
    )
    data_import = models.ForeignKey(DataImport, on_delete=models.SET_NULL, null=True, blank=True, related_name="proposals")
    created_by = models.ForeignKey(settings.AUTH_USER_MODEL, on_delete=models.SET_NULL, null=True, blank=True, related_name="+")
    created_at = models.DateTimeField(db_default=Now(), editable=False)
    decided_by = models.ForeignKey(settings.AUTH_USER_MODEL, on_delete=models.SET_NULL, null=True, blank=True, related_name="+")
    decided_at = models.DateTimeField(null=True, blank=True)

    class Meta:
        ordering = ["-created_at", "-pk"]
        constraints = [models.CheckConstraint(condition=Q(state__in=ProposalState.values), name="proposal_state_known")]

    def __str__(self) -> str:
        return f"{self.get_kind_display()} {self.file_name}"

    @property
    def organisation_id(self) -> int:
        """Return the organisation of the file and of its external ids."""
        return self.created_by.organisation_id if self.created_by else DEFAULT_ORGANISATION_ID


class ChangeAction(models.TextChoices):
    NEW = "new", "New"
    CHANGED = "changed", "Changed"
    VANISHED = "vanished", "Vanished"
    KEPT = "kept", "Kept as edited by hand"
    NOT_READ = "not_read", "Not read"  # a record of the file with a fault; the set's version of it stays


ROW_ACTIONS = (ChangeAction.NEW, ChangeAction.CHANGED, ChangeAction.VANISHED, ChangeAction.KEPT)  # actions on rows of map data


class ProposedChange(models.Model):
    """One line of a difference. A large difference stores the first of each action; the proposal has the totals."""

    proposal = models.ForeignKey(ImportProposal, on_delete=models.CASCADE, related_name="changes")
    action = models.CharField(max_length=20, choices=ChangeAction.choices)
    subject = models.CharField(max_length=20, help_text="asset kind, or zone")
    subject_id = models.BigIntegerField(null=True, blank=True, help_text="of the row that it changes")
    label = models.CharField(max_length=300)
    key = models.CharField(max_length=300, blank=True, default="", db_default="", help_text="names the row, to leave it out")
    geometry = models.GeometryField(srid=4326, null=True, blank=True)
    before = models.JSONField(null=True, blank=True, help_text="facts that differ, as they are")
    after = models.JSONField(null=True, blank=True, help_text="facts that differ, as they would be")

    class Meta:
        ordering = ["pk"]
        indexes = [models.Index(fields=["proposal", "action", "id"], name="change_action_idx")]

    def __str__(self) -> str:
        return f"{self.action} {self.label}"
