"""Query parameters that several endpoints share: a box, kinds, a text."""

from math import isfinite

from django.utils.translation import gettext as _
from drf_spectacular.utils import OpenApiParameter
from rest_framework.request import Request

from inspection.geodesy import LonLat
from inspection.models import AssetKind
from inspection.selectors import Box
from workspace.api.errors import ApiProblem

MAX_TEXT_LENGTH = 100
_LON, _LAT = r"-?(180|(1[0-7][0-9]|[0-9]{1,2})(\.[0-9]+)?)", r"-?(90|[0-8]?[0-9](\.[0-9]+)?)"
LON_LAT = {"type": "string", "pattern": f"^{_LON},{_LAT}$"}
TWO_LON_LATS = {"type": "string", "pattern": f"^{_LON},{_LAT},{_LON},{_LAT}$"}
BOX = OpenApiParameter("bbox", TWO_LON_LATS, description="west,south,east,north in degrees; west > east crosses the 180th meridian")


def invalid(parameter: str, message: str) -> ApiProblem:
    return ApiProblem(400, "invalid", f"{parameter}: {message}", details={parameter: [message]})


def box_of(request: Request) -> Box | None:
    text = request.query_params.get("bbox", "")
    if not text:
        return None
    try:
        west, south, east, north = (float(part) for part in text.split(","))
    except ValueError as error:
        raise invalid("bbox", _("Four numbers are needed: west,south,east,north.")) from error
    if not all(map(isfinite, (west, south, east, north))):
        raise invalid("bbox", _("Four finite numbers are needed."))
    if not (-180 <= west <= 180 and -180 <= east <= 180 and -90 <= south <= north <= 90):
        raise invalid("bbox", _("Longitudes go from -180 to 180, latitudes from -90 to 90, and south is not above north."))
    return west, south, east, north


def positions_of(request: Request, parameter: str, count: int) -> list[LonLat]:
    """Return the positions of a parameter, each as lon,lat. Raises ApiProblem 400."""
    try:
        numbers = [float(part) for part in request.query_params.get(parameter, "").split(",")]
    except ValueError:
        numbers = []
    if len(numbers) != 2 * count:
        asked = ",".join(["lon,lat"] * count)
        raise invalid(parameter, _("%(count)s numbers are needed: %(asked)s.") % {"count": 2 * count, "asked": asked})
    found = [LonLat(*numbers[place : place + 2]) for place in range(0, 2 * count, 2)]
    if not all(-180 <= lon <= 180 and -90 <= lat <= 90 for lon, lat in found):
        raise invalid(parameter, _("Longitude comes first, from -180 to 180, then latitude, from -90 to 90."))
    return found


def kinds_of(request: Request) -> list[AssetKind]:
    try:
        return [AssetKind(kind.strip()) for kind in request.query_params.get("kind", "").split(",") if kind.strip()]
    except ValueError as error:
        raise invalid("kind", _("Known kinds are %(value)s.") % {"value": ", ".join(AssetKind.values)}) from error


def text_of(request: Request) -> str:
    text = request.query_params.get("text", "").strip()
    if len(text) > MAX_TEXT_LENGTH or not text.isprintable():
        raise invalid("text", _("At most %(longest_text)s printable characters.") % {"longest_text": MAX_TEXT_LENGTH})
    return text
