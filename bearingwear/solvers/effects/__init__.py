"""Included and neglected effects of a solve: the choice of a model, sentences and warnings."""
