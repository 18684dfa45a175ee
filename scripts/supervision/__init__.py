"""Programs that run together: how each is started, watched and stopped."""
