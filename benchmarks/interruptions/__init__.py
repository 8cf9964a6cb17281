"""Commands under faults: killed at random moments, on full disks, and on disks of no writing."""
