"""The edges: scene files in, result files out."""
