"""Labels of models and their fields in the administration of the database: units in brackets, abbreviations in capitals."""

from collections.abc import Iterable

from django.db.models import Field, Model
from django.utils.functional import Promise

UNITS = {
    "m": "m", "m2": "m²", "mps": "m/s", "s": "s", "h": "h", "deg": "°", "percent": "%", "wh": "Wh", "w": "W", "kg": "kg", "v": "V",
    "bytes": "bytes",
}  # fmt: skip
ABBREVIATIONS = {
    word.lower(): word for word in ("UAV", "UAVs", "ID", "IDs", "OSM", "MAVLink", "AGL", "AMSL", "API", "ETag", "GPS")
} | {"sha256": "SHA-256"}  # fmt: skip


def label_of(words: str) -> str:
    """Return "altitude AGL [m]" of "altitude agl m"."""
    *rest, last = words.split(" ")
    unit = UNITS.get(last) if rest else None
    words_shown = [ABBREVIATIONS.get(word.lower(), word) for word in (rest if unit else [*rest, last])]
    return " ".join([*words_shown, f"[{unit}]"] if unit else words_shown)


def label(models: Iterable[type[Model]]) -> None:
    """Set the labels of an app's models and fields outside of migrations; a field with a verbose_name of its own keeps it."""
    for model in models:
        options = model._meta
        options.verbose_name, options.verbose_name_plural = label_of(str(options.verbose_name)), label_of(str(options.verbose_name_plural))
        for field in options.get_fields():
            if not isinstance(field, Field) or isinstance(field.verbose_name, Promise):  # a lazy text has its translation
                continue
            if field.verbose_name == field.name.replace("_", " "):
                field.verbose_name = label_of(str(field.verbose_name))
