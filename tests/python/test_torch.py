"""`trilobe.torch`: values are C++'s, gradients those of finite differences."""

import math
import subprocess
import sys

import numpy as np
import pytest

import trilobe

from models import anisotropic, directions, independent, isotropic, lambertian, stretched

torch = pytest.importorskip("torch", reason="PyTorch is not installed: pip install torch")

MODELS = {"isotropic": isotropic, "stretched": stretched, "lambertian": lambertian, "independent": independent,
          "anisotropic": anisotropic}
# Directions where splines and arcs end, too.
EDGES = np.array([[0, 0, 1], [1, 0, 1e-3], [0.6, 0, 0.8], [-0.6, 0, 0.8], [0.1, 0.2, -0.5], [0, 0, 0]])


@pytest.mark.parametrize("name", MODELS)
def test_values_are_those_of_the_library(name):
    brdf = MODELS[name]()
    wi, wo = (np.concatenate([directions(3000, seed), edges]) for seed, edges in ((1, EDGES), (2, EDGES[::-1])))
    wi[:500] *= 3  # any length will do
    ours = trilobe.torch.eval(brdf, torch.tensor(wi), torch.tensor(wo)).numpy()
    np.testing.assert_allclose(ours, brdf.eval(wi, wo), rtol=1e-6, atol=1e-9)
    wi, wo = directions(40, 3)[:, None], directions(50, 4)
    ours = trilobe.torch.Model(brdf)(torch.tensor(wi), torch.tensor(wo)).detach().numpy()
    np.testing.assert_allclose(ours, brdf.eval(wi, wo), rtol=1e-6, atol=1e-9)


@pytest.mark.parametrize("name", [*trilobe.materials()[:3], "linen"])
def test_values_of_materials(name):
    brdf = trilobe.load(f"material:{name}")
    wi, wo = directions(2000, 1), directions(2000, 2)
    ours = trilobe.torch.eval(brdf, torch.tensor(wi), torch.tensor(wo)).numpy()
    np.testing.assert_allclose(ours, brdf.eval(wi, wo), rtol=1e-6, atol=1e-9)


@pytest.mark.parametrize("name", MODELS)
def test_gradients_are_finite_differences(name):
    model = trilobe.torch.Model(MODELS[name]())
    wi, wo = (torch.tensor(directions(6, seed), requires_grad=True) for seed in (5, 6))
    torch.autograd.gradcheck(lambda *w: model(*w), (wi, wo), eps=1e-7, atol=1e-4, rtol=1e-3)
    if name == "lambertian":
        return

    def of_tables(*parts):
        return trilobe.torch.eval(model._form, wi.detach(), wo.detach(), **dict(zip("dsDFG", parts)))

    parts = tuple(getattr(model, part).detach().clone().requires_grad_() for part in "dsDFG")
    torch.autograd.gradcheck(of_tables, parts, eps=1e-6, atol=1e-6, rtol=1e-5, fast_mode=True)


def test_gradients_are_finite_at_the_edges():
    for make in MODELS.values():
        model = trilobe.torch.Model(make())
        wi, wo = (torch.tensor(edges.copy(), requires_grad=True) for edges in (EDGES, EDGES[::-1]))
        model(wi[:, None], wo).sum().backward()
        gradients = [tensor.grad for tensor in (wi, wo, *model.parameters()) if tensor.grad is not None]
        assert gradients and all(torch.isfinite(gradient).all() for gradient in gradients)


def test_texels_have_models_of_their_own():
    brdf = isotropic(entries=12)
    model = trilobe.torch.Model(brdf, texels=4, shared="DFG")
    assert model.s.shape == (4, 3, 3) and model.D.shape == (3, 12)
    with torch.no_grad():
        model.s *= torch.arange(1.0, 5.0, dtype=torch.float64)[:, None, None]
    wi, wo = directions(4 * 7, 1).reshape(4, 7, 3), directions(4 * 7, 2).reshape(4, 7, 3)
    value = model(torch.tensor(wi), torch.tensor(wo)).detach().numpy()
    for texel in range(4):
        alone = brdf.replace(s=brdf.s * (texel + 1))
        np.testing.assert_allclose(value[texel], alone.eval(wi[texel], wo[texel]), rtol=1e-6)
        assert model.brdf(texel) == alone
    with pytest.raises(trilobe.Error, match="give its number"):
        model.brdf()


