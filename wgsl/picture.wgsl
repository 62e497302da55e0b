// The offscreen picture: background, lit surface, borders as thin lines.
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
    // Linear colours of the two sides of a surface.
    front_color: vec4f,
    back_color: vec4f,
    // Linear colours of the background.
    top: vec4f,
    bottom: vec4f,
    line: vec4f,
    // Width and height in pixels, width of a line in pixels.
    viewport: vec4f,
}

@group(0) @binding(0) var<uniform> view: View;

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

// Surface

struct Surface {
    @builtin(position) position: vec4f,
    @location(0) place: vec3f,
    @location(1) normal: vec3f,
}

@vertex
fn surface_vertex(@location(0) position: vec3f, @location(1) normal: vec3f) -> Surface {
    let place = to_camera(position);
    var out: Surface;
    out.position = to_clip(place);
    out.place = place;
    out.normal = vec3f(dot(view.right.xyz, normal), dot(view.up.xyz, normal), dot(view.back.xyz, normal));
    return out;
}

fn lambert(n: vec3f, light: vec3f) -> f32 {
    return max(dot(n, light), 0.0);
}

fn gloss(n: vec3f, v: vec3f, light: vec3f, power: f32) -> f32 {
    return pow(max(dot(n, normalize(v + light)), 0.0), power) * step(0.0, dot(n, light));
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
    var n = normalize(in.normal) * select(-1.0, 1.0, front);
    // At a silhouette the smooth normal may lean away from the viewer: bend it back to the edge.
    n = normalize(n - min(dot(n, v), 0.0) * v);

    let albedo = select(view.back_color.rgb, view.front_color.rgb, front);
    let key = normalize(vec3f(-0.50, 0.80, 0.62));
    let fill = normalize(vec3f(0.85, 0.10, 0.60));
    let rim = normalize(vec3f(0.55, 0.55, -0.75));

    let hemisphere = mix(vec3f(0.17, 0.155, 0.15), vec3f(0.36, 0.39, 0.44), 0.5 + 0.5 * dot(n, view.sky.xyz));
    var light = hemisphere;
    light += vec3f(0.88, 0.84, 0.78) * lambert(n, key);
    light += vec3f(0.14, 0.16, 0.20) * lambert(n, fill);
    light += vec3f(0.30, 0.31, 0.34) * lambert(n, rim);

    let edge = pow(1.0 - max(dot(n, v), 0.0), 5.0);
    var color = albedo * light;
    color += vec3f(0.22) * gloss(n, v, key, 60.0) + vec3f(0.05) * gloss(n, v, fill, 24.0);
    color += 0.12 * edge * hemisphere;
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
