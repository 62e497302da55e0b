// The offscreen picture: background, shadow on the ground, lit surface, borders as thin lines.
//
// Shading happens in camera space: x right, y up, z towards the viewer, the eye at the origin. So
// the lights stay with the viewer, and every view of every model is well lit.

struct View {
    // Camera space of a point p: dot(axis.xyz, p) + axis.w for each of the three.
    right: vec4f,
    up: vec4f,
    back: vec4f,
    // Scale of x and y, near and far distance.
    projection: vec4f,
    // The model's up in camera space; w is 1 for a perspective view, 0 for a parallel one.
    sky: vec4f,
    // Linear colour of the back of a surface.
    back_color: vec4f,
    // Linear colours of the background.
    top: vec4f,
    bottom: vec4f,
    line: vec4f,
    // Width and height in pixels, width of a line in pixels.
    viewport: vec4f,
    // Height of the ground above the model's origin, how dark shadows on it are (0 without ground),
    // radius of the model about its origin.
    ground: vec4f,
}

@group(0) @binding(0) var<uniform> view: View;
@group(1) @binding(0) var shadow_map: texture_depth_2d;
@group(1) @binding(1) var shadow_sampler: sampler_comparison;

// Directions to the three lights, and two that make a frame with the first.
const KEY = vec3f(-0.6004, 0.6367, 0.4839);
const KEY_RIGHT = vec3f(0.6275, 0.0, 0.7786);
const KEY_UP = vec3f(0.4957, 0.7711, -0.3996);
const FILL = vec3f(0.8523, 0.0474, 0.5209);
const RIM = vec3f(0.5473, 0.4104, -0.7297);

// The model's origin in camera space.
fn origin() -> vec3f {
    return vec3f(view.right.w, view.up.w, view.back.w);
}

fn to_camera(p: vec3f) -> vec3f {
    return vec3f(
        dot(view.right.xyz, p) + view.right.w,
        dot(view.up.xyz, p) + view.up.w,
        dot(view.back.xyz, p) + view.back.w,
    );
}

fn to_clip(p: vec3f) -> vec4f {
    let near = view.projection.z;
    let far = view.projection.w;
    let depth = (-p.z - near) / (far - near);
    let xy = p.xy * view.projection.xy;
    if view.sky.w == 0.0 {
        return vec4f(xy, depth, 1.0);
    }
    return vec4f(xy, depth * far, -p.z);
}

// Background: one triangle over the whole picture.

struct Backdrop {
    @builtin(position) position: vec4f,
    @location(0) place: vec2f,
}

@vertex
fn background_vertex(@builtin(vertex_index) index: u32) -> Backdrop {
    let corner = vec2f(f32((index << 1u) & 2u), f32(index & 2u)) * 2.0 - 1.0;
    var out: Backdrop;
    out.position = vec4f(corner, 1.0, 1.0);
    out.place = corner;
    return out;
}

@fragment
fn background_fragment(in: Backdrop) -> @location(0) vec4f {
    // Lightest a little above the middle, darker towards the foot and the corners.
    let height = smoothstep(-1.1, 0.9, in.place.y);
    let corner = 1.0 - 0.10 * dot(in.place, in.place);
    return vec4f(mix(view.bottom.rgb, view.top.rgb, height) * corner, 1.0);
}

// Shadow: the model's depth as the key light sees it, in parallel projection.

fn to_light(p: vec3f) -> vec3f {
    let q = (p - origin()) / view.ground.z;
    // Nothing lies farther off than the model: what does is lit like its far end.
    return vec3f(dot(q, KEY_RIGHT), dot(q, KEY_UP), min(0.5 - 0.5 * dot(q, KEY), 1.0));
}

@vertex
fn shadow_vertex(@location(0) position: vec3f) -> @builtin(position) vec4f {
    return vec4f(to_light(to_camera(position)), 1.0);
}

// The share of the key light that reaches p, averaged over a disc of this radius in the map.
fn reached(p: vec3f, radius: f32) -> f32 {
    let q = to_light(p);
    let middle = vec2f(0.5 + 0.5 * q.x, 0.5 - 0.5 * q.y);
    let taps = 40;
    var direction = vec2f(radius, 0.0);
    var sum = 0.0;
    for (var i = 0; i < taps; i++) {
        let place = middle + sqrt((f32(i) + 0.5) / f32(taps)) * direction;
        sum += textureSampleCompareLevel(shadow_map, shadow_sampler, place, q.z);
        // A sunflower: turned by the golden angle from tap to tap.
        direction = vec2f(
            -0.7373688 * direction.x - 0.6754903 * direction.y,
            0.6754903 * direction.x - 0.7373688 * direction.y,
        );
    }
    return sum / f32(taps);
}

// Ground: a disc below the model that shows nothing but shadow.

struct Ground {
    @builtin(position) position: vec4f,
    @location(0) place: vec3f,
}

const GROUND_RADIUS = 3.0;

