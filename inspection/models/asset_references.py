"""What an organisation's other systems say of the infrastructure, which all organisations share."""

from django.db import models
from django.db.models import Q
from django.db.models.functions import Now

from inspection.models.assets import Asset
from workspace.api.external_data import MAX_EXTERNAL_ID_LENGTH
from workspace.models import Organisation


class AssetReference(models.Model):
    """An organisation's id and attributes of an asset. Beside the asset's row, so that no import touches them and no other organisation
    reads them.
    """

    organisation = models.ForeignKey(Organisation, on_delete=models.CASCADE, related_name="asset_references")
    asset = models.ForeignKey(Asset, on_delete=models.CASCADE, related_name="references")
    external_id = models.CharField(max_length=MAX_EXTERNAL_ID_LENGTH, blank=True, default="", db_default="")
    attributes = models.JSONField(default=dict, db_default={}, blank=True)
    updated_at = models.DateTimeField(auto_now=True, db_default=Now())

    class Meta:
        ordering = ["pk"]
        constraints = [
            models.UniqueConstraint(fields=["organisation", "asset"], name="asset_reference_one_each"),
            models.UniqueConstraint(fields=["organisation", "external_id"], condition=~Q(external_id=""), name="asset_external_id_unique"),
        ]

    def __str__(self) -> str:
        return self.external_id or f"attributes of asset {self.asset_id}"
