"""Cutting a printed circle out of a sheet of gauze that is held by clips."""
