"""Errors that models raise."""


class NotAvailable(ValueError):
    """The model asked for does not apply to the scene; one line."""
