"""Files about assets that are not OpenStreetMap's, as rows of properties and one geometry each; pure Python."""
