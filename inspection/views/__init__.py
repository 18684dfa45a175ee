"""The API's doors to the ground."""
