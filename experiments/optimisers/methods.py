"""Optimisers of SciPy, NLopt and Ipopt, and Adam, each as its manual has it: NAME(counted) minimises.

Each goes on until its own test of convergence or counted.Spent; the lowest E on the way counts.
"""
import numpy
import scipy.linalg
import scipy.optimize

LOGARITHMIC = {"lbfgsb_log", "adam"}
BOUNDS = (0, numpy.inf)


def _scipy(counted, method, **options):
    bounds = None if counted.logarithmic else [BOUNDS] * counted.n
    scipy.optimize.minimize(counted.value_and_gradient, counted.start, jac=True, method=method, bounds=bounds,
                            options=options)


def lbfgsb(counted):
    """SciPy's L-BFGS-B (Byrd, Lu, Nocedal and Zhu 1995), 30 corrections."""
    _scipy(counted, "L-BFGS-B", maxcor=30, maxiter=10**7, maxfun=10**7, ftol=0, gtol=0)


def lbfgsb_log(counted):
    """The same over log x."""
    lbfgsb(counted)


def tnc(counted):
    """SciPy's truncated Newton method (Nash 1984)."""
    _scipy(counted, "TNC", maxfun=10**7, ftol=0, xtol=0, gtol=0)


class _Condensed:
    """Residuals r^ with |r^|^2 = E, r^'dr^/dx = J'r and dr^/dx'dr^/dx = J'J: n + 1 in the place of all.

    With the Cholesky factor J'J = R'R they are R^-T J'r and sqrt(E - |R^-T J'r|^2), and [R; 0] stands for their
    derivatives.
    """

    def __init__(self, counted):
        self.counted = counted

    def residuals(self, z):
        """[n + 1]"""
        return self._of(z)[0]

    def jacobian(self, z):
        """[n + 1][n]"""
        return self._of(z)[1]

    def _of(self, z):
        matrix, right, value = self.counted.equations(z)
        ridge = 1e-12 * numpy.trace(matrix) / len(matrix)
        R = scipy.linalg.cholesky(matrix + ridge * numpy.eye(len(matrix)))
        head = scipy.linalg.solve_triangular(R, right, trans="T")
        return (numpy.append(head, numpy.sqrt(max(0.0, value - head @ head))),
                numpy.vstack([R, numpy.zeros(len(R))]))


def _least_squares(counted, method, **options):
    condensed = _Condensed(counted)
    scipy.optimize.least_squares(condensed.residuals, counted.start, condensed.jacobian, bounds=BOUNDS, method=method,
                                 ftol=None, xtol=1e-15, gtol=None, max_nfev=10**6, **options)


def trf(counted):
    """SciPy's trust region reflective (Branch, Coleman and Li 1999), on condensed residuals."""
    _least_squares(counted, "trf", x_scale="jac", tr_solver="exact")


def dogbox(counted):
    """SciPy's rectangular dogleg (Voglis and Lagaris 2004), on condensed residuals."""
    _least_squares(counted, "dogbox", x_scale="jac", tr_solver="exact")


def _nlopt(counted, algorithm):
    import nlopt

    def asked(z, gradient):
        if not gradient.size:
            return counted.value(z)
        value, gradient[:] = counted.value_and_gradient(z)
        return value

    optimiser = nlopt.opt(getattr(nlopt, algorithm), counted.n)
    optimiser.set_lower_bounds(numpy.zeros(counted.n))
    optimiser.set_min_objective(asked)
    optimiser.optimize(counted.start)


def mma(counted):
    """NLopt's method of moving asymptotes (Svanberg 2002)."""
    _nlopt(counted, "LD_MMA")


def ccsaq(counted):
    """NLopt's conservative convex separable approximation with quadratic penalties (Svanberg 2002)."""
    _nlopt(counted, "LD_CCSAQ")


def slsqp(counted):
    """NLopt's sequential quadratic programming (Kraft 1994)."""
    _nlopt(counted, "LD_SLSQP")


def tnewton(counted):
    """NLopt's truncated Newton method with preconditioning and restarts (Dembo and Steihaug 1983)."""
    _nlopt(counted, "LD_TNEWTON_PRECOND_RESTART")


def _ipopt(counted, hessian, **options):
    import ipyopt

    lower = numpy.tril_indices(counted.n)
    empty = (numpy.empty(0, dtype=numpy.int64),) * 2
    none = numpy.empty(0)

    def gradient(z, out):
        out[:] = counted.value_and_gradient(z)[1]

    def second(z, _, factor, out):
        out[:] = factor * hessian(z)[lower]

    ipyopt.Problem(
        counted.n, numpy.zeros(counted.n), numpy.full(counted.n, 1e20), 0, none, none, empty, lower,
        counted.value, gradient, lambda z, out: None, lambda z, out: None, second if hessian else None,
        ipopt_options={"print_level": 0, "sb": "yes", "max_iter": 10**6, "tol": 1e-14, **options},
    ).solve(counted.start.copy())


def ipopt(counted):
    """Ipopt (Waechter and Biegler 2006) with the exact Hessian. Adaptive barriers ended higher."""
    _ipopt(counted, counted.hessian, mu_strategy="monotone", mu_init=1e-3)


def ipopt_gauss_newton(counted):
    """Ipopt with 2 J'J for the Hessian, and a barrier that is small from the start."""
    _ipopt(counted, lambda z: 2 * counted.equations(z)[0], mu_strategy="monotone", mu_init=1e-6)


def ipopt_lbfgs(counted):
    """Ipopt with limited-memory BFGS."""
    _ipopt(counted, None, hessian_approximation="limited-memory", limited_memory_max_history=30)


ADAM_STEPS = (0.03, 0.01, 0.003)  # a third of the time each, from the lowest E so far


def adam(counted):
    """Adam (Kingma and Ba 2015) over log x, with steps that get shorter as those of people who train networks do."""
    z, share = counted.start.copy(), counted.budget / len(ADAM_STEPS)
    for stage, step in enumerate(ADAM_STEPS):
        if stage:
            z = numpy.log(numpy.maximum(counted.x[counted.observed], 1e-300))
        first, second, k = numpy.zeros(counted.n), numpy.zeros(counted.n), 0
        while stage == len(ADAM_STEPS) - 1 or counted.seconds < (stage + 1) * share:
            k += 1
            _, gradient = counted.value_and_gradient(z)
            first += 0.1 * (gradient - first)
            second += 0.001 * (gradient**2 - second)
            z = z - step * (first / (1 - 0.9**k)) / (numpy.sqrt(second / (1 - 0.999**k)) + 1e-12)


METHODS = {function.__name__: function for function in (
    lbfgsb, lbfgsb_log, tnc, trf, dogbox, mma, ccsaq, slsqp, tnewton, ipopt, ipopt_gauss_newton,
    ipopt_lbfgs, adam)}