@vertex
fn ground_vertex(@builtin(vertex_index) index: u32) -> Ground {
    let corner = vec2f(f32(index & 1u), f32(index >> 1u)) * 2.0 - 1.0;
    // The camera's right is always level.
    let right = vec3f(1.0, 0.0, 0.0);
    let forward = cross(view.sky.xyz, right);
    let flat = GROUND_RADIUS * (corner.x * right + corner.y * forward);
    var out: Ground;
    out.place = origin() + view.ground.x * view.sky.xyz + flat;
    out.position = to_clip(out.place);
    return out;
}

@fragment
fn ground_fragment(in: Ground) -> @location(0) vec4f {
    let far = length(in.place - origin() - view.ground.x * view.sky.xyz);
    let fade = 1.0 - smoothstep(0.45 * GROUND_RADIUS, 0.95 * GROUND_RADIUS, far);
    let shadow = 1.0 - reached(in.place, 0.008);
    return vec4f(0.02, 0.025, 0.04, view.ground.y * fade * shadow);
}

// Surface

struct Surface {
    @builtin(position) position: vec4f,
    @location(0) place: vec3f,
    @location(1) normal: vec3f,
    @location(2) color: vec3f,
}

@vertex
fn surface_vertex(
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) color: vec3f,
) -> Surface {
    let place = to_camera(position);
    var out: Surface;
    out.position = to_clip(place);
    out.place = place;
    out.normal = vec3f(dot(view.right.xyz, normal), dot(view.up.xyz, normal), dot(view.back.xyz, normal));
    out.color = color;
    return out;
}

fn lambert(n: vec3f, light: vec3f) -> f32 {
    return max(dot(n, light), 0.0);
}

// Of the key light.
fn gloss(n: vec3f, v: vec3f, power: f32) -> f32 {
    return pow(max(dot(n, normalize(v + KEY)), 0.0), power);
}

// Rolls bright values off towards 1, leaves the rest nearly as it is.
fn shoulder(c: vec3f) -> vec3f {
    let start = vec3f(0.6);
    let over = max(c - start, vec3f(0.0));
    return min(c, start) + (1.0 - start) * (1.0 - exp(-over / (1.0 - start)));
}

@fragment
fn surface_fragment(in: Surface, @builtin(front_facing) front: bool) -> @location(0) vec4f {
    let v = select(vec3f(0.0, 0.0, 1.0), normalize(-in.place), view.sky.w == 1.0);
    // A vertex without a normal is shaded as if it faced the viewer.
    // Nothing here may be no number: what comparisons make of that differs from driver to driver.
    let squared = dot(in.normal, in.normal);
    let unit = in.normal * inverseSqrt(max(squared, 1e-12));
    var n = select(v, unit * select(-1.0, 1.0, front), squared > 1e-12);
    // At a silhouette the smooth normal may lean away from the viewer: bend it back to the edge.
    n = normalize(n - min(dot(n, v), 0.0) * v);

    let albedo = select(view.back_color.rgb, in.color, front);
    // A little off the surface, or its own roughness in the map would shade it.
    let direct = lambert(n, KEY) * reached(in.place + (0.016 * n + 0.006 * KEY) * view.ground.z, 0.005);
    let around = mix(vec3f(0.125, 0.11, 0.105), vec3f(0.30, 0.33, 0.385), 0.5 + 0.5 * dot(n, view.sky.xyz));
    var light = around;
    light += vec3f(1.02, 0.96, 0.88) * direct;
    light += vec3f(0.13, 0.155, 0.20) * lambert(n, FILL);
    light += vec3f(0.34, 0.35, 0.38) * lambert(n, RIM);

    // Rounding takes dot beyond 1, and of what is below 0 there is no power.
    let edge = pow(1.0 - clamp(dot(n, v), 0.0, 1.0), 5.0);
    var color = albedo * light;
    color += (vec3f(0.06) * gloss(n, v, 12.0) + vec3f(0.40) * gloss(n, v, 110.0)) * smoothstep(0.0, 0.15, direct);
    color += 0.35 * edge * around;
    return vec4f(shoulder(color), 1.0);
}

// Lines: six corners of a thin strip for each pair of end points.

@vertex
fn line_vertex(
    @builtin(vertex_index) index: u32,
    @location(0) from_point: vec3f,
    @location(1) to_point: vec3f,
) -> @builtin(position) vec4f {
    let a = to_clip(nearer(to_camera(from_point)));
    let b = to_clip(nearer(to_camera(to_point)));
    let along = (b.xy / b.w - a.xy / a.w) * view.viewport.xy;
    let across = vec2f(-along.y, along.x) / max(length(along), 1e-6);
    let at_end = index == 1u || index >= 3u && index != 5u;
    let side = select(-1.0, 1.0, index == 2u || index >= 4u);
    var corner = select(a, b, at_end);
    corner += vec4f(across * side * view.viewport.z / view.viewport.xy * corner.w, 0.0, 0.0);
    return corner;
}

// A little towards the viewer, so that a line on a surface is not hidden by it.
fn nearer(p: vec3f) -> vec3f {
    if view.sky.w == 0.0 {
        return p + vec3f(0.0, 0.0, 0.004);
    }
    return p * 0.999;
}

@fragment
fn line_fragment() -> @location(0) vec4f {
    return view.line;
}
