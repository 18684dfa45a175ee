"""The mixed working day: its site, its people's client, its fleet, and what is checked afterwards."""
