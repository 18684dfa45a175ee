"""Columns as plain numbers: geometries and datetimes take the most time of a read of many rows."""

from django.db.models import F, FloatField, Func


def longitude() -> Func:
    return Func(F("position"), function="ST_X", output_field=FloatField())


def latitude() -> Func:
    return Func(F("position"), function="ST_Y", output_field=FloatField())


def unix_s(column: str) -> Func:
    """A time in seconds since 1970."""
    return Func(F(column), template="extract(epoch from %(expressions)s)::float8", output_field=FloatField())
