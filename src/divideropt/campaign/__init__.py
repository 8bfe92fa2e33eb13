"""Campaigns: the file, the plan, the run."""
