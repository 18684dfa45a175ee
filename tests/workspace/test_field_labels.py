"""Labels in the administration of the database."""

import pytest

from missions.models import Uav, UavType, Waypoint
from workspace.admin_pages.field_labels import label_of
from workspace.models import ApiToken


@pytest.mark.parametrize(
    ("words", "label"),
    [
        ("altitude agl m", "altitude AGL [m]"),
        ("cruise speed mps", "cruise speed [m/s]"),
        ("mavlink system id", "MAVLink system ID"),
        ("rotor disk m2", "rotor disk [m²]"),
        ("node osm ids", "node OSM IDs"),
        ("no-fly zone", "no-fly zone"),
        ("h", "h"),
    ],
)
def test_units_stand_in_brackets_and_abbreviations_in_capitals(words: str, label: str) -> None:
    assert label_of(words) == label


def test_models_and_fields_have_such_labels() -> None:
    assert Uav._meta.get_field("battery_wh").verbose_name == "battery [Wh]"
    assert UavType._meta.get_field("hover_power_w").verbose_name == "hover power [W]"
    assert Waypoint._meta.get_field("altitude_amsl_m").verbose_name == "altitude AMSL [m]"
    assert ApiToken._meta.verbose_name_plural == "API tokens"
