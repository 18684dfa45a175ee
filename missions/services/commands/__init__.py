"""Commands to UAVs: the outbox, batches, starts, returns and route swaps."""
