"""What exists on the ground: infrastructure, zones, terrain, and the network made of them."""

from inspection import reasons as reasons
