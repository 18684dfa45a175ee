"""From an incoming file to a change of the map data: read, show the difference, apply or discard."""
