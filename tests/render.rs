//! The offscreen picture: what is where in it, and that it refuses what it should.
#![cfg(feature = "gpu")]

use burgeon::io::png::Image;
use burgeon::io::{bpt, png, write_atomically};
use burgeon::patch::{Net, Word};
use burgeon::render::{Camera, Error, Picture, Up, render};
use burgeon::tessellate::{Mesh, dice, grid, per_vertex};

/// A device with WebGPU's default limits and no features, or `None` where skipping was asked for.
///
/// Everyone who runs the tests should see the pictures tested, so no adapter is a failure.
fn device() -> Option<(wgpu::Device, wgpu::Queue)> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
    let adapter = match pollster::block_on(instance.request_adapter(&Default::default())) {
        Ok(adapter) => adapter,
        Err(_) if std::env::var_os("BURGEON_SKIP_GPU").is_some_and(|value| value == "1") => return None,
        Err(error) => panic!(
            "no graphics adapter ({error}): install the package mesa-vulkan-drivers, which brings one in \
             software, or set BURGEON_SKIP_GPU=1"
        ),
    };
    let descriptor = wgpu::DeviceDescriptor { label: Some("picture tests"), ..Default::default() };
    let (device, queue) = pollster::block_on(adapter.request_device(&descriptor)).expect("a device");
    device.on_uncaptured_error(std::sync::Arc::new(|error| panic!("uncaptured: {error}")));
    Some((device, queue))
}

fn word(name: &str) -> Word {
    let path = format!("{}/examples/data/{name}.bpt", env!("CARGO_MANIFEST_DIR"));
    Word::from_nets(name, "P", &bpt::read(path, false).expect(name)).expect(name)
}

fn small() -> Picture {
    Picture { width: 250, height: 180, ..Picture::default() }
}

/// Writes the picture where BURGEON_PICTURES says, for eyes.
fn keep(name: &str, image: &Image) {
    if let Some(folder) = std::env::var_os("BURGEON_PICTURES") {
        let path = std::path::Path::new(&folder).join(name);
        write_atomically(path, |writer| png::write(writer, image)).expect(name);
    }
}

fn rgb(image: &Image, x: u32, y: u32) -> [i32; 3] {
    let [r, g, b, a] = image.pixel(x, y).expect("inside");
    assert_eq!(a, 255);
    [r, g, b].map(i32::from)
}

/// How warm a pixel is: the front of a surface is, its back and the background are not.
fn warmth(image: &Image, x: u32, y: u32) -> i32 {
    let [r, _, b] = rgb(image, x, y);
    r - b
}

/// The box of the warm pixels: left, top, right, bottom.
fn warm_box(image: &Image) -> [u32; 4] {
    let mut bounds = [u32::MAX, u32::MAX, 0, 0];
    for y in 0..image.height {
        for x in 0..image.width {
            if warmth(image, x, y) > 12 {
                bounds = [bounds[0].min(x), bounds[1].min(y), bounds[2].max(x), bounds[3].max(y)];
            }
        }
    }
    bounds
}

#[test]
fn the_teapot_stands_in_the_middle() {
    let Some((device, queue)) = device() else { return };
    let mesh = dice(&word("teapot"), 16).expect("a mesh");
    let picture = Picture::default();
    let image = render(&device, &queue, &mesh, &picture).expect("a picture");
    keep("teapot.png", &image);
    let (width, height) = (picture.width, picture.height);
    assert_eq!((image.width, image.height), (width, height));
    assert_eq!(image.pixels.len(), (width * height * 4) as usize);
    for (x, y) in [(0, 0), (width - 1, 0), (0, height - 1), (width - 1, height - 1)] {
        assert!(warmth(&image, x, y) <= 0, "a corner shows the background");
    }
    assert!(warmth(&image, width / 2, height / 2) > 20, "the teapot is in the middle");
    let [left, top, right, bottom] = warm_box(&image).map(|x| x as i32);
    assert!((left - (width as i32 - 1 - right)).abs() < 12, "centred: {left}, {right}");
    assert!((top - (height as i32 - 1 - bottom)).abs() < 12, "centred: {top}, {bottom}");
    assert!((right - left) as f64 > 0.8 * f64::from(width), "it fills the picture");
    let (mut bright, mut dark) = (0, 0);
    for y in 0..height {
        for x in 0..width {
            if warmth(&image, x, y) > 12 {
                bright += usize::from(rgb(&image, x, y)[0] > 200);
                dark += usize::from(rgb(&image, x, y)[0] < 60);
            }
        }
    }
    assert!(bright > 20_000, "lit from above: {bright}");
    assert_eq!(dark, 0, "nothing is black");
}

