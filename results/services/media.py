"""Changes of media: review and deletion."""

from django.db import transaction
from django.utils import timezone

from results.models import Evidence, Medium, Observation
from results.services.store import delete_files
from workspace.audit import record_change
from workspace.models import User


def review_medium(*, medium: Medium, actor: User, review: str) -> None:
    """Store that a user has looked at a medium, or, with an empty review, that nobody has."""
    medium.review = review
    medium.reviewed_at = timezone.now() if review else None
    medium.reviewed_by = actor if review else None
    medium.save(update_fields=["review", "reviewed_at", "reviewed_by", "updated_at"])


class IsEvidence(Exception):
    """Raised when a finding refers to a medium."""


def delete_medium(*, medium: Medium, actor: User) -> None:
    """Delete a medium and its files. Raises IsEvidence."""
    with transaction.atomic():
        if Evidence.objects.filter(medium=medium).exists() or Observation.objects.filter(medium=medium).exists():
            raise IsEvidence
        facts = {"file_name": medium.file_name, "sha256": medium.sha256, "size_bytes": medium.size_bytes}
        record_change(
            organisation=medium.organisation, actor=actor, action="delete", subject_type="medium", subject_id=medium.pk, before=facts
        )
        deleted = Medium(organisation_id=medium.organisation_id, sha256=medium.sha256, derivatives=medium.derivatives)
        medium.delete()
        transaction.on_commit(lambda: delete_files(deleted))
