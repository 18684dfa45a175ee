"""What UAVs meet if they return or land now, and how they return safely."""
