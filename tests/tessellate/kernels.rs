//! The kernels of a tessellation: valid for core WebGPU, translatable, in step with the host's structs,
//! each with a twin, and each broken on purpose.

use crate::shaders::{assert_translates, assert_within_default_limits, members, pairs};
use burgeon::codegen::{Shader, Tessellation, Tuning, tessellation};
use burgeon::tessellate::Options;
use burgeon::tessellate::budget::Budget;
use burgeon::tessellate::level::Target;
use burgeon::tessellate::vertex::{Format, Normal, Outputs, Position, Tangent, Uv};
use std::mem::offset_of;
use std::path::Path;

fn shaders(what: &Tessellation, tuning: &Tuning) -> Vec<Shader> {
    let s = tessellation(what, tuning).unwrap_or_else(|e| panic!("{what:?}: {e}"));
    let mut all = vec![
        s.begin,
        s.afford,
        s.decide,
        s.scan,
        s.split,
        s.advance,
        s.mark,
        s.tally,
        s.finish,
        s.vertices,
        s.triangles,
    ];
    all.extend(s.derived.into_iter().flatten());
    all
}

/// All attributes, in floats and packed.
pub fn formats() -> [Format; 3] {
    let whole = Format {
        position: Position::Float,
        normal: Some(Normal::Float),
        tangent: Some(Tangent::Float),
        uv: Some(Uv::Float),
        source: true,
        separate: false,
    };
    let packed = Format {
        position: Position::Snorm16 { middle: [0.0, 1.5, 0.0], extent: [4.0, 2.0, 3.0] },
        normal: Some(Normal::Octahedral),
        tangent: Some(Tangent::Snorm8),
        uv: Some(Uv::Unorm16),
        source: false,
        separate: false,
    };
    let bare = Format { normal: None, tangent: None, uv: None, source: false, ..whole };
    [whole, packed, bare]
}

#[test]
fn every_kernel_translates_and_keeps_to_default_limits() {
    for degree in pairs() {
        for (n, format) in formats().into_iter().enumerate() {
            let odd = (n + usize::from(degree[0])) % 2 == 1;
            let options = Options { format, seams: odd };
            let what = Tessellation { degree, rational: odd, word: !odd, derived: !odd, options };
            let tuning = if odd { Tuning::GPU } else { Tuning::CPU_DRIVER };
            for shader in shaders(&what, &tuning) {
                assert_within_default_limits(&shader);
                // The small kernels are the same for all degrees.
                if degree == [3, 3] || matches!(shader.name, "decide" | "vertices") {
                    assert_translates(&shader, &format!("{what:?}"));
                }
            }
        }
    }
}

/// With everything that an expression may see, on symbols or all.
#[test]
fn the_kernel_of_a_placement_translates_and_keeps_to_default_limits() {
    use super::placement::{HIGH, WILD, checkered, plan_of};
    for (n, plan) in [plan_of(WILD), plan_of(HIGH), checkered("P, Q").0].into_iter().enumerate() {
        let placement = plan.placement.expect("a placement");
        for (k, degree) in [[1, 1], [3, 3], [8, 2]].into_iter().enumerate() {
            let options = Options { format: formats()[k], seams: n == k };
            let what = Tessellation { degree, rational: k == 1, word: n == 2, derived: false, options };
            let tuning = if n == 1 { Tuning::GPU } else { Tuning::CPU_DRIVER };
            let shader =
                burgeon::codegen::vertices(&what, Some(&placement), &tuning, None).expect("a kernel");
            assert_within_default_limits(&shader);
            assert_translates(&shader, &format!("{what:?}"));
        }
    }
}

