"""The correction of a chosen design on a forward model, in numbers that can be built."""
