"""Pack Natural Earth's populated places for the search of the pages: static/data/places.json.

    python -m scripts.development.place_names ne_10m_populated_places_simple.csv ne_50m_populated_places.csv

All places of 1:10m, largest first; those of 1:50m with their names in the languages of the pages. The data are in the public domain.
"""

import argparse
import csv
import json
from pathlib import Path

TARGET = Path(__file__).resolve().parents[2] / "static" / "data" / "places.json"
UNITS_PER_DEG = 100
LANGUAGES = ("DE", "ES", "FR")
NO_CODE = "-99"  # of Natural Earth
KOSOVO = "XK"  # a code that ISO 3166 leaves to users


def packed(places: Path, translated: Path) -> str:
    """Return the places as JSON: [name, "German|Spanish|French" or "", longitude, latitude, country], in hundredths of a degree."""
    names = {row["NE_ID"]: row for row in _rows(translated)}
    rows = sorted(_rows(places), key=lambda row: (-int(float(row["pop_max"])), row["name"]))
    found = [
        [row["name"], _others(row["name"], names.get(row["ne_id"], {})), _units(row["longitude"]), _units(row["latitude"]), _country(row)]
        for row in rows
        if row["name"]
    ]
    return "[\n" + ",\n".join(json.dumps(place, ensure_ascii=False, separators=(",", ":")) for place in found) + "\n]\n"


def _rows(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def _others(name: str, row: dict[str, str]) -> str:
    """Return the names in LANGUAGES, each empty where it is the same."""
    others = [row.get(f"NAME_{language}", "") for language in LANGUAGES]
    stated = [other if other != name else "" for other in others]
    return "|".join(stated) if any(stated) else ""


def _units(degrees: str) -> int:
    return round(float(degrees) * UNITS_PER_DEG)


def _country(row: dict[str, str]) -> str:
    return row["iso_a2"] if row["iso_a2"] != NO_CODE else KOSOVO if row["adm0_a3"] == "KOS" else ""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("places", type=Path)
    parser.add_argument("translated", type=Path)
    options = parser.parse_args()
    TARGET.parent.mkdir(exist_ok=True)
    TARGET.write_text(packed(options.places, options.translated), encoding="utf-8")


if __name__ == "__main__":
    main()
