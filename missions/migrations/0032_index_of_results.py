"""Lists what came of targets over all missions, the newest first."""

from django.contrib.postgres.operations import AddIndexConcurrently
from django.db import migrations, models
from django.db.models import Q


class Migration(migrations.Migration):
    atomic = False
    dependencies = [("missions", "0031_external_id_indexes")]

    operations = [
        AddIndexConcurrently(
            "inspectiontarget",
            models.Index(fields=["-state_at", "-id"], condition=Q(state_at__isnull=False), name="target_state_at_idx"),
        ),
    ]
