"""Geometry and time columns as plain numbers, which are faster to read in many rows."""

from django.db.models import F, FloatField, Func


def longitude() -> Func:
    return Func(F("position"), function="ST_X", output_field=FloatField())


def latitude() -> Func:
    return Func(F("position"), function="ST_Y", output_field=FloatField())


def unix_s(column: str) -> Func:
    """Return a time column as Unix seconds."""
    return Func(F(column), template="extract(epoch from %(expressions)s)::float8", output_field=FloatField())
