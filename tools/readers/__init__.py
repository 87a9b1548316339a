"""Scripts for the venvs of `tools.foreign_readers`: other projects' loaders and nothing of ours."""
