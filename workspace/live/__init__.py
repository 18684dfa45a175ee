"""What the websockets of all apps share: who is there, limits, changes and graceful shutdown."""
