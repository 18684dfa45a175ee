"""Query parameters of the registers of assets and zones."""

from django.utils.translation import gettext as _
from drf_spectacular.utils import OpenApiParameter
from rest_framework.request import Request

from inspection.models import AssetKind
from inspection.selectors.register.assets import ASSET_ORDERS, AssetFilter
from inspection.selectors.register.zones import ZONE_ORDERS, ZoneFilter
from inspection.serializers.edits import HIGHEST_VOLTAGE_V, MAX_VOLTAGES
from inspection.views.parameters import BOX, box_of, invalid, kinds_of, text_of
from workspace.api.external_data import EXTERNAL_ID, asked_external_id
from workspace.api.paging import asked_flag, asked_instant
from workspace.api.schema import DAY_OR_TIME, several_of
from workspace.api.signed_in import SignedInRequest
from workspace.api.whole_numbers import WholeNumber

MAX_WORDS_LENGTH = 255
LINE = WholeNumber("line", "the id of a power line: its supports")
REGION = WholeNumber("region", "the id of a region: what imports brought into it")
VOLTAGE = WholeNumber(
    "voltage_v", "volts of the asset, or of its line where it states none", maximum=HIGHEST_VOLTAGE_V, max_values=MAX_VOLTAGES
)
ASSET_SORTS = (*ASSET_ORDERS, *(f"-{name}" for name in ASSET_ORDERS))
ASSET_SORT = OpenApiParameter("sort", str, enum=ASSET_SORTS, description='by this fact; "-" before it: the largest, last or newest first')
ASSET_FILTERS = [
    BOX,
    OpenApiParameter("kind", several_of(AssetKind.values), description=f"one or several of {', '.join(AssetKind.values)}, with commas"),
    OpenApiParameter("text", str, description='words in name, ref or operator; "138 kV"; an OSM id such as w123; best first'),
    OpenApiParameter("flyable", bool, description="true: only what may be flown to"),
    VOLTAGE.documented,
    OpenApiParameter("operator", str, description="of the asset, or of its line where it states none"),
    LINE.documented,
    REGION.documented,
    OpenApiParameter("inspected", bool, description="false: only what an aircraft of your organisation has never inspected"),
    OpenApiParameter("inspected_from", DAY_OR_TIME, description="inspected last at this time or later"),
    OpenApiParameter("inspected_before", DAY_OR_TIME, description="inspected last before this time"),
    EXTERNAL_ID,
]


def asset_filter(request: SignedInRequest) -> AssetFilter:
    """Return the filter of a request. Raises ApiProblem 400."""
    return AssetFilter(
        organisation_id=request.user.organisation_id,
        box=box_of(request),
        kinds=tuple(kinds_of(request)),
        text=text_of(request),
        flyable=True if asked_flag(request, "flyable") else None,
        external_id=asked_external_id(request),
        voltages_v=tuple(VOLTAGE.all_asked(request)),
        operator=_words(request, "operator"),
        line=LINE.asked(request),
        region=REGION.asked(request),
        inspected=asked_flag(request, "inspected"),
        inspected_from=asked_instant(request, "inspected_from"),
        inspected_before=asked_instant(request, "inspected_before"),
    )


ZONE_SET = WholeNumber("zone_set", "the id of a set")
ZONE_SORTS = (*ZONE_ORDERS, *(f"-{name}" for name in ZONE_ORDERS))
ZONE_SORT = OpenApiParameter("sort", str, enum=ZONE_SORTS, description='by this fact; "-" before it: the last, highest or newest first')
ZONE_FILTERS = [
    BOX,
    OpenApiParameter("text", str, description="words in name, identifier, restriction or reason"),
    ZONE_SET.documented,
    OpenApiParameter("restriction", str, description="as the source writes it; `not_stated`"),
    OpenApiParameter("reason", str, description="one of its reasons, as the source writes it; `not_stated`"),
    OpenApiParameter("active_at", DAY_OR_TIME, description="only zones that apply at this time"),
]


def zone_filter(request: Request) -> ZoneFilter:
    """Return the filter of a request. Raises ApiProblem 400."""
    return ZoneFilter(
        box=box_of(request),
        text=text_of(request),
        zone_set=ZONE_SET.asked(request),
        restriction=_words(request, "restriction"),
        reason=_words(request, "reason"),
        active_at=asked_instant(request, "active_at"),
    )


def _words(request: Request, name: str) -> str:
    text = request.query_params.get(name, "")
    if len(text) > MAX_WORDS_LENGTH or "\0" in text:
        raise invalid(name, _("At most %(most)s printable characters.") % {"most": MAX_WORDS_LENGTH})
    return text
