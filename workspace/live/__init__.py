"""What the websockets of all apps share: authentication, limits, change notifications and graceful shutdown."""
