"""The parts of the page, one a file; `layout` says which page has which."""
