"""When the sun rises and sets, and civil twilight begins and ends, at a place on a day."""

from collections.abc import Mapping
from datetime import date, timedelta
from functools import lru_cache
from math import degrees

from astral import SunDirection
from astral.julian import julianday, julianday_to_juliancentury
from astral.sun import eq_of_time, hour_angle, sun_declination

DAY_S = 86_400.0
EPOCH = date(1970, 1, 1)
SUNRISE_ZENITH_DEG = 90 + 50 / 60  # 34' of refraction and the sun's radius of 16': U.S. Naval Observatory, "Rise, Set, and Twilight"
TWILIGHT_ZENITH_DEG = 96.0  # the same, civil twilight
FARTHEST_LAT_DEG = 89.8  # nearer to a pole its equations tell nothing
ROUNDS = 3  # the sun moves while one looks for it; the third round changes less than a second below 65 degrees of latitude

_ZENITH_AND_DIRECTION: Mapping[str, tuple[float, SunDirection]] = {
    "BMCT": (TWILIGHT_ZENITH_DEG, SunDirection.RISING),
    "SR": (SUNRISE_ZENITH_DEG, SunDirection.RISING),
    "SS": (SUNRISE_ZENITH_DEG, SunDirection.SETTING),
    "EECT": (TWILIGHT_ZENITH_DEG, SunDirection.SETTING),
}


@lru_cache(maxsize=100_000)
def sun_event_s(event: str, day: int, lon_deg: float, lat_deg: float) -> float | None:
    """Seconds since the epoch of an event (schedule.EVENTS) on a solar day at a place at sea level; None where it does not happen.

    day counts from 1970-01-01 by the place's mean solar time, so that sunrise comes before sunset everywhere. Right within a minute
    below 65 degrees of latitude. Raises KeyError for another event.
    Source: NOAA solar equations as the library astral has them, after J. Meeus, Astronomical Algorithms.
    """
    zenith_deg, direction = _ZENITH_AND_DIRECTION[event]
    latitude = min(max(lat_deg, -FARTHEST_LAT_DEG), FARTHEST_LAT_DEG)
    midnight = julianday(EPOCH + timedelta(days=day))
    minutes = 720.0 - 4.0 * lon_deg
    for _ in range(ROUNDS):
        century = julianday_to_juliancentury(midnight + minutes / 1440.0)
        try:
            angle_deg = degrees(hour_angle(latitude, sun_declination(century), zenith_deg, direction))
        except ValueError:  # its cosine is beyond 1: the sun stays above or below all day
            return None
        minutes = 720.0 - 4.0 * (lon_deg + angle_deg) - eq_of_time(century)
    return day * DAY_S + minutes * 60.0
