"""What a solve includes and leaves out: the choice of a model, sentences and warnings."""
