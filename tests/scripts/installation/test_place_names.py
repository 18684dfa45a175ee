"""Natural Earth's populated places are packed for the search: largest first, with names in other languages where they differ."""

import json
from pathlib import Path

from scripts.development.place_names import packed

PLACES = """name,latitude,longitude,pop_max,iso_a2,adm0_a3,ne_id
Village,1.0,-2.341,10,-99,ABC,1
Munich,48.129,11.576,1275000,DE,DEU,2
Pristina,42.67,21.17,465186,-99,KOS,3
"""
NAMES = """NE_ID,NAME_DE,NAME_ES,NAME_FR
2,München,Múnich,Munich
"""


def test_places_are_packed_with_their_names(tmp_path: Path) -> None:
    places, names = tmp_path / "places.csv", tmp_path / "names.csv"
    places.write_text(PLACES, encoding="utf-8")
    names.write_text(NAMES, encoding="utf-8")
    assert json.loads(packed(places, names)) == [
        ["Munich", "München|Múnich|", 1158, 4813, "DE"],
        ["Pristina", "", 2117, 4267, "XK"],
        ["Village", "", -234, 100, ""],
    ]
