"""What was changed on the ground, newest first. The ground is shared, so everybody sees all of it."""

from django.db.models import QuerySet

from workspace.models import AuditEntry

NEWEST_FIRST = ("-recorded_at", "-pk")
SUBJECTS = ("asset", "zone")


def changes_of_the_ground(*, subject_type: str = "", actor: str = "") -> QuerySet[AuditEntry]:
    entries = AuditEntry.objects.select_related("actor").filter(subject_type__in=[subject_type] if subject_type else SUBJECTS)
    return entries.filter(actor__username=actor) if actor else entries


def changes_of(subject_type: str, subject_id: int) -> QuerySet[AuditEntry]:
    return AuditEntry.objects.select_related("actor").filter(subject_type=subject_type, subject_id=str(subject_id))