#[test]
fn the_same_twice() {
    let Some((device, queue)) = device() else { return };
    let mesh = dice(&word("sheet"), 32).expect("a mesh");
    keep("sheet.png", &render(&device, &queue, &mesh, &Picture::default()).expect("a picture"));
    let first = render(&device, &queue, &mesh, &small()).expect("a picture");
    assert!(first == render(&device, &queue, &mesh, &small()).expect("a picture"));
}

#[test]
fn the_two_sides_differ_and_both_are_lit() {
    let Some((device, queue)) = device() else { return };
    let top = Picture { camera: Camera::Top, ..small() };
    let sheet = word("sheet");
    let front = render(&device, &queue, &dice(&sheet, 16).expect("a mesh"), &top).expect("a picture");
    keep("sheet-top.png", &front);
    let turned: Vec<Net> = (0..sheet.modules.len())
        .map(|index| Net { degree: sheet.degree, points: sheet.net(index).to_vec() }.transposed())
        .collect();
    let turned = Word::from_nets("turned", "P", &turned).expect("a word");
    let back = render(&device, &queue, &dice(&turned, 16).expect("a mesh"), &top).expect("a picture");
    keep("sheet-back.png", &back);
    let (x, y) = (top.width / 2, top.height / 2);
    assert!(warmth(&front, x, y) > 20);
    assert!(warmth(&back, x, y) < -20);
    assert!(rgb(&back, x, y)[2] > 100);
}

#[test]
fn seen_from_above_a_square_is_a_square() {
    let Some((device, queue)) = device() else { return };
    for (up, point) in [(Up::Y, [0, 2, 1]), (Up::Z, [0, 1, 2])] {
        // Two units wide, one deep, a thousand off the origin.
        let corner = |x: f32, y: f32| {
            let flat = [1000.0 + 2.0 * x, y, 0.0];
            [flat[point[0]], flat[point[1]], flat[point[2]], 1.0]
        };
        let points = vec![corner(0.0, 0.0), corner(0.0, 1.0), corner(1.0, 0.0), corner(1.0, 1.0)];
        let mut net = Net { degree: [1, 1], points };
        if up == Up::Y {
            net = net.transposed();
        }
        let mesh = dice(&Word::from_nets("s", "P", &[net]).expect("a word"), 4).expect("a mesh");
        let options = Picture { up, camera: Camera::Top, ..small() };
        let image = render(&device, &queue, &mesh, &options).expect("a picture");
        let [left, top, right, bottom] = warm_box(&image).map(f64::from);
        assert!(
            ((right - left) / (bottom - top) - 2.0).abs() < 0.05,
            "{up:?}: {left} {top} {right} {bottom}"
        );
        assert!(((right - left) / f64::from(image.width) - 0.88).abs() < 0.02);
    }
}

#[test]
fn upright_and_the_right_way_round() {
    let Some((device, queue)) = device() else { return };
    // A leg along x and a mast along the up axis, seen from the front: an L.
    for up in [Up::Y, Up::Z] {
        let place = |x: f32, height: f32| match up {
            Up::Y => [x, height, 0.0],
            Up::Z => [x, 0.0, height],
        };
        let positions = [(0.0, 0.0), (2.0, 0.0), (2.0, 0.4), (0.0, 0.4), (0.4, 0.4), (0.4, 2.0), (0.0, 2.0)];
        let positions: Vec<[f32; 3]> = positions.into_iter().map(|(x, h)| place(x, h)).collect();
        let towards_viewer = if up == Up::Y { [0.0, 0.0, 1.0] } else { [0.0, -1.0, 0.0] };
        let mesh = Mesh {
            normals: vec![towards_viewer; positions.len()],
            uvs: vec![[0.0; 2]; positions.len()],
            positions,
            indices: vec![0, 1, 2, 0, 2, 3, 3, 4, 5, 3, 5, 6],
        };
        let camera = Camera::Around { azimuth: 0.0, elevation: 0.0 };
        let image = render(&device, &queue, &mesh, &Picture { up, camera, ..small() }).expect("a picture");
        let [left, top, right, bottom] = warm_box(&image);
        assert!(warmth(&image, left + 4, top + 4) > 12, "{up:?}: the mast stands on the left");
        assert!(warmth(&image, right - 4, bottom - 4) > 12, "{up:?}: the leg lies at the bottom");
        assert!(warmth(&image, right - 4, top + 4) < 12, "{up:?}");
    }
}

