"""The mypy plugin of django-stubs with one fix: it typed a foreign key with a default as nullable."""

from django.db.models import Field, ForeignKey, ForeignObjectRel
from mypy.options import Options
from mypy_django_plugin.django.context import DjangoContext
from mypy_django_plugin.main import NewSemanalDjangoPlugin


class Context(DjangoContext):
    def get_field_nullability(self, field: Field | ForeignObjectRel, method: str | None) -> bool:
        """Return whether `row.field_id` may be None; of a method's argument, whether None may be passed."""
        if method is None and isinstance(field, ForeignKey):
            return field.null
        return super().get_field_nullability(field, method)


class Plugin(NewSemanalDjangoPlugin):
    def __init__(self, options: Options) -> None:
        super().__init__(options)
        self.django_context = Context(self.plugin_config.django_settings_module)


def plugin(version: str) -> type[Plugin]:
    return Plugin
