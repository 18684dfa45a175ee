"""Tools for developers: types, texts, icons, code metrics, releases."""
