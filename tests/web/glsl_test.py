"""`trilobe convert MODEL --out=x.glsl`, or x.hlsl: what a browser makes of the file is what trilobe::Bsdf says, for
models of every form. HLSL comes there by way of SPIR-V."""

from __future__ import annotations

import base64
import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from conftest import BUILD, models, run

COUNT = 4096
FORMS = [
    "fitted",
    "stretched",
    "stretched_by_lobe",
    "other_sharing",
    "thinned",
    "five_lobes",
    "lambertian",
    "anisotropic",
]

FRAGMENT = """
#version 300 es
precision highp float; precision highp sampler2D;
SOURCE
uniform sampler2D pairs;
layout(location = 0) out vec4 a; layout(location = 1) out vec4 b; layout(location = 2) out vec4 c;
void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec4 p = texelFetch(pairs, ivec2(2 * at.x, at.y), 0), q = texelFetch(pairs, ivec2(2 * at.x + 1, at.y), 0);
  vec3 wi = p.xyz, wo = vec3(p.w, q.xy), weight;
  float pdf;
  a = vec4(trilobe_eval(wi, wo), trilobe_pdf(wi, wo));
  b.xyz = trilobe_sample(wi, q.zw, pdf, weight);
  b.w = pdf;
  c = vec4(weight, 1);
}""".lstrip()

HLSL_FRAGMENT = """
SOURCE
Texture2D<float4> pairs;
struct Out { float4 a : SV_Target0; float4 b : SV_Target1; float4 c : SV_Target2; };
Out main(float4 position : SV_Position) {
  int2 at = int2(position.xy);
  float4 p = pairs.Load(int3(2 * at.x, at.y, 0)), q = pairs.Load(int3(2 * at.x + 1, at.y, 0));
  float3 wi = p.xyz, wo = float3(p.w, q.xy), weight;
  float pdf;
  Out result;
  result.a = float4(trilobe_eval(wi, wo), trilobe_pdf(wi, wo));
  result.b.xyz = trilobe_sample(wi, q.zw, pdf, weight);
  result.b.w = pdf;
  result.c = float4(weight, 1.0);
  return result;
}"""

# Draws 64 x 64 points, each a pair of directions, into three pictures of floats, and returns their numbers.
DRAW = """async ([fragment, source, pairs]) => {
  const gl = new OffscreenCanvas(64, 64).getContext('webgl2');
  if (!gl.getExtension('EXT_color_buffer_float')) throw new Error('no float targets');
  const texture = (width, height, data) => {
    const t = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, t);
    for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) {
      gl.texParameteri(gl.TEXTURE_2D, filter, gl.NEAREST);
    }
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, width, height, 0, gl.RGBA, gl.FLOAT, data);
    return t;
  };
  const floats = text => new Float32Array(Uint8Array.from(atob(text), c => c.charCodeAt(0)).buffer);
  const program = gl.createProgram();
  const add = (kind, text) => {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    gl.attachShader(program, shader);
  };
  add(gl.VERTEX_SHADER, '#version 300 es\\nvoid main() {' +
      ' gl_Position = vec4(gl_VertexID == 1 ? 3 : -1, gl_VertexID == 2 ? 3 : -1, 0, 1); }');
  add(gl.FRAGMENT_SHADER, fragment);
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
  gl.bindFramebuffer(gl.FRAMEBUFFER, gl.createFramebuffer());
  const targets = [0, 1, 2].map(k => {
    const t = texture(64, 64, null);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0 + k, gl.TEXTURE_2D, t, 0);
    return gl.COLOR_ATTACHMENT0 + k;
  });
  gl.drawBuffers(targets);
  const data = /tables RGBA32F (\\d+) x (\\d+)\\n([^*]*)\\*\\//.exec(source);
  gl.useProgram(program);
  gl.activeTexture(gl.TEXTURE0);
  texture(+data[1], +data[2], floats(data[3].replace(/\\s/g, '')));
  gl.activeTexture(gl.TEXTURE1);
  texture(128, 64, floats(pairs));
  for (let k = 0; k < 2; ++k) {
    const name = gl.getActiveUniform(program, k).name;
    gl.uniform1i(gl.getUniformLocation(program, name), name.includes('pairs') ? 1 : 0);
  }
  gl.viewport(0, 0, 64, 64);
  gl.drawArrays(gl.TRIANGLES, 0, 3);
  return targets.map(target => {
    gl.readBuffer(target);
    const numbers = new Float32Array(64 * 64 * 4);
    gl.readPixels(0, 0, 64, 64, gl.RGBA, gl.FLOAT, numbers);
    return Array.from(numbers, x => Number.isFinite(x) ? x : 1e30);
  });
}"""


