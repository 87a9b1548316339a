"""Driving on a closed track among slower cars."""
