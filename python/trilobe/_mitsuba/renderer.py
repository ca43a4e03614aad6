"""Mitsuba and Dr.Jit of whatever variant is set, whereas their stubs know the types of one."""

from typing import Any

import drjit
import mitsuba

dr: Any = drjit
mi: Any = mitsuba
