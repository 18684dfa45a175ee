"""Map data pages: HTML shells around a map."""

from typing import Any

from django.conf import settings

from inspection.map_pages import map_page
from workspace.pages import SignedInPage


class GroundPage(SignedInPage):
    """A page of this app. `section` is its entry in the navigation bar, `tab` the one among the pages of that section."""

    section = "assets"
    tab = ""

    def get_context_data(self, **kwargs: Any) -> dict[str, Any]:
        return super().get_context_data(**kwargs) | {"section": self.section, "tab": self.tab}

    def page(self, **kwargs: Any) -> dict[str, Any]:
        return map_page(self.request.user)


class AssetsPage(GroundPage):
    template_name = "assets.html"
    tab = "assets"


class DataIssuesPage(GroundPage):
    template_name = "data_issues.html"
    tab = "data-issues"


class ImportsPage(GroundPage):
    """Imports; with a proposal's id, that proposal is open."""

    template_name = "imports.html"
    tab = "imports"

    def page(self, **kwargs: Any) -> dict[str, Any]:
        proposal = kwargs.get("proposal_id")
        overpass = {"most_km2": settings.OVERPASS_MAX_KM2} if settings.OVERPASS_ADDRESS else None
        return super().page(**kwargs) | {"proposal": str(proposal) if proposal else None, "overpass": overpass}


class TerrainPage(GroundPage):
    template_name = "terrain.html"
    tab = "terrain"


class ZonesPage(GroundPage):
    template_name = "zones.html"
    section = "zones"
