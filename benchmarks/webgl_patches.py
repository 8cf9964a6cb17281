"""Fragment shaders evaluated by WebGL 2 in a headless Chromium, which needs no graphics card."""

import base64
import os
import shutil
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any

import numpy as np
from numpy.typing import NDArray

_DRAW = """
(job) => {
  const canvas = document.createElement("canvas");
  const gl = canvas.getContext("webgl2");
  for (const name of ["EXT_color_buffer_float", "OES_texture_float_linear"])
    if (!gl.getExtension(name)) throw new Error(name + " is missing");
  const numbers = (text) =>
    new Float32Array(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer);
  const program = gl.createProgram();
  const { VERTEX_SHADER, FRAGMENT_SHADER } = gl;
  for (const [kind, source] of [[VERTEX_SHADER, job.vertex], [FRAGMENT_SHADER, job.fragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS))
      throw new Error(gl.getShaderInfoLog(shader));
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS))
    throw new Error(gl.getProgramInfoLog(program));
  gl.useProgram(program);
  const attribute = (name, values, size) => {
    const at = gl.getAttribLocation(program, name);
    if (at < 0) return;
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(values), gl.STATIC_DRAW);
    gl.enableVertexAttribArray(at);
    gl.vertexAttribPointer(at, size, gl.FLOAT, false, 0, 0);
  };
  attribute("i_position", [-1, -1, 0, 3, -1, 0, -1, 3, 0], 3);
  attribute("i_texcoord_0", [0, 0, 2, 0, 0, 2], 2);
  const unit = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
  for (const name of ["u_worldMatrix", "u_viewProjectionMatrix"])
    gl.uniformMatrix4fv(gl.getUniformLocation(program, name), false, unit);
  for (const [name, values] of Object.entries(job.uniforms))
    gl["uniform" + values.length + "f"](gl.getUniformLocation(program, name), ...values);
  job.textures.forEach(({ name, width, height, data, linear }, index) => {
    gl.activeTexture(gl.TEXTURE0 + index);
    gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, width, height, 0, gl.RGBA, gl.FLOAT, numbers(data));
    const filter = linear ? gl.LINEAR : gl.NEAREST;
    for (const [key, value] of [[gl.TEXTURE_MIN_FILTER, filter], [gl.TEXTURE_MAG_FILTER, filter],
      [gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE], [gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE]])
      gl.texParameteri(gl.TEXTURE_2D, key, value);
    gl.uniform1i(gl.getUniformLocation(program, name), index);
  });
  gl.activeTexture(gl.TEXTURE15);
  gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
  gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA32F, job.width, job.height);
  gl.bindFramebuffer(gl.FRAMEBUFFER, gl.createFramebuffer());
  gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D,
    gl.getParameter(gl.TEXTURE_BINDING_2D), 0);
  gl.bindTexture(gl.TEXTURE_2D, null);
  gl.viewport(0, 0, job.width, job.height);
  const one = new Float32Array(4);
  const draw = () => {
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.FLOAT, one);  // waits until it is drawn
  };
  draw();
  const start = performance.now();
  for (let frame = 0; frame < job.frames; frame++) draw();
  const seconds = (performance.now() - start) / 1000;
  const pixels = new Float32Array(job.frames ? 0 : job.width * job.height * 4);
  if (!job.frames) gl.readPixels(0, 0, job.width, job.height, gl.RGBA, gl.FLOAT, pixels);
  const bytes = new Uint8Array(pixels.buffer);
  let text = "";
  for (let at = 0; at < bytes.length; at += 8192)
    text += String.fromCharCode(...bytes.subarray(at, at + 8192));
  return { pixels: btoa(text), seconds, fault: gl.getError() };
}
"""

VERTEX = """#version 300 es
in vec3 i_position;
in vec2 i_texcoord_0;
out vec2 place;
void main() { place = i_texcoord_0; gl_Position = vec4(i_position, 1.0); }
"""
"""A triangle over the picture, with texture coordinates from 0 to 1 as `place`."""


def find_chromium() -> str | None:
    """Find an installed Chromium or Chrome."""
    names = ("chromium", "chromium-browser", "google-chrome")
    return next((path for name in names if (path := shutil.which(name))), None)


@contextmanager
def open_webgl() -> Iterator[Any]:
    """Open an empty page whose WebGL runs on the processor."""
    from playwright.sync_api import sync_playwright

    arguments = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
    if os.name == "posix" and os.geteuid() == 0:
        arguments.append("--no-sandbox")  # which refuses to run as root
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=find_chromium(), args=arguments)
        yield browser.new_page()
        browser.close()


def draw(
    page: Any,
    shaders: tuple[str, str],
    size: tuple[int, int],
    textures: Mapping[str, tuple[NDArray[Any], bool]],
    uniforms: Mapping[str, tuple[float, ...]] | None = None,
    frames: int = 0,
) -> tuple[NDArray[np.float32], float]:
    """Draw a picture.

    Args:
        page: As of `open_webgl`.
        shaders: Vertex and fragment shader.
        size: Width and height in pixels.
        textures: Colours [rows, columns, 3] by name, and whether they are interpolated. The last
            row is at v = 0.
        uniforms: Numbers by name.
        frames: Frames to time; 0: none, and the pixels are returned.

    Returns:
        Colours [rows, columns, 3], the first row on top, and the seconds of all frames.
    """
    job = {
        "vertex": shaders[0],
        "fragment": shaders[1],
        "width": size[0],
        "height": size[1],
        "textures": [_pack(name, *each) for name, each in textures.items()],
        "uniforms": dict(uniforms or {}),
        "frames": frames,
    }
    done = page.evaluate(_DRAW, job)
    if done["fault"]:
        raise RuntimeError(f"WebGL reports error {done['fault']}.")
    pixels = np.frombuffer(base64.b64decode(done["pixels"]), np.float32)
    rows = pixels.reshape(-1, size[0], 4)[::-1, :, :3]
    return rows, done["seconds"]


def _pack(name: str, colours: NDArray[Any], linear: bool) -> dict[str, Any]:
    filled = np.ones((*colours.shape[:2], 4), np.float32)
    filled[..., :3] = colours[::-1]
    height, width = colours.shape[:2]
    data = base64.b64encode(filled.tobytes()).decode()
    return {"name": name, "width": width, "height": height, "data": data, "linear": linear}
