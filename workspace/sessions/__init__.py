"""Browser sessions, and what requests of browsers share: preferences, client addresses, limits on password guessing."""
