"""Links to vehicles: who serves them, what they sent, and what waits for them."""
