"""Frees the MAVLink system ids of UAVs that are retired: those that were so before retiring freed them."""

from django.db import migrations


class Migration(migrations.Migration):
    dependencies = [("missions", "0028_credentials_overlap")]

    operations = [
        migrations.RunSQL("UPDATE missions_uav SET mavlink_system_id = NULL WHERE state = 'retired'", migrations.RunSQL.noop),
    ]
