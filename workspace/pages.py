"""What every page has: who is there, for the page's script. Everything else on a page comes from the REST API."""

from typing import Any

from django.conf import settings
from django.contrib.auth.mixins import LoginRequiredMixin
from django.views.generic import TemplateView

from workspace.api.signed_in import SignedInPageRequest
from workspace.sessions.browser_sessions import seconds_left


class SignedInPage(LoginRequiredMixin, TemplateView):
    """An HTML shell for somebody who has signed in."""

    request: SignedInPageRequest

    def get_context_data(self, **kwargs: Any) -> dict[str, Any]:
        user = self.request.user
        page = {
            "userId": user.pk, "organisationId": user.organisation_id, "userName": user.username, "role": user.role,
            "canPlan": user.can_plan, "canCurate": user.can_curate,
            "sessionEndsIn_s": seconds_left(self.request.session),
        } | self.page(**kwargs)  # fmt: skip
        return super().get_context_data(**kwargs) | {"page": page}

    def page(self, **kwargs: Any) -> dict[str, Any]:
        """What the page's script must know before its first request."""
        return {}


def raster_maps() -> dict[str, Any]:
    """Addresses of what may lie under the map; empty where there is none."""
    return {
        "baseMap": {"tiles": settings.BASE_MAP_TILES, "attribution": settings.BASE_MAP_ATTRIBUTION},
        "satellite": {"tiles": settings.SATELLITE_TILES, "attribution": settings.SATELLITE_ATTRIBUTION},
    }
