"""Applications, a folder each, as `bearingwear.application` finds them."""
