"""The verdict on a design: reasons, notes, and what of the profile is missed."""
