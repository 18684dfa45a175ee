"""Changes of map data, newest first. All users see all changes, but no names of users of other organisations."""

from django.db.models import QuerySet

from workspace.models import AuditEntry, User

NEWEST_FIRST = ("-recorded_at", "-pk")
SUBJECTS = ("asset", "zone")


def changes_of_the_ground(*, subject_type: str = "") -> QuerySet[AuditEntry]:
    return AuditEntry.objects.select_related("actor").filter(subject_type__in=[subject_type] if subject_type else SUBJECTS)


def changes_by(username: str, entries: QuerySet[AuditEntry], *, reader: User) -> QuerySet[AuditEntry]:
    """Return those of the entries that a user made; none for a user of another organisation, except for installation operators."""
    entries = entries.filter(actor__username=username)
    return entries if reader.operates_installation else entries.filter(actor__organisation=reader.organisation_id)


def changes_of(subject_type: str, subject_id: int) -> QuerySet[AuditEntry]:
    return AuditEntry.objects.select_related("actor").filter(subject_type=subject_type, subject_id=str(subject_id))
