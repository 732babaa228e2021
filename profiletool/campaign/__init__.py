"""Campaigns: many one-joint runs on processes or a cluster, each finished one kept."""
