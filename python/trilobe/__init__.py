"""Multi-lobe non-parametric microfacet models of measured BRDFs.

    brdf = trilobe.load("model.json")
    f = brdf.eval(wi, wo)                     # [1/sr], without a cosine
    wo, pdf, weight = brdf.sample(wi, u)

docs/python.md of the project has a tour, and the conventions.
"""

from trilobe._brdf import Brdf, Sample, load
from trilobe._core import Error
from trilobe._table import Table

__all__ = ["Brdf", "Error", "Sample", "Table", "load"]
__version__ = "0.1.0"

Error.__module__ = "trilobe"
