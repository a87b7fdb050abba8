"""`python -m bearingwear`."""

import sys

from bearingwear.cli import main

sys.exit(main())
