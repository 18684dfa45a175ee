"""Whether a UAV is in the air, by what it reported last."""

from datetime import timedelta

from django.utils import timezone

from missions.models import Uav
from telemetry.models import UavLink

MAX_SILENCE = timedelta(hours=1)  # no flight lasts longer


def is_in_flight(uav: Uav) -> bool:
    """One that was in the air when it was last heard, within the hour, may be so still."""
    since = timezone.now() - MAX_SILENCE
    return UavLink.objects.filter(uav=uav, is_in_air=True, last_message_at__gte=since).exclude(is_armed=False).exists()
