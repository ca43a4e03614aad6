"""web/three: a material of three.js by the GLSL that `convert` writes has the model's values under three's lights, and
its albedo under even light. three.js, which the page takes from a CDN, is the copy of the same release in a package of
PyPI (scripts/check_pages.sh)."""

from __future__ import annotations

import importlib.util
import json
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from conftest import REPOSITORY, models, run, wait_for

HERE = "http://three.test/"
SIZE = 48
Array = npt.NDArray[np.float64]

# A sphere of radius 1, seen from z without perspective, into floats; it is fine, as three's tangents are those of its
# facets. The light comes from [x, y, z], or, if that is null, evenly from everywhere.
DRAW = """async ([source, light, samples]) => {
  const {trilobeMaterial} = await import('./trilobe_material.js');
  const size = SIZE, target = new THREE.WebGLRenderTarget(size, size, {type: THREE.FloatType});
  const made = new THREE.Scene();
  if (light) {
    const sun = new THREE.DirectionalLight(0xffffff, 2);
    sun.position.set(...light);
    made.add(sun);
  } else {
    const white = new THREE.Scene();
    white.background = new THREE.Color(1, 1, 1);
    made.environment = new THREE.PMREMGenerator(renderer).fromScene(white).texture;
  }
  made.add(new THREE.Mesh(new THREE.SphereGeometry(1, 512, 256), trilobeMaterial(renderer, source, {samples})));
  const eye = new THREE.OrthographicCamera(-1, 1, 1, -1, 0.1, 10);
  eye.position.z = 5;
  renderer.setRenderTarget(target);
  renderer.render(made, eye);
  renderer.setRenderTarget(null);
  const numbers = new Float32Array(size * size * 4);
  renderer.readRenderTargetPixels(target, 0, 0, size, size, numbers);
  return Array.from(numbers);
}""".replace("SIZE", str(SIZE))


@pytest.fixture(scope="module")
def served(browser: Any) -> Iterator[Callable[..., Any]]:
    """Opens web/three/index.html as if it were served, with files beside it."""
    found = importlib.util.find_spec("nicegui")
    if found is None:
        pytest.skip("no copy of three.js is here")
    three = {path.name: path for folder in found.submodule_search_locations or []
             for path in (Path(folder) / "elements/lib/three").rglob("*.js")}
    wanted = re.search(r"three@0\.(\d+)", (REPOSITORY / "web/three/index.html").read_text())
    assert wanted and f"REVISION = '{wanted[1]}'" in three["three.module.js"].read_text()
    contexts = []

    def opened(query: str = "", files: dict[str, Path] | None = None) -> Any:
        context = browser.new_context(viewport={"width": 90, "height": 60})
        contexts.append(context)
        page = context.new_page()

        def answer(route: Any) -> None:
            name = route.request.url.split("?")[0].rsplit("/", 1)[1]
            ours = route.request.url.startswith(HERE)
            path = {**(files or {})}.get(name, REPOSITORY / "web/three" / name) if ours else three.get(name)
            if path is None or not path.exists():
                route.fulfill(status=404)
            else:
                kind = {".js": "text/javascript", ".html": "text/html"}.get(path.suffix, "text/plain")
                route.fulfill(path=path, content_type=kind)

        page.route("**/*", answer)
        page.on("pageerror", lambda error: pytest.fail(str(error)))
        page.goto(f"{HERE}index.html{query}")
        wait_for(page, "!!window.draw")
        return page

    yield opened
    for context in contexts:
        context.close()


def normals() -> tuple[Array, Array]:
    """The pixels that show the sphere, but for its rim, and the normals there."""
    x = (np.arange(SIZE) + 0.5) / SIZE * 2 - 1
    square = x[None] ** 2 + x[:, None] ** 2
    inside = square < 0.8
    z = np.sqrt(np.where(inside, 1 - square, 0))
    return inside, np.stack([*np.broadcast_arrays(x[None], x[:, None]), z], axis=-1)[inside]


def local(w: Array, normal: Array) -> Array:
    """Directions in the frames of the sphere: x along its first coordinate, around y."""
    x = np.cross([0, 1, 0], normal)
    x /= np.linalg.norm(x, axis=1, keepdims=True)
    return np.stack([(w * x).sum(1), (w * np.cross(normal, x)).sum(1), (w * normal).sum(1)], axis=1)


def values(model: Path, wi: Array, wo: Array, folder: Path) -> Array:
    """The program's."""
    angles = [(np.degrees(np.arccos(np.clip(w[:, 2], -1, 1))), np.degrees(np.arctan2(w[:, 1], w[:, 0])) % 360)
              for w in (wi, wo)]
    rows = np.column_stack([*angles[0], *angles[1], np.ones((len(wi), 3))])
    header = "theta_i,phi_i,theta_o,phi_o,r,g,b"
    np.savetxt(folder / "at.csv", rows, fmt="%.9g", delimiter=",", header=header, comments="")
    run("convert", model, f"--at={folder}/at.csv", f"--out={folder}/values.csv")
    table = np.genfromtxt(folder / "values.csv", delimiter=",", names=True, comments="#")
    names = [name for name in table.dtype.names if name.startswith("fitted")]
    return np.stack([table[name] for name in names], axis=1)


