"""The widgets of the page, one a file; `layout` says which page has which."""
