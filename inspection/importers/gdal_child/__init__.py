"""The program that reads files with GDAL in a process of its own: standard library and libgdal only, so that it starts in 50 ms."""
