"""No-fly zones as the network sees them: an index of what legs meet, and paths round zones."""