def fragment_of(source: Path) -> str:
    """The shader source that a browser compiles for a file."""
    text = re.sub(r"/\* tables RGBA32F[^*]*\*/", "", source.read_text())
    if source.suffix == ".glsl":
        return FRAGMENT.replace("SOURCE", text)
    if not (shutil.which("glslangValidator") and shutil.which("spirv-cross")):
        pytest.skip("glslang-tools and spirv-cross are not installed")
    spirv, crossed = source.with_suffix(".spv"), source.with_suffix(".frag")
    whole = source.with_suffix(".whole.hlsl")
    whole.write_text(HLSL_FRAGMENT.replace("SOURCE", text))
    for command in (["glslangValidator", "-D", "-V", "-S", "frag", "-e", "main", "-o", spirv, whole],
                    ["spirv-cross", spirv, "--es", "--version", "300", "--output", crossed]):
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout + done.stderr
    return crossed.read_text()


def draw(browser: Any, source: Path, pairs: npt.NDArray[Any]) -> list[npt.NDArray[Any]]:
    """(eval, pdf), (wo, pdf) and weights of each pair."""
    page = browser.new_page()
    numbers = page.evaluate(
        DRAW, [fragment_of(source), source.read_text(), base64.b64encode(pairs.tobytes()).decode()])
    page.close()
    return [np.array(x).reshape(COUNT, 4) for x in numbers]


def off(drawn: npt.NDArray[Any], wanted: npt.NDArray[Any], floor: float) -> npt.NDArray[Any]:
    """Differences relative to what is wanted, of small numbers to `floor`."""
    return np.abs(drawn - wanted) / np.maximum(np.abs(wanted), floor)


# HLSL has the same text: forms that between them reach all of it.
@pytest.mark.parametrize("form, ending", [(form, "glsl") for form in FORMS] + [
    (form, "hlsl") for form in ("stretched_by_lobe", "five_lobes", "lambertian", "anisotropic")])
def test_the_shader_says_what_the_library_says(
        form: str, ending: str, browser: Any, fits: Path, tmp_path: Path) -> None:
    model = models(tmp_path, fits)[form]
    shader = tmp_path / f"x.{ending}"
    run("convert", model, f"--out={shader}")
    subprocess.run([BUILD / "tests/web_reference", model, str(COUNT), tmp_path / "x.bin"], check=True)
    rows = np.fromfile(tmp_path / "x.bin", "<f4").reshape(COUNT, 19)
    a, b, c = draw(browser, shader, np.concatenate([rows[:, :6], rows[:, 10:12]], axis=1).astype("<f4"))
    value = off(a[:, :3], rows[:, 6:9], 1e-3 * float(rows[:, 6:9].max()))
    assert value.max() < 1e-4, f"eval is off by {value.max():.1e}"
    density = off(a[:, 3], rows[:, 9], 1e-3)
    assert np.quantile(density, 0.99) < 1e-3 and density.max() < 3e-2, f"pdf is off by {density.max():.1e}"
    drawn = np.abs(b[:, :3] - rows[:, 12:15]).max(axis=1)
    assert np.quantile(drawn, 0.99) < 1e-3, f"directions are off by {np.quantile(drawn, 0.99):.1e}"
    weight = off(c[:, :3], rows[:, 16:19], 1e-2).max(axis=1)
    assert np.quantile(weight, 0.98) < 1e-2, f"weights are off by {np.quantile(weight, 0.98):.1e}"
    assert np.isfinite(a).all() and (a >= 0).all()


def test_directions_below_the_surface_are_black(browser: Any, fits: Path, tmp_path: Path) -> None:
    run("convert", fits / "plastic/model.json", f"--out={tmp_path}/x.glsl")
    pairs = np.tile(np.array([0, 0, -1, 0, 0, 1, 0.5, 0.5], "<f4"), (COUNT, 1))
    pairs[1, :3] = [0.6, 0, 0.8]
    pairs[1, 3:6] = [0.6, 0, -0.8]
    pairs[2, :6] = np.nan
    a, b, c = draw(browser, tmp_path / "x.glsl", pairs)
    assert (a == 0).all()
    assert (b[0] == 0).all() and (c[0, :3] == 0).all()
    assert (b[2, 3] == 0) and (c[2, :3] == 0).all()
