"""Whether a UAV is in flight, by its last report."""

from datetime import timedelta

from django.utils import timezone

from missions.models import Uav
from telemetry.models import UavLink

MAX_SILENCE = timedelta(hours=1)  # no flight lasts longer


def is_in_flight(uav: Uav) -> bool:
    """Return whether the UAV was in the air at its last message within the hour; it may still be."""
    since = timezone.now() - MAX_SILENCE
    return UavLink.objects.filter(uav=uav, is_in_air=True, last_message_at__gte=since).exclude(is_armed=False).exists()
