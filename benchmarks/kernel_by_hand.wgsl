// A march of 32 steps written by hand: parallax occlusion, bilinear heights from four gathered texels,
// a map that repeats. Its bindings are those of the generated program.

struct Run { width: u32, first_row: u32, last_row: u32, plane_row: u32, plane_stride: u32 }
struct Sweep { origin: vec2f, right: vec2f, down: vec2f, travel: vec2f, travel_right: vec2f, travel_down: vec2f }
struct March { min_steps: i32, max_steps: i32, steps_per_texel: f32 }

@group(0) @binding(0) var<uniform> run: Run;
@group(0) @binding(1) var<storage, read_write> planes: array<u32>;
@group(0) @binding(2) var edges: sampler;
@group(0) @binding(3) var<uniform> sweep: Sweep;
@group(0) @binding(4) var<uniform> march: March;
@group(0) @binding(5) var heights: texture_2d<f32>;

fn height(uv: vec2f, size: vec2i) -> f32 {
  let place = fract(uv) * vec2f(size) - 0.5;
  let corner = floor(place);
  let t = place - corner;
  let h = textureGather(0, heights, edges, (corner + 1.0) / vec2f(size));
  return mix(mix(h.w, h.z, t.x), mix(h.x, h.y, t.x), t.y);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
  if (id.x >= run.width || id.y + run.first_row >= run.last_row) { return; }
  let pixel = vec2f(f32(id.x), f32(id.y + run.first_row));
  let start = sweep.origin + sweep.right * pixel.x + sweep.down * pixel.y;
  let travel = sweep.travel + sweep.travel_right * pixel.x + sweep.travel_down * pixel.y;
  let size = vec2i(textureDimensions(heights));
  let steps = march.max_steps;
  let step = 1.0 / f32(steps);
  var ray = 1.0;
  var surface = height(start, size);
  var ray_before = ray;
  var surface_before = surface;
  // the last read is at the base, height 0
  for (var k = 1; k <= steps && ray > surface; k++) {
    ray_before = ray;
    surface_before = surface;
    ray = 1.0 - select(f32(k) * step, 1.0, k == steps);
    surface = height(start + travel * (1.0 - ray), size);
  }
  if (ray <= surface) {
    let before = ray_before - surface_before;
    let after = surface - ray;
    ray = mix(ray_before, ray, clamp(before / max(before + after, 1e-9), 0.0, 1.0));
  }
  let uv = start + travel * (1.0 - ray);
  let place = id.y * run.width + id.x;
  planes[place] = bitcast<u32>(uv.x);
  planes[place + run.plane_stride] = bitcast<u32>(uv.y);
}
