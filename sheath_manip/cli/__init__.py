"""The command line: one file a verb, and the entry that parses, runs, and words the errors."""
