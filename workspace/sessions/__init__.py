"""Sessions in browsers, and what requests of browsers share: preferences, addresses of visitors, limits on guessing."""
