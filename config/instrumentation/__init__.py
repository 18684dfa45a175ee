"""How programs count and time what they do: requests, tasks, system metrics."""
