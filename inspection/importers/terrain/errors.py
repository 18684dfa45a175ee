"""What can be wrong with a terrain file."""


class TerrainFileError(ValueError):
    """The file cannot be taken for a terrain model; the message says why."""