#[test]
fn borders_are_dark_lines() {
    let Some((device, queue)) = device() else { return };
    let word = word("teapot");
    let mesh = dice(&word, 8).expect("a mesh");
    let lines = grid::borders(&word, 8).expect("borders");
    assert_eq!(lines.len(), (32 * 4 - 8) * 8, "eight sides are collapsed");
    let plain = render(&device, &queue, &mesh, &Picture::default()).expect("a picture");
    let image = render(&device, &queue, &mesh, &Picture { lines, ..Picture::default() }).expect("a picture");
    keep("teapot-borders.png", &image);
    let pairs = image.pixels.chunks_exact(4).zip(plain.pixels.chunks_exact(4));
    let darker = pairs.filter(|(a, b)| i32::from(a[0]) + 40 < i32::from(b[0])).count();
    assert!((3_000..30_000).contains(&darker), "{darker}");
}

#[test]
fn every_leaf_in_its_color() {
    let Some((device, queue)) = device() else { return };
    let net = |x: f32| {
        let points = [[x, 0.0], [x + 1.0, 0.0], [x, 1.0], [x + 1.0, 1.0]];
        Net { degree: [1, 1], points: points.map(|[x, z]| [x, 0.0, z, 1.0]).to_vec() }
    };
    let word = Word::from_nets("two", "P", &[net(0.0), net(1.0)]).expect("a word");
    let colors = per_vertex(&word, 3, |leaf| [[200, 40, 40], [40, 40, 200]][leaf.root as usize]);
    let options = Picture { camera: Camera::Top, colors, ..small() };
    let image = render(&device, &queue, &dice(&word, 3).expect("a mesh"), &options).expect("a picture");
    let middle = image.height / 2;
    assert!(warmth(&image, image.width * 2 / 5, middle) > 80, "the left leaf is red");
    assert!(warmth(&image, image.width * 3 / 5, middle) < -80, "the right leaf is blue");
}

#[test]
fn supersampling_keeps_the_picture() {
    let Some((device, queue)) = device() else { return };
    let mesh = dice(&word("teapot"), 8).expect("a mesh");
    let plain = render(&device, &queue, &mesh, &small()).expect("a picture");
    let options = Picture { supersample: 3, ..small() };
    let fine = render(&device, &queue, &mesh, &options).expect("a picture");
    assert_eq!((fine.width, fine.height), (plain.width, plain.height));
    let far = |(a, b): (&u8, &u8)| a.abs_diff(*b) > 12;
    let differing = plain.pixels.iter().zip(&fine.pixels).filter(|pair| far(*pair)).count();
    assert!(differing < plain.pixels.len() / 20, "only edges differ: {differing}");
}

#[test]
fn vertices_without_normals_are_lit_too() {
    let Some((device, queue)) = device() else { return };
    let mut mesh = dice(&word("sheet"), 4).expect("a mesh");
    for absent in [[0.0; 3], [f32::NAN; 3]] {
        mesh.normals.fill(absent);
        let image = render(&device, &queue, &mesh, &small()).expect("a picture");
        let middle = warmth(&image, image.width / 2, image.height / 2);
        assert!(middle > 20, "{middle} with normals {absent:?}");
    }
}

