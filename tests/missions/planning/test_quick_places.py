"""Whole towers and bridges are read by a short way of their own: it must find what the long way finds."""

from unittest import mock

import pytest

from inspection.models import Asset, AssetKind
from missions.selectors.resolved_targets import resolved_targets
from missions.services import TargetRequest
from tests.missions.worlds import world

pytestmark = pytest.mark.django_db


def test_the_short_way_finds_what_the_long_way_finds() -> None:
    here = world()
    for number, tower in enumerate(here.towers):
        Asset.objects.filter(pk=tower.pk).update(
            height_m=31.5 + number,
            ref=str(number),
            name=f"Tower {number}",
            operator="Grid",
            max_voltage_v=380_000,
            place_on_line=number + 1,
            places_on_line=40,
        )
    assets = Asset.objects.filter(kind__in=(AssetKind.TOWER, AssetKind.BRIDGE))
    targets = [TargetRequest(pk) for pk in assets.values_list("pk", flat=True)]
    assert len(targets) > 3
    quick = resolved_targets(targets)
    with mock.patch("missions.selectors.resolved_targets._whole_towers_and_bridges", return_value=None):
        slow = resolved_targets(targets)
    assert slow == quick
    assert [place.label for place in slow[0]] == [place.label for place in quick[0]]
    assert {place.height_m for place in quick[0]} >= {31.5, 32.5}
