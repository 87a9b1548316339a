"""One dm_control task a folder, each runnable as a script."""
