"""LeRobot's own policies under this project's gate, measured: run in a venv that has LeRobot."""