@pytest.mark.parametrize("form", ["fitted", "anisotropic"])
def test_a_light_shines_by_the_models_values(form: str, served: Any, fits: Path, tmp_path: Path) -> None:
    model = models(tmp_path, fits)[form]
    run("convert", model, f"--out={tmp_path}/x.glsl")
    light = np.array([0.5, 0.4, 0.8]) / np.linalg.norm([0.5, 0.4, 0.8])
    drawn = served().evaluate(DRAW, [(tmp_path / "x.glsl").read_text(), light.tolist(), 4])
    inside, normal = normals()
    lit = normal @ light > 0.1
    wi, wo = (local(np.broadcast_to(w, normal.shape), normal)[lit] for w in (light, np.array([0, 0, 1.0])))
    wanted = 2 * values(model, wi, wo, tmp_path) * wi[:, 2:]
    seen = np.array(drawn).reshape(SIZE, SIZE, 4)[inside][lit, :3]
    off = np.abs(seen - wanted).max(axis=1) / (wanted.max(axis=1) + 1e-3)
    assert np.median(off) < 3e-3 and np.quantile(off, 0.99) < 0.03, f"{np.median(off):.1e} {off.max():.1e}"


def test_even_light_shows_the_albedo(served: Any, fits: Path, tmp_path: Path) -> None:
    model = fits / "plastic/model.json"
    run("convert", model, f"--out={tmp_path}/x.glsl")
    drawn = served().evaluate(DRAW, [(tmp_path / "x.glsl").read_text(), None, 64])
    inside, normal = normals()
    seen = np.array(drawn).reshape(SIZE, SIZE, 4)[inside][:, :3]
    for cosine in (0.95, 0.6):
        # Equal steps of sin^2 theta and phi are equal projected solid angles.
        y, phi = np.meshgrid((np.arange(200) + 0.5) / 200, (np.arange(120) + 0.5) / 120 * 2 * np.pi)
        sine = np.sqrt(y.ravel())
        wi = np.stack([sine * np.cos(phi.ravel()), sine * np.sin(phi.ravel()), np.sqrt(1 - sine**2)], axis=1)
        wo = np.broadcast_to([np.sqrt(1 - cosine**2), 0, cosine], wi.shape)
        albedo = np.pi * values(model, wi, wo, tmp_path).mean(axis=0)
        shown = seen[np.abs(normal[:, 2] - cosine) < 0.03].mean(axis=0)
        assert shown == pytest.approx(albedo, rel=0.02)


def test_the_page_shows_each_model_by_its_own(served: Any, fits: Path, tmp_path: Path) -> None:
    paths = {}
    for name, d in (("red", [0.2, 0.02, 0.02]), ("green", [0.02, 0.2, 0.02])):
        model = json.loads((fits / "plastic/model.json").read_text()) | {"d": d}
        model.pop("unobserved", None)
        (tmp_path / f"{name}.json").write_text(json.dumps(model))
        paths[f"{name}.glsl"] = tmp_path / f"{name}.glsl"
        run("convert", tmp_path / f"{name}.json", f"--out={paths[f'{name}.glsl']}")
    page = served("?model=red.glsl&model=green.glsl", paths)
    wait_for(page, "document.getElementById('said').textContent === '' && scene.children.length === 6", 120)
    # Balls at the left and knots beside them: the first two are red.
    pixels = np.array(page.evaluate("""() => {
      draw();
      const gl = renderer.getContext(), w = gl.drawingBufferWidth, h = gl.drawingBufferHeight;
      const bytes = new Uint8Array(4 * w * h);
      gl.readPixels(0, 0, w, h, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
      return [h, w, ...bytes];
    }"""))
    picture = pixels[2:].reshape(pixels[0], pixels[1], 4)[..., :2].astype(float)
    redder = picture[..., 0] - picture[..., 1]
    half = picture.shape[1] // 2
    assert redder[:, :half].max() > 40 and redder[:, :half].min() > -20
    assert redder[:, half:].min() < -40 and redder[:, half:].max() < 20


def test_the_page_says_that_it_needs_a_network(browser: Any) -> None:
    page = browser.new_page()
    page.route("**/*", lambda route: route.fulfill(path=REPOSITORY / "web/three/index.html", content_type="text/html")
               if route.request.url == HERE else route.abort())
    page.goto(HERE)
    assert "needs a network" in page.inner_text("p")
    wait_for(page, "document.getElementById('said').textContent.startsWith('three.js does not come')")
    page.close()


def test_the_page_says_what_it_cannot_read(served: Any, tmp_path: Path) -> None:
    (tmp_path / "bad.glsl").write_text("void main() {}")
    page = served("?model=bad.glsl", {"bad.glsl": tmp_path / "bad.glsl"})
    wait_for(page, "document.getElementById('said').textContent.includes('is no file of `trilobe convert')")
    page = served("?model=none.glsl")
    wait_for(page, "document.getElementById('said').textContent.includes('none.glsl: 404')")
