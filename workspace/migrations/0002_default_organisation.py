"""Makes the organisation of whoever is not put into another one."""

from django.db import migrations


def make_default(apps, schema_editor):
    apps.get_model("workspace", "Organisation").objects.get_or_create(name="Default")


class Migration(migrations.Migration):
    dependencies = [("workspace", "0001_initial")]
    operations = [migrations.RunPython(make_default, migrations.RunPython.noop)]
