"""Tools for developers: types, texts, icons, figures of the code, releases."""
