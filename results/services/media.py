"""Changes of media: review and deletion."""

from django.db import transaction
from django.utils import timezone

from results.models import Evidence, Medium, Observation
from results.services.store import delete_files
from workspace.audit import record_change
from workspace.models import User


def review_medium(*, medium: Medium, actor: User, review: str) -> None:
    """Store a user's review of a medium; an empty one takes it back."""
    medium.review = review
    medium.reviewed_at = timezone.now() if review else None
    medium.reviewed_by = actor if review else None
    medium.save(update_fields=["review", "reviewed_at", "reviewed_by", "updated_at"])


class IsEvidence(Exception):
    """Raised when a finding refers to a medium."""


def delete_medium(*, medium: Medium, actor: User) -> None:
    """Delete a medium and its files. Raises IsEvidence."""
    with transaction.atomic():
        Medium.objects.select_for_update(of=["self"]).get(pk=medium.pk)  # it may be read at present, which stores previews
        if Evidence.objects.filter(medium=medium).exists() or Observation.objects.filter(medium=medium).exists():
            raise IsEvidence
        facts = {"file_name": medium.file_name, "sha256": medium.sha256, "size_bytes": medium.size_bytes}
        record_change(
            organisation=medium.organisation, actor=actor, action="delete", subject_type="medium", subject_id=medium.pk, before=facts
        )
        organisation, sha256 = medium.organisation_id, medium.sha256
        medium.delete()
        transaction.on_commit(lambda: _delete_files(organisation, sha256))


def _delete_files(organisation: int, sha256: str) -> None:
    """Delete the files of a medium, unless the same file has been sent again meanwhile."""
    if not Medium.objects.filter(organisation=organisation, sha256=sha256).exists():
        delete_files(organisation, sha256)
