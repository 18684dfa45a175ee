"""Names that Spanwise makes for assets without one ("Tower 18 of 41", "Bridge w42"): read back, in each language of the pages."""

import re
from collections.abc import Collection
from dataclasses import dataclass
from functools import lru_cache

from django.conf import settings
from django.db.models import Q, QuerySet
from django.utils import translation
from django.utils.translation import gettext as _
from django.utils.translation import gettext_noop

from inspection.models import Asset, AssetKind

KIND_WORDS = {
    AssetKind.TOWER: gettext_noop("Tower"),
    AssetKind.LINE: gettext_noop("Line"),
    AssetKind.RAILWAY: gettext_noop("Railway"),
    AssetKind.BRIDGE: gettext_noop("Bridge"),
}
WORDS = {
    "line": gettext_noop("Line"),
    "minor_line": gettext_noop("Line"),
    "cable": gettext_noop("Cable"),
    "pole": gettext_noop("Pole"),
    "portal": gettext_noop("Portal"),
    "tram": gettext_noop("Tramway"),
    "subway": gettext_noop("Subway"),
}
NAMING = ("kind", "subtype", "place_on_line", "places_on_line", "osm_type", "osm_id")
NUMBERED = re.compile(r"(?P<word>\w+) (?P<osm>[nwr])?(?P<number>\d{1,18})", re.IGNORECASE)


@dataclass(frozen=True)
class MadeName:
    """What a made name says: the kind's word in English, and a place on a line, an OSM id ("w", 42), or the asset's own number."""

    word: str
    place: tuple[int, int] | None = None
    osm: tuple[str, int] | None = None
    number: int | None = None

    def filter(self) -> Q:
        """The assets that are called so."""
        subtypes = [subtype for subtype, word in WORDS.items() if word == self.word]
        kinds = [kind for kind, word in KIND_WORDS.items() if word == self.word]
        alike = Q(subtype__in=subtypes) | (Q(kind__in=kinds) & ~Q(subtype__in=list(WORDS)))
        if self.place is not None:
            return alike & Q(ref="", name="", line__isnull=False, place_on_line=self.place[0], places_on_line=self.place[1])
        if self.osm is not None:
            return alike & Q(osm_type=self.osm[0], osm_id=self.osm[1])
        return alike & Q(osm_id=None, pk=self.number)


def word_of(kind: str, subtype: str) -> str:
    """What such an asset is, in one English word, which is translated where it is shown."""
    return WORDS.get(subtype) or KIND_WORDS[AssetKind(kind)]


def assets_with_made_names(assets: QuerySet[Asset], names: Collection[MadeName]) -> dict[MadeName, list[int]]:
    """The primary keys of those of the assets that have these names."""
    places = [name.place for name in names if name.place is not None]
    placed = Q(
        ref="", name="", line__isnull=False, place_on_line__in={at for at, _of in places}, places_on_line__in={of for _at, of in places}
    )
    by_osm = Q(osm_id__in={name.osm[1] for name in names if name.osm is not None})
    by_number = Q(osm_id=None, pk__in={name.number for name in names if name.number is not None})
    found: dict[MadeName, list[int]] = {name: [] for name in names}
    for asset in assets.filter(placed | by_osm | by_number).only(*NAMING).order_by("pk"):
        word = word_of(asset.kind, asset.subtype)
        for name in (
            MadeName(word, place=(asset.place_on_line or 0, asset.places_on_line or 0)),
            MadeName(word, osm=(asset.osm_type, asset.osm_id or 0)),
            MadeName(word, number=asset.pk),
        ):
            if name in found:
                found[name].append(asset.pk)
    return found


def made_name(text: str) -> MadeName | None:
    """Read a made name in any language of the pages; None for a text that is none. Case and double spaces do not matter."""
    plain = " ".join(text.split())
    for words, placed in _languages():
        if (match := placed.fullmatch(plain)) and (word := words.get(match["word"].lower())):
            return MadeName(word, place=(int(match["place"]), int(match["places"])))
        if (match := NUMBERED.fullmatch(plain)) and (word := words.get(match["word"].lower())):
            number = int(match["number"])
            return MadeName(word, osm=(match["osm"].lower(), number)) if match["osm"] else MadeName(word, number=number)
    return None


@lru_cache(maxsize=1)
def _languages() -> list[tuple[dict[str, str], re.Pattern[str]]]:
    """Of each language: its words for kinds, in small letters, with their English; and how a place on a line is said."""
    languages = []
    for code, _name in settings.LANGUAGES:
        with translation.override(code):
            words = {_(word).lower(): word for word in {*KIND_WORDS.values(), *WORDS.values()}}
            said = _("%(kind)s %(place)s of %(places)s") % {"kind": "{kind}", "place": "{place}", "places": "{places}"}
        pattern = re.escape(said).replace(r"\{kind\}", r"(?P<word>\w+)")
        pattern = pattern.replace(r"\{place\}", r"(?P<place>\d{1,6})").replace(r"\{places\}", r"(?P<places>\d{1,6})")
        languages.append((words, re.compile(pattern, re.IGNORECASE)))
    return languages
