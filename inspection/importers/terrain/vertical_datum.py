"""From where heights count: the names of vertical datums, and heights above the ellipsoid, which are refused."""

from pyproj import CRS
from pyproj.exceptions import CRSError

from inspection.importers.terrain.errors import TerrainFileError

MAX_NAME_LENGTH = 50
_NAMES = {5773: "EGM96", 5798: "EGM84", 3855: "EGM2008", 5703: "NAVD88", 6360: "NAVD88", 5621: "EVRF2007", 7837: "DHHN2016"}
_NAMES_OF_DATUMS = {5171: "EGM96", 1027: "EGM2008", 5203: "EGM84", 5103: "NAVD88", 5215: "EVRF2007"}
_GEOTIFF_ELLIPSOIDS = range(5001, 5034)  # GeoTIFF 1.0, 6.3.4.1: "VertCS_..._ellipsoid"
_ELLIPSOIDAL_WORDS = ("ellipsoid", "wgs84", "wgs 84", "epsg:4979", "hae")
ELLIPSOIDAL = (
    "The heights are counted from the ellipsoid, which lies up to 100 m above or below sea level. Convert them first: "
    "gdalwarp -s_srs EPSG:4979 -t_srs EPSG:4326+5773"
)


class DatumFault(TerrainFileError):
    """What somebody wrote is no vertical datum that heights can be compared in."""


def datum_named(name: str) -> str:
    """The name as it is stored. Raises DatumFault."""
    name = " ".join(name.split())
    if not name or len(name) > MAX_NAME_LENGTH or not name.isprintable():
        raise DatumFault(f"A vertical datum is a name of 1 to {MAX_NAME_LENGTH} characters, such as EGM96.")
    if any(words in name.lower() for words in _ELLIPSOIDAL_WORDS):
        raise DatumFault(ELLIPSOIDAL)
    return next((known for known in _NAMES.values() if known.lower() == name.lower()), name)


def datum_of_codes(system_code: int, datum_code: int, citation: str) -> str | None:
    """What a GeoTIFF states by VerticalGeoKey, VerticalDatumGeoKey and VerticalCitationGeoKey; None where it states nothing."""
    if system_code in _GEOTIFF_ELLIPSOIDS or "ellipsoid" in citation.lower():
        raise TerrainFileError(ELLIPSOIDAL)
    if system_code in _NAMES:
        return _NAMES[system_code]
    if datum_code in _NAMES_OF_DATUMS:
        return _NAMES_OF_DATUMS[datum_code]
    system = _vertical_system(system_code)
    if system is not None:
        return datum_named(system.name.removesuffix(" height")[:MAX_NAME_LENGTH])
    return datum_named(citation[:MAX_NAME_LENGTH]) if citation else None


def metres_of_unit(code: int, system_code: int) -> float:
    """How many metres one step of the file's heights is. Code 0: not stated."""
    factors = {0: None, 9001: 1.0, 9002: 0.3048, 9003: 1200 / 3937}
    if code not in factors:
        raise TerrainFileError(f"The heights are in a unit that is not known (EPSG:{code}). Convert them to metres first.")
    stated = factors[code]
    if stated is not None:
        return stated
    system = _vertical_system(system_code)
    return float(system.axis_info[0].unit_conversion_factor) if system is not None and system.axis_info else 1.0


def refuse_if_ellipsoidal(system: CRS) -> None:
    """A system with a third axis of its own counts heights from its ellipsoid."""
    if system.is_geographic and len(system.axis_info) == 3:
        raise TerrainFileError(ELLIPSOIDAL)


def _vertical_system(code: int) -> CRS | None:
    if not 1024 <= code < 32767:
        return None
    try:
        system = CRS.from_epsg(code)
    except CRSError:
        return None
    return system if system.is_vertical else None
