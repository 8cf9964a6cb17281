"""The classic pipeline as commands: from scans to maps, models, samples and edits."""
