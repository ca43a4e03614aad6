"""E of the parameters that a sample reads, with what it costs on the way."""
import statistics
import time

import numpy

# Upper limit on the cost of reverse-mode differentiation, in units of E itself (Griewank and Walther, Evaluating
# Derivatives, 2008, chapter 3). Our sums make J'J beside the gradient and take some ten times as long, which is not the
# optimiser's fault: the rest is not charged.
GRADIENT_COSTS = 3


class Spent(Exception):
    """The time is over."""


class Counted:
    """E and its derivatives over z = x[observed], or z = log x, for optimisers of any library.

    Keeps the lowest E of all that were asked for, with when: what an optimiser has found counts even
    where it goes on to something higher. Seconds are of the process's clock, less what a gradient
    takes above GRADIENT_COSTS evaluations of E.

    E: trilobe.Objective.
    start: x of the starting point. [n]
    budget: seconds, after which the next evaluation raises Spent.
    logarithmic: z is log x, without bounds; x that are 0 at the start begin at 1e-6.
    """

    def __init__(self, E, start, budget, logarithmic=False):
        self.E, self.base, self.budget, self.logarithmic = E, start.copy(), budget, logarithmic
        self.observed = numpy.flatnonzero(E.observed)
        self.n = len(self.observed)
        z = start[self.observed]
        self.start = numpy.log(numpy.maximum(z, 1e-6)) if logarithmic else z
        self.last = None  # (z, J'J, J'r, E) of the last point
        times = []
        for _ in range(5):
            begin = time.process_time()
            first = E.value(start)
            times.append(time.process_time() - begin)
        self.value_costs = statistics.median(times)
        self.begin, self.not_charged, self.evaluations = time.process_time(), 0.0, 0
        self.lowest, self.trace = numpy.inf, []
        self._record(start, first)

    @property
    def seconds(self):
        """Charged so far."""
        return time.process_time() - self.begin - self.not_charged

    def _x(self, z):
        x = self.base.copy()
        x[self.observed] = numpy.exp(numpy.clip(z, -700, 700)) if self.logarithmic else numpy.maximum(z, 0)
        return x

    def _record(self, x, value):
        if self.seconds > self.budget:
            raise Spent
        if value < self.lowest:
            self.lowest, self.x = value, x
            self.trace.append({"evaluations": self.evaluations, "seconds": self.seconds, "objective": value})

    def value(self, z):
        """E; of what is no number, infinite."""
        self.evaluations += 1
        x = self._x(z)
        value = self.E.value(x) if numpy.isfinite(x).all() else numpy.inf
        self._record(x, value)
        return value

    def value_and_gradient(self, z):
        """E, and dE/dz. [n]"""
        self.evaluations += 1
        x = self._x(z)
        begin = time.process_time()
        value, gradient = self.E.value_and_gradient(x)
        self.not_charged += max(0.0, time.process_time() - begin - GRADIENT_COSTS * self.value_costs)
        self._record(x, value)
        gradient = gradient[self.observed]
        return value, gradient * x[self.observed] if self.logarithmic else gradient

    def equations(self, z):
        """J'J, J'r and E. [n][n], [n]"""
        if self.last is None or not numpy.array_equal(self.last[0], z):
            self.evaluations += 1
            x = self._x(z)
            matrix, right = self.E.normal_equations(x)
            value = self.E.value(x)
            self._record(x, value)
            self.last = (z.copy(), matrix[numpy.ix_(self.observed, self.observed)], right[self.observed], value)
        return self.last[1:]

    def hessian(self, z):
        """d2E/dz2. [n][n]"""
        return self.E.hessian(self._x(z))[numpy.ix_(self.observed, self.observed)]
