"""The pages of findings and of the review of photos: HTML shells, filled by the REST API."""

from typing import Any
from uuid import UUID

from django.http import Http404
from django.shortcuts import get_object_or_404

from inspection.models import Asset
from inspection.selectors import asset_label
from missions.models import Mission
from workspace.pages import SignedInPage


class FindingsPage(SignedInPage):
    """All findings of the organisation."""

    template_name = "findings.html"

    def get_context_data(self, **kwargs: Any) -> dict[str, Any]:
        return super().get_context_data(**kwargs) | {"section": "findings"}


class ReviewPage(SignedInPage):
    """The photos of a mission or of an asset, one at a time."""

    template_name = "review.html"

    def page(self, **kwargs: Any) -> dict[str, Any]:
        return {"subject": self._subject()}

    def _subject(self) -> dict[str, Any]:
        """Return whose photos are reviewed, and the page that this one leads back to; all photos without either."""
        mission_text, asset_text = self.request.GET.get("mission", ""), self.request.GET.get("asset", "")
        if mission_text:
            own = Mission.objects.filter(organisation=self.request.user.organisation_id, deleted_at=None)
            mission = get_object_or_404(own, pk=_uuid(mission_text))
            return {"query": f"mission={mission.pk}", "name": mission.name, "back": f"/missions/{mission.pk}/report"}
        if asset_text:
            is_number = asset_text.isascii() and asset_text.isdigit() and len(asset_text) < 10
            asset = Asset.objects.select_related("line").filter(pk=int(asset_text)).first() if is_number else None
            if asset is None:
                raise Http404
            return {"query": f"asset={asset.pk}", "name": asset_label(asset), "back": "/assets"}
        return {"query": "", "name": "", "back": "/"}


def _uuid(text: str) -> UUID:
    try:
        return UUID(text)
    except ValueError as error:
        raise Http404 from error
