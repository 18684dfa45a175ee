"""What a second of alerts costs: looks at 200 UAVs in the air, with zones, links, commands and energy, and some alerts open.

python -m benchmarks.telemetry.alert_polls [UAVs]     needs an empty database of its own (DATABASE_URL); everything is rolled back
"""

import copy
import os
import resource
import sys
import time
from datetime import UTC, datetime, timedelta

import django

os.environ.setdefault("DJANGO_SETTINGS_MODULE", "config.settings")
django.setup()

from django.db import connection, transaction  # noqa: E402
from django.test.utils import CaptureQueriesContext  # noqa: E402

from mavlink.decoding.measurement import Measurement  # noqa: E402
from missions.models import Approval, Mission  # noqa: E402
from missions.services.approval.document import content_sha256  # noqa: E402
from telemetry.alerting.detector_input import WatchedUav  # noqa: E402
from telemetry.estimation.report import Report  # noqa: E402
from telemetry.models import Alert, UavLink  # noqa: E402
from telemetry.services.alerts.alerting import DetectorStates, poll_alerts  # noqa: E402
from tests.inspection.ground import zone  # noqa: E402
from tests.missions.flights import an_operator, approved, fleet  # noqa: E402
from tests.missions.worlds import world  # noqa: E402

SECONDS, WARM = 30, 5
ZONES = 500
EACH_MANUALLY = 20  # flown by others: an alert each


def main(count: int) -> None:
    with transaction.atomic():
        uavs = fleet(*(f"UAV {number:03}" for number in range(count)))
        mission, approval = approved(an_operator(), uavs[:1], world().towers[:2])
        document = copy.deepcopy(approval.document)
        document["routes"] = [document["routes"][0] | {"uav": uav.pk, "place": place} for place, uav in enumerate(uavs)]
        Approval.objects.filter(pk=approval.pk).update(document=document, content_sha256=content_sha256(document))
        Mission.objects.filter(pk=mission.pk).update(state="active")
        flight = document["routes"][0]["flights"][0]
        loaded = {"loaded_approval": approval.pk, "loaded_flight": 1, "loaded_sha256": flight["content_sha256"], "autopilot": "px4"}
        UavLink.objects.bulk_create(UavLink(uav=uav, **loaded) for uav in uavs)
        for number in range(ZONES):
            zone((5.0 + 0.05 * (number % 50), 50.0 + 0.05 * (number // 50)), name=f"zone {number}")
        zone((10.0, 57.0), 0.5, name="near")
        waypoints = document["routes"][0]["route"]["waypoints"]
        detector_states, begun = DetectorStates(), datetime(2026, 11, 22, 12, tzinfo=UTC)
        spent_s, queries = [], 0
        for second in range(WARM + SECONDS):
            now = begun + timedelta(seconds=second)
            UavLink.objects.update(last_message_at=now)
            watched = [_watched(uav, number, mission, approval, waypoints, second, now) for number, uav in enumerate(uavs)]
            with CaptureQueriesContext(connection) as seen:
                before_s, cpu_s = time.perf_counter(), _cpu_s()
                poll_alerts(watched=watched, now=now, detector_states=detector_states)
                spent_s.append((_cpu_s() - cpu_s, time.perf_counter() - before_s))
            queries = max(queries, len(seen)) if second >= WARM else 0
        cpu, wall = (sorted(column) for column in zip(*spent_s[WARM:], strict=True))
        print(f"{count} UAVs, {ZONES + 1} zones, {Alert.objects.filter(closed_at=None).count()} alerts open")
        print(f"a look: CPU median {1000 * cpu[len(cpu) // 2]:.0f} ms, most {1000 * cpu[-1]:.0f} ms; "
              f"wall median {1000 * wall[len(wall) // 2]:.0f} ms; at most {queries} statements")  # fmt: skip
        transaction.set_rollback(True)


def _watched(uav, number, mission, approval, waypoints, second, now) -> WatchedUav:
    """Somewhere on the first leg, 12 m/s on."""
    first, then = waypoints[0], waypoints[1]
    share = min(1.0, (second * 12.0 + number) / 500.0)
    lon, lat = (here + share * (there - here) for here, there in zip(first["position"], then["position"], strict=True))
    reported = Measurement(
        longitude_deg=lon, latitude_deg=lat,
        altitude_relative_m=first["altitude_relative_m"], altitude_amsl_m=200.0 + 100.0 * number, velocity_north_mps=8.0,
        velocity_east_mps=8.0, velocity_down_mps=0.0, battery_percent=90.0,
        mode="POSCTL" if number % EACH_MANUALLY == 0 else "MISSION", is_armed=True, is_in_air=True, gps_fix=3,
        satellites=14, hdop=0.8, waypoint_sequence=1, mission_item=2, wind_north_mps=2.0, wind_east_mps=1.0,
    )  # fmt: skip
    return WatchedUav(
        uav.pk, uav.organisation_id, uav.name, mission.pk, approval.pk, newest=Report(now.timestamp(), now.timestamp(), reported)
    )


def _cpu_s() -> float:
    used = resource.getrusage(resource.RUSAGE_SELF)
    return used.ru_utime + used.ru_stime


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 200)
