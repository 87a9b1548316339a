"""What an experiment costs, and how long it takes on how many cores and devices."""
