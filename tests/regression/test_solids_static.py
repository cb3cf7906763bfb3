"""Static bodies: load steps without inertia against closed forms; what nothing holds is refused."""

import numpy as np
import pytest
from scipy.optimize import brentq
