"""Writes of what happens in the air."""

from telemetry.services.ingest import NewRecord, StoredCount, store_records

__all__ = ["NewRecord", "StoredCount", "store_records"]
