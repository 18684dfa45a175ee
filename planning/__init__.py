"""From targets, UAVs and map data to checked routes with heights, times and energy. Pure: no Django, no clock, no settings."""

from planning import reasons as reasons
