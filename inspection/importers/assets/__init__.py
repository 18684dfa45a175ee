"""Asset files in formats other than OpenStreetMap's, as rows of properties with one geometry each; pure Python."""