#[test]
fn structs_lie_in_wgsl_as_in_rust() {
    let what = Tessellation {
        degree: [3, 3],
        rational: false,
        word: true,
        derived: true,
        options: Options::default(),
    };
    let shaders = shaders(&what, &Tuning::GPU);
    let struct_of = |kernel: &str, name: &str| {
        let shader = shaders.iter().find(|s| s.name == kernel).expect(kernel);
        members(&shader.module, name).unwrap_or_else(|| panic!("{kernel} has no {name}"))
    };
    let (target, size) = struct_of("decide", "Target");
    let wanted = [
        ("clip", offset_of!(Target, clip)),
        ("half_size", offset_of!(Target, half)),
        ("near", offset_of!(Target, near)),
        ("tolerance", offset_of!(Target, tolerance)),
        ("keep", offset_of!(Target, keep)),
        ("pixels", offset_of!(Target, pixels)),
        ("least", offset_of!(Target, least)),
        ("most", offset_of!(Target, most)),
        ("budget", offset_of!(Target, budget)),
        ("reserved_0", offset_of!(Target, reserved)),
        ("reserved_1", offset_of!(Target, reserved) + 4),
        ("reserved_2", offset_of!(Target, reserved) + 8),
    ];
    assert_eq!(target, wanted.map(|(name, at)| (name.to_string(), at as u32)));
    assert_eq!(size as usize, size_of::<Target>());
    let (budget, size) = struct_of("afford", "Budget");
    let wanted = [
        ("coarser", offset_of!(Budget, coarser)),
        ("fits", offset_of!(Budget, fits)),
        ("triangles", offset_of!(Budget, triangles)),
        ("reserved", offset_of!(Budget, reserved)),
    ];
    assert_eq!(budget, wanted.map(|(name, at)| (name.to_string(), at as u32)));
    assert_eq!(size as usize, size_of::<Budget>());
    let (outputs, size) = struct_of("vertices", "Outputs");
    let places = offset_of!(Outputs, places) as u32;
    let wanted = [
        ("middle", offset_of!(Outputs, middle) as u32),
        ("extent", offset_of!(Outputs, extent) as u32),
        ("position", places),
        ("normal", places + 8),
        ("tangent", places + 16),
        ("uv", places + 24),
        ("source", places + 32),
        ("reserved", offset_of!(Outputs, padding) as u32),
    ];
    assert_eq!(outputs, wanted.map(|(name, at)| (name.to_string(), at)));
    assert_eq!(size as usize, size_of::<Outputs>());
    // A scan sees a range as an extent, and binds as much: both begin with the count.
    let (range, size) = struct_of("decide", "Range");
    assert_eq!((range[0].clone(), size), (("count".to_string(), 0), 32));
    let (extent, size) = struct_of("scan", "Extent");
    assert_eq!((extent[0].clone(), size), (("count".to_string(), 0), 48));
}

#[test]
fn every_kernel_has_a_twin_on_the_cpu() {
    let mut seen = 0;
    for entry in std::fs::read_dir("wgsl/tessellate").expect("the kernels") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            continue;
        }
        let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
        let text = std::fs::read_to_string(&path).expect("a kernel");
        assert!(text.starts_with("// ") && text.contains(&format!("fn {name}(")), "{name}.wgsl");
        // On the host a word that is none is refused before anything is changed.
        if name == "adopt" {
            continue;
        }
        let twin = format!("src/cpu/tessellate/{name}.rs");
        let twin = std::fs::read_to_string(Path::new(&twin)).expect(&twin);
        assert!(twin.contains(&format!("pub fn {name}(")), "{name}.rs");
        seen += 1;
    }
    assert_eq!(seen, 12);
}

#[test]
fn attributes_lie_as_the_format_says() {
    for format in formats() {
        for separate in [false, true] {
            let format = Format { separate, ..format };
            let places = format.places(100);
            let mut ends: Vec<(u64, u64)> = places
                .iter()
                .flatten()
                .map(|p| (p.offset, p.offset + if separate { 100 * p.stride } else { p.bytes }))
                .collect();
            ends.sort();
            assert!(ends.windows(2).all(|w| w[0].1 == w[1].0), "{format:?}: {places:?}");
            assert_eq!(ends[0].0, 0);
            let end = ends.last().expect("a position").1;
            assert_eq!(end, if separate { 100 * format.stride() } else { format.stride() });
            // Words of the vertex kernel are whole, and so are WebGPU's vertex formats.
            assert!(places.iter().flatten().all(|p| p.offset % 4 == 0 && p.stride % 4 == 0));
        }
    }
}
