"""Admin pages for map data: curators correct assets and zones here, and see where data comes from."""

from inspection.admin.assets import AssetAdmin
from inspection.admin.incoming import ImportProposalAdmin
from inspection.admin.zones import NoFlyZoneAdmin

__all__ = ["AssetAdmin", "ImportProposalAdmin", "NoFlyZoneAdmin"]
