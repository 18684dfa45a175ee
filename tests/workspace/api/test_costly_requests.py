"""What costs much is counted per user, each kind for itself."""

import pytest

from tests.accounts.users import a_user, client_of
from tests.workspace.counters import forget_counts
from workspace.api.throttling import ScopedRate

pytestmark = pytest.mark.django_db

MISSION = "11111111-1111-4111-8111-111111111111"  # of nobody
COSTLY = {
    "exports": [
        f"/api/v1/missions/{MISSION}/record.zip",
        f"/api/v1/missions/{MISSION}/telemetry.csv",
        "/api/v1/uavs/1/telemetry.gpx",
        "/api/v1/uavs/1/flight-logs/1/file",
    ],
    "scene": ["/api/v1/scene?bbox=7,50,7.01,50.01"],
    "tiles": ["/api/v1/tiles/10/530/340"],
}


@pytest.mark.parametrize(("scope", "path"), [(scope, path) for scope, paths in COSTLY.items() for path in paths])
def test_a_user_who_asks_for_too_much_is_refused_and_another_is_not(scope: str, path: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ScopedRate, "THROTTLE_RATES", {name: "2/hour" if name == scope else None for name in COSTLY})
    forget_counts()
    client = client_of(a_user())
    statuses = [client.get(path).status_code for _ in range(4)]
    assert 429 not in statuses[:2]
    assert statuses[2:] == [429, 429]
    assert client_of(a_user()).get(path).status_code != 429