def test_recovers_tables():
    """Adam on the parameters finds the values of another model."""
    truth, start = isotropic(entries=12), isotropic(entries=12)
    model = trilobe.torch.Model(start.replace(s=start.s * 0.5, d=[0.3, 0.3, 0.3]))
    wi, wo = (torch.tensor(directions(500, seed)) for seed in (1, 2))
    wanted = torch.tensor(truth.eval(wi.numpy(), wo.numpy()))

    def loss():
        return (torch.log1p(model(wi, wo)) - torch.log1p(wanted)).square().mean()

    first = loss().item()
    adam = torch.optim.Adam(model.parameters(), lr=0.02)
    for _ in range(150):
        adam.zero_grad()
        loss().backward()
        adam.step()
        model.project()
    assert loss().item() < 0.01 * first
    assert model.brdf().lobes == 3


def test_says_what_is_wrong():
    brdf, w = isotropic(), torch.tensor([[0.0, 0.0, 1.0]])
    with pytest.raises(trilobe.Error, match="there is no E; there are"):
        trilobe.torch.eval(brdf, w, w, E=w)
    with pytest.raises(trilobe.Error, match=r"D has the shape \(2, 2\)"):
        trilobe.torch.eval(brdf, w, w, D=torch.ones(2, 2))
    with pytest.raises(trilobe.Error, match="there are 5 texels"):
        trilobe.torch.eval(brdf, w, w, d=torch.ones(5, 3))


def test_what_is_no_direction_is_nan_as_in_eval():
    brdf, up = isotropic(), [0.0, 0.0, 1.0]
    wi = torch.tensor([up, [0, 0, 0], [math.nan, 0, 1], [0, 0, math.inf], [0, 0, -1], [1e-30, 0, 1e-30]],
                      requires_grad=True)
    s = torch.tensor(np.asarray(brdf.s), dtype=torch.float32, requires_grad=True)
    f = trilobe.torch.eval(brdf, wi, torch.tensor(up), s=s)
    np.testing.assert_allclose(f.detach().numpy(), brdf.eval(wi.detach().numpy(), np.float32(up)), rtol=1e-4)
    assert f.isnan()[:, 0].tolist() == [False, True, True, True, False, False]
    f[[0, 4, 5]].sum().backward()
    assert s.grad.isfinite().all()


def test_directions_of_any_real_numbers():
    brdf = isotropic()
    for wi, wo in (([0, 0, 1], [0.0, 0.6, 0.8]), ([0.0, 0.6, 0.8], [0, 0, 1]), ([0, 0, 1], [0, 1, 1])):
        f = trilobe.torch.eval(brdf, torch.tensor(wi), torch.tensor(wo))
        assert f.dtype == torch.float32
        np.testing.assert_allclose(f.numpy(), brdf.eval(wi, wo), rtol=1e-5)


@pytest.mark.parametrize(("ask", "told"), [
    (lambda w: trilobe.torch.eval(isotropic(), w + 0j, w), "wi has the dtype torch.complex64"),
    (lambda w: trilobe.torch.Model(3), r"must be a trilobe\.Brdf"),
    (lambda w: trilobe.torch.eval("model.json", w, w), r"must be a trilobe\.Brdf"),
    (lambda w: trilobe.torch.Model(isotropic(), texels=0), "texels must be an integer from 1"),
    (lambda w: trilobe.torch.Model(isotropic(), dtype=torch.int8), "dtype must be one of PyTorch's for real numbers"),
    (lambda w: trilobe.torch.Model(isotropic(), shared="ABC"), "shared must name some of d, s, D, F and G"),
    (lambda w: trilobe.torch.Model(isotropic(), texels=2).brdf(0.0), "texel must be an integer from 0 to 1"),
    (lambda w: trilobe.torch.Model(isotropic())(w.numpy(), w), "wi must be a tensor"),
    (lambda w: trilobe.torch.eval(isotropic(), w, w, d=[1, 1, 1]), "d must be a tensor"),
    (lambda w: trilobe.torch.eval(isotropic(), w, w[:, :2]), r"wo has the shape \(1, 2\)"),
    (lambda w: trilobe.torch.eval(isotropic(), torch.ones(4, 3), torch.ones(5, 3)), "do not go together"),
])
def test_says_in_a_line_what_is_wrong(ask, told):
    with pytest.raises(trilobe.Error, match=told):
        ask(torch.tensor([[0.0, 0.0, 1.0]]))


def test_needs_torch_to_be_imported():
    hidden = "import sys; sys.modules['torch'] = None; import trilobe; trilobe.torch"
    run = subprocess.run([sys.executable, "-c", hidden], capture_output=True, text=True)
    assert "ImportError: trilobe.torch needs PyTorch: pip install torch" in run.stderr
