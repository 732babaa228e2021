"""The command line: words, flags and exit codes; nothing else."""
