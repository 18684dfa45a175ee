"""Map data: infrastructure, zones, terrain, and the inspection network made of them."""

from inspection import reasons as reasons
