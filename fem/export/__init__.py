"""Exports of a finite-element model to other programs."""
