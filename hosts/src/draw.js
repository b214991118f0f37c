// The two ways to draw a scene on a canvas: WebGPU, and WebGL 2.
//
// Each of them opens a canvas and gives `{ name, most, prepare }`: what it is called, how wide or high a picture may be, and what makes a scene ready.
// `prepare(scene)` gives `{ draw(width, height), free() }`. A drawing ends when it is drawn. A scene has its uniforms as `block`, and functions that give its
// texts and numbers, perhaps later: `code()` in WGSL, `glsl()` for WebGL 2 or null, `buffers()`. `lost` is told why the device is gone.

export async function webgpu(canvas, lost) {
  const adapter = await navigator.gpu?.requestAdapter();
  if (!adapter) throw new Error('This browser offers no WebGPU. Chrome, Edge, Safari 26 and Firefox 141 do on most devices.');
  const device = await adapter.requestDevice();
  device.lost.then((why) => lost(`The graphics device is gone: ${why.message}`));
  const format = navigator.gpu.getPreferredCanvasFormat();
  const depthFormat = 'depth24plus';
  let context = null, depth = null;
  async function prepare(scene) {
    const module = device.createShaderModule({ code: await scene.code() });
    const errors = (await module.getCompilationInfo()).messages.filter((m) => m.type === 'error');
    if (errors.length) throw new Error(errors.map((m) => `${m.lineNum}: ${m.message}`).join('\n'));
    const pipeline = await device.createRenderPipelineAsync({
      layout: 'auto',
      vertex: { module, entryPoint: 'sf_vertex' },
      fragment: { module, entryPoint: 'sf_fragment', targets: [{ format }] },
      depthStencil: { format: depthFormat, depthWriteEnabled: true, depthCompare: 'always' },
    });
    const buffer = (bytes, usage) => {
      const made = device.createBuffer({ size: bytes.byteLength, usage: usage | GPUBufferUsage.COPY_DST });
      device.queue.writeBuffer(made, 0, bytes);
      return made;
    };
    const uniforms = buffer(scene.block, GPUBufferUsage.UNIFORM);
    const buffers = [uniforms, ...(await scene.buffers()).map((bytes) => buffer(bytes, GPUBufferUsage.STORAGE))];
    const group = device.createBindGroup({
      layout: pipeline.getBindGroupLayout(0),
      entries: buffers.map((made, binding) => ({ binding, resource: { buffer: made } })),
    });
    // A canvas that has this context never has the other one: it is asked for when a scene can be drawn.
    if (!context) {
      context = canvas.getContext('webgpu');
      context.configure({ device, format });
    }
    async function draw(width, height) {
      if (depth?.width !== width || depth?.height !== height) {
        depth?.destroy();
        depth = device.createTexture({ size: [width, height], format: depthFormat, usage: GPUTextureUsage.RENDER_ATTACHMENT });
      }
      device.queue.writeBuffer(uniforms, 0, scene.block);
      const encoder = device.createCommandEncoder();
      const pass = encoder.beginRenderPass({
        colorAttachments: [{ view: context.getCurrentTexture().createView(), loadOp: 'clear', storeOp: 'store' }],
        depthStencilAttachment: { view: depth.createView(), depthClearValue: 1, depthLoadOp: 'clear', depthStoreOp: 'discard' },
      });
      pass.setPipeline(pipeline);
      pass.setBindGroup(0, group);
      pass.draw(3);
      pass.end();
      device.queue.submit([encoder.finish()]);
      await device.queue.onSubmittedWorkDone();
    }
    return { draw, free: () => buffers.forEach((made) => made.destroy()) };
  }
  return { name: 'webgpu', most: device.limits.maxTextureDimension2D, prepare };
}

const next = () => new Promise((go) => { setTimeout(go, 1); });

export async function webgl(canvas, lost) {
  const gl = canvas.getContext('webgl2', { alpha: false, antialias: false, depth: false, preserveDrawingBuffer: true });
  if (!gl) throw new Error('This browser offers no WebGL 2 either.');
  canvas.addEventListener('webglcontextlost', () => lost('The graphics device is gone. Load the page again.'));
  const parallel = gl.getExtension('KHR_parallel_shader_compile');
  gl.bindBuffer(gl.UNIFORM_BUFFER, gl.createBuffer());
  gl.bindBufferBase(gl.UNIFORM_BUFFER, 0, gl.getParameter(gl.UNIFORM_BUFFER_BINDING));
  async function prepare(scene) {
    const text = await scene.glsl();
    if (!text) throw new Error('This scene is drawn by WebGPU alone.');
    const program = gl.createProgram();
    const vertex = '#version 300 es\nvoid main() { gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0); }';
    const shaders = [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, text]].map(([type, source]) => {
      const shader = gl.createShader(type);
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
      return shader;
    });
    const free = () => [...shaders.map((shader) => gl.deleteShader(shader)), gl.deleteProgram(program)];
    gl.linkProgram(program);
    while (parallel && !gl.getProgramParameter(program, parallel.COMPLETION_STATUS_KHR)) await next();
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) {
      const says = [...shaders.map((shader) => gl.getShaderInfoLog(shader)), gl.getProgramInfoLog(program)].filter(Boolean).join('\n');
      free();
      throw new Error(says);
    }
    gl.uniformBlockBinding(program, 0, 0);
    async function draw(width, height) {
      gl.useProgram(program);
      gl.viewport(0, 0, width, height);
      gl.bufferData(gl.UNIFORM_BUFFER, scene.block, gl.DYNAMIC_DRAW);
      gl.drawArrays(gl.TRIANGLES, 0, 3);
      const drawn = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
      gl.flush();
      while (gl.clientWaitSync(drawn, 0, 0) === gl.TIMEOUT_EXPIRED) await next();
      gl.deleteSync(drawn);
    }
    return { draw, free };
  }
  return { name: 'webgl', most: gl.getParameter(gl.MAX_RENDERBUFFER_SIZE), prepare };
}

// A canvas opened by the first way that draws the scene, and the scene made ready.
export async function open(canvas, scene, lost) {
  const failed = [];
  for (const make of [webgpu, webgl]) {
    try {
      const way = await make(canvas, lost);
      return { way, picture: await way.prepare(scene) };
    } catch (error) {
      failed.push(error.message);
    }
  }
  throw new Error(failed.join('\n'));
}
