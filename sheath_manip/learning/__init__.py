"""Rounds of learning from an expert: policy and gate fitted, driven, aggregated, measured."""
