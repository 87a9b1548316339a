"""Recorded episodes: the store on disk, its recorder, and the samples taken from them."""
