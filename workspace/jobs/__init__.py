"""Jobs from request to result: rows, queue, progress and endpoints."""
