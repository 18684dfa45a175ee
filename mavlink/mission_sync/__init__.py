"""State machines that upload mission items, fences and rally points to a vehicle and read them back."""
