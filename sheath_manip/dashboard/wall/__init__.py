"""The wall of moments: what went wrong, nearly went wrong or was marked, worst first."""
