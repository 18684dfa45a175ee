"""Services of telemetry."""

from telemetry.services.ingest import NewRecord, StoredCount, store_records
from telemetry.services.retention import forget_old_telemetry

__all__ = ["NewRecord", "StoredCount", "forget_old_telemetry", "store_records"]
