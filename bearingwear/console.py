"""Text for a terminal: one line, without control characters."""


class UsageError(ValueError):
    """A command that cannot be carried out as it was typed; its text is one line."""


def printable(text: str) -> str:
    """A text whose unprintable characters are question marks."""
    return "".join(c if c.isprintable() else "?" for c in text)


def one_line(text: str) -> str:
    """A text as one printable line."""
    return printable(text) + "\n"
