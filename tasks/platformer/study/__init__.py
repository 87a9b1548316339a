"""The platformer as an experiment: its plans, probes, figures and claims."""
