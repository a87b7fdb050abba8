"""One contact of ball and race: pressure, slip, friction and heat (theory.md sections 1 and 3)."""
