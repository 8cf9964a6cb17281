"""The command line: flags, help and examples of the verbs. Nothing here is slow to import."""