#[test]
fn nothing_to_draw_is_a_background() {
    let Some((device, queue)) = device() else { return };
    let image = render(&device, &queue, &Mesh::default(), &small()).expect("a picture");
    assert!((0..image.width).all(|x| (0..image.height).all(|y| warmth(&image, x, y) <= 0)));
    // One point, and a flat line: nothing to see, but no reason to fail.
    let positions = vec![[3.0, 0.0, 0.0], [4.0, 0.0, 0.0], [5.0, 0.0, 0.0]];
    for indices in [vec![0, 0, 0], vec![0, 1, 2]] {
        let mesh = Mesh {
            normals: positions.clone(),
            uvs: vec![[0.0; 2]; 3],
            positions: positions.clone(),
            indices,
        };
        for camera in [Camera::default(), Camera::Top] {
            render(&device, &queue, &mesh, &Picture { camera, ..small() }).expect("a picture");
        }
    }
}

#[test]
fn what_is_refused() {
    let Some((device, queue)) = device() else { return };
    let mesh = dice(&word("sheet"), 2).expect("a mesh");
    let draw = |mesh: &Mesh, options: &Picture| render(&device, &queue, mesh, options).expect_err("refused");
    for (width, height) in [(0, 10), (10, 0), (8193, 10), (10, u32::MAX)] {
        let error = draw(&mesh, &Picture { width, height, ..small() });
        assert_eq!(error, Error::Size { width, height, max: 8192 });
    }
    let error = draw(&mesh, &Picture { width: 3000, supersample: 3, ..small() });
    assert_eq!(error, Error::Size { width: 3000, height: 180, max: 2730 });
    let error = draw(&mesh, &Picture { colors: vec![[0; 3]; 8], ..small() });
    assert_eq!(error, Error::Colors { positions: 9, colors: 8 });
    let mut bad = mesh.clone();
    bad.positions[5][1] = f32::NAN;
    assert_eq!(draw(&bad, &small()), Error::NotFinite { vertex: 5 });
    let mut bad = mesh.clone();
    bad.indices[4] = 9;
    assert_eq!(draw(&bad, &small()), Error::Index { index: 9, vertices: 9 });
    let mut bad = mesh.clone();
    bad.normals.pop();
    assert_eq!(draw(&bad, &small()), Error::Normals { positions: 9, normals: 8 });
    assert_eq!(
        draw(&mesh, &Picture { lines: vec![[0, 9]], ..small() }),
        Error::Index { index: 9, vertices: 9 }
    );
}

#[test]
fn the_shader_is_valid_without_any_extension() {
    let module = naga::front::wgsl::parse_str(include_str!("../wgsl/picture.wgsl")).expect("WGSL");
    let flags = naga::valid::ValidationFlags::all();
    naga::valid::Validator::new(flags, naga::valid::Capabilities::empty()).validate(&module).expect("valid");
}

#[test]
fn the_shader_translates_to_every_language() {
    use naga::back::{glsl, hlsl, msl, spv};
    use naga::proc::BoundsCheckPolicies;
    let module = naga::front::wgsl::parse_str(include_str!("../wgsl/picture.wgsl")).expect("WGSL");
    let mut validator =
        naga::valid::Validator::new(naga::valid::ValidationFlags::all(), naga::valid::Capabilities::empty());
    let info = validator.validate(&module).expect("valid");
    spv::write_vec(&module, &info, &spv::Options::default(), None).expect("SPIR-V");
    msl::write_string(&module, &info, &msl::Options::default(), &msl::PipelineOptions::default())
        .expect("MSL");
    let (options, pipeline) = (hlsl::Options::default(), hlsl::PipelineOptions::default());
    let mut text = String::new();
    hlsl::Writer::new(&mut text, &options, &pipeline).write(&module, &info, None).expect("HLSL");
    let options = glsl::Options { version: glsl::Version::new_gles(310), ..glsl::Options::default() };
    for entry in &module.entry_points {
        let pipeline = glsl::PipelineOptions {
            shader_stage: entry.stage,
            entry_point: entry.name.clone(),
            multiview: None,
        };
        let mut text = String::new();
        let policies = BoundsCheckPolicies::default();
        glsl::Writer::new(&mut text, &module, &info, &options, &pipeline, policies)
            .and_then(|mut writer| writer.write())
            .unwrap_or_else(|error| panic!("GLSL ES, {}: {error}", entry.name));
    }
}
