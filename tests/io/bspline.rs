//! Grids of quads as the control points of uniform bicubic B-splines.

use burgeon::io::Problem::*;
use burgeon::io::obj::{GridError, parse_bspline};
use burgeon::io::{Element, Problem};
use burgeon::patch::{ControlGrid, Net};
use proptest::prelude::*;
use std::f64::consts::TAU;

/// The text of a grid of rows × columns control points, counter-clockwise from S_u × S_v.
fn text(rows: usize, columns: usize, closed: [bool; 2], point: impl Fn(usize, usize) -> [f64; 3]) -> String {
    let mut text = String::new();
    for (i, j) in (0..rows).flat_map(|i| (0..columns).map(move |j| (i, j))) {
        let [x, y, z] = point(i, j);
        text += &format!("v {x} {y} {z}\n");
    }
    for face in faces(rows, columns, closed) {
        text += &line(face);
    }
    text
}

fn faces(rows: usize, columns: usize, closed: [bool; 2]) -> Vec<[usize; 4]> {
    let index = |i: usize, j: usize| i % rows * columns + j % columns + 1;
    let [m, n] = [rows - usize::from(!closed[0]), columns - usize::from(!closed[1])];
    let cells = (0..m).flat_map(|i| (0..n).map(move |j| (i, j)));
    cells.map(|(i, j)| [index(i, j), index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)]).collect()
}

fn line([a, b, c, d]: [usize; 4]) -> String {
    format!("f {a} {b} {c} {d}\n")
}

fn nets(text: &str) -> Vec<Net> {
    parse_bspline(text.as_bytes(), false).unwrap_or_else(|e| panic!("{e}: {text}"))
}

fn problem(text: &str) -> (usize, usize, Problem) {
    let error = parse_bspline(text.as_bytes(), false).expect_err(text);
    (error.line, error.column, error.problem)
}

/// A hill, with no symmetry.
fn hilly(i: usize, j: usize) -> [f64; 3] {
    let (x, y) = (i as f64, j as f64);
    [x + 0.1 * (y * 1.7).sin(), y - 0.2 * (x * 0.9).cos(), (x * 1.3 + y * y * 0.4).sin()]
}

fn torus(i: usize, j: usize, rows: usize, columns: usize) -> [f64; 3] {
    let (a, b) = (TAU * i as f64 / rows as f64, TAU * j as f64 / columns as f64);
    let radius = 2.0 + b.cos();
    [radius * a.cos(), radius * a.sin(), b.sin()]
}

/// Control points at (i, j, 0) give the surface (u, v, 0), and its Bézier points lie at thirds.
#[test]
fn linear_precision() {
    let nets = nets(&text(6, 5, [false; 2], |i, j| [i as f64, j as f64, 0.0]));
    assert_eq!(nets.len(), 3 * 2);
    for (index, net) in nets.iter().enumerate() {
        let corner = [1 + index / 2, 1 + index % 2];
        assert_eq!(net.degree, [3, 3]);
        for (k, point) in net.points.iter().enumerate() {
            let expected =
                [corner[0] * 3 + k / 4, corner[1] * 3 + k % 4].map(|thirds| (thirds as f64 / 3.0) as f32);
            assert_eq!(*point, [expected[0], expected[1], 0.0, 1.0]);
        }
        assert_eq!(net.view().evaluate(0.5, 0.5).normal, [0.0, 0.0, 1.0]);
    }
}

/// The cubic B-spline by its recursion in f64: basis functions of the four points around a span.
fn basis(t: f64) -> [f64; 4] {
    let hat = |degree: usize, x: f64| -> f64 {
        fn b(degree: usize, x: f64) -> f64 {
            match degree {
                0 => f64::from(u8::from((0.0..1.0).contains(&x))),
                d => (x * b(d - 1, x) + (d as f64 + 1.0 - x) * b(d - 1, x - 1.0)) / d as f64,
            }
        }
        b(degree, x)
    };
    [t + 3.0, t + 2.0, t + 1.0, t].map(|x| hat(3, x))
}

#[test]
fn the_surface_of_the_definition() {
    let nets = nets(&text(6, 7, [false; 2], hilly));
    assert_eq!(nets.len(), 3 * 4);
    for (index, net) in nets.iter().enumerate() {
        let (i, j) = (index / 4, index % 4);
        for (u, v) in [(0.0, 0.0), (0.25, 0.75), (0.5, 0.125), (0.875, 0.5)] {
            let (a, b) = (basis(u), basis(v));
            assert!((a.iter().sum::<f64>() - 1.0).abs() < 1e-15);
            let position = net.view().evaluate(u, v).position;
            for axis in 0..3 {
                let at = |k: usize, l: usize| a[k] * b[l] * hilly(i + k, j + l)[axis];
                let expected: f64 = (0..16).map(|n| at(n / 4, n % 4)).sum();
                assert!((f64::from(position[axis]) - expected).abs() < 1e-5, "{position:?} {expected}");
            }
        }
    }
}

/// Nets side by side share a border bit for bit, and agree in the first and second derivative.
#[test]
fn borders_are_equal_and_smooth() {
    for closed in [[false, false], [true, false], [false, true], [true, true]] {
        let (rows, columns) = (5, 6);
        let nets = nets(&text(rows, columns, closed, hilly));
        let count = |points: usize, closed: bool| if closed { points } else { points - 3 };
        let (m, n) = (count(rows, closed[0]), count(columns, closed[1]));
        assert_eq!(nets.len(), m * n);
        let mut seams = 0;
        for (i, j) in (0..m).flat_map(|i| (0..n).map(move |j| (i, j))) {
            let here = &nets[i * n + j];
            if i + 1 < m || closed[0] {
                smooth(&here.transposed(), &nets[(i + 1) % m * n + j].transposed());
                seams += 1;
            }
            if j + 1 < n || closed[1] {
                smooth(here, &nets[i * n + (j + 1) % n]);
                seams += 1;
            }
        }
        let open = |spans: usize, closed: bool| if closed { spans } else { spans - 1 };
        assert_eq!(seams, open(m, closed[0]) * n + m * open(n, closed[1]));
    }
}

/// `right` follows `left` along v.
#[track_caller]
fn smooth(left: &Net, right: &Net) {
    for row in 0..4 {
        let p = |net: &Net, column: usize| net.points[4 * row + column];
        assert_eq!(p(left, 3).map(f32::to_bits), p(right, 0).map(f32::to_bits));
        for k in 0..3 {
            let ([a, b, c], [d, e]) = ([1, 2, 3].map(|i| p(left, i)[k]), [1, 2].map(|i| p(right, i)[k]));
            assert!(((c - b) - (d - c)).abs() < 1e-5, "the first derivative");
            assert!(((c - 2.0 * b + a) - (e - 2.0 * d + c)).abs() < 1e-5, "the second derivative");
        }
    }
}

#[test]
fn a_torus() {
    let text = text(8, 6, [true, true], |i, j| torus(i, j, 8, 6));
    let nets = nets(&text);
    assert_eq!(nets.len(), 48);
    for net in &nets {
        let sample = net.view().evaluate(0.5, 0.5);
        let [x, y, z] = sample.position.map(f64::from);
        // From the middle of the tube outwards, as the faces are wound.
        let outward = [x - 2.0 * x / x.hypot(y), y - 2.0 * y / x.hypot(y), z];
        let along: f64 = (0..3).map(|k| outward[k] * f64::from(sample.normal[k])).sum();
        assert!(along > 0.4, "{along}");
    }
}

#[test]
fn a_tube_may_close_along_either_direction() {
    let ring = |i: usize, j: usize| [f64::cos(i as f64), f64::sin(i as f64), j as f64];
    assert_eq!(nets(&text(3, 4, [true, false], ring)).len(), 3);
    assert_eq!(nets(&text(4, 3, [false, true], ring)).len(), 3);
    assert_eq!(nets(&text(3, 3, [true, true], ring)).len(), 9);
}

/// The first corner of the first face is where the rows begin, wherever it lies in the grid, and u
/// runs along its first edge.
#[test]
fn the_first_face_decides_how_rows_run() {
    let plain = text(5, 6, [false; 2], hilly);
    let expected = nets(&plain);
    let (head, _) = plain.split_once("f ").expect("faces");
    let mut turned = faces(5, 6, [false; 2]);
    for (index, face) in turned.iter_mut().enumerate() {
        face.rotate_left((index * 7 + 1) % 4);
    }
    // One that is not turned comes first.
    let first = turned.iter().position(|f| f == &faces(5, 6, [false; 2])[5]);
    assert_eq!(first, Some(5));
    turned.swap(0, 5);
    turned[3..].reverse();
    let shuffled = head.to_string() + &turned.iter().map(|f| line(*f)).collect::<String>();
    assert_eq!(nets(&shuffled), expected);
    // With its first edge along v, rows run the other way: the nets are turned by a right angle.
    turned[0].rotate_left(1);
    let quarter = head.to_string() + &turned.iter().map(|f| line(*f)).collect::<String>();
    let quarter = nets(&quarter);
    assert_eq!(quarter.len(), expected.len());
    let corners = |net: &Net| [0, 3, 12, 15].map(|k| net.points[k].map(f32::to_bits));
    let [a, b, c, d] = corners(&expected[0]);
    assert!(quarter.iter().any(|net| corners(net) == [c, a, d, b] || corners(net) == [b, d, a, c]));
}

#[test]
fn whatever_else_an_obj_says_is_passed_over() {
    let plain = text(4, 4, [false; 2], hilly);
    let expected = nets(&plain);
    let more = plain
        .lines()
        .map(|l| match l.split_once(' ') {
            Some(("v", rest)) => format!("v {rest} # a comment\n"),
            _ => {
                l.split(' ')
                    .map(|i| if i == "f" { "f".into() } else { format!(" {i}/1/2") })
                    .collect::<String>()
                    + "\r\n"
            }
        })
        .collect::<String>();
    let more = format!(
        "# a file\n\nmtllib m.mtl\no grid\ng one two\nusemtl red\ns 1\nvt 0 0\nvn 0 0 1\nl 1 2\n{more}"
    );
    assert_eq!(nets(&more), expected);
    // Colours, and vertices of no face.
    assert_eq!(nets(&format!("{plain}v 7 7 7 0.1 0.2 0.3\n")), expected);
    // Indices may count back.
    let back: String = plain
        .lines()
        .map(|l| match l.strip_prefix("f ") {
            Some(rest) => {
                let index = |i: &str| i.parse::<i64>().expect("an index") - 17;
                rest.split(' ').fold("f".to_string(), |face, i| format!("{face} {}", index(i))) + "\n"
            }
            None => format!("{l}\n"),
        })
        .collect();
    assert_eq!(nets(&back), expected);
}

#[test]
fn weights_need_rational_nets() {
    let plain = text(4, 4, [false; 2], |i, j| [i as f64, j as f64, 1.0]);
    let weighted = plain.replacen("v 1 1 1\n", "v 1 1 1 2\n", 1);
    let net = &parse_bspline(weighted.as_bytes(), true).expect("weights")[0];
    // The corner has 4/6 · 4/6 of that point, (2, 2, 2, 2) in homogeneous form.
    let expected = [1.0 + 4.0 / 9.0, 1.0 + 4.0 / 9.0, 1.0 + 4.0 / 9.0, 1.0 + 4.0 / 9.0];
    assert!(net.points[0].iter().zip(expected).all(|(a, b)| (f64::from(*a) - b).abs() < 1e-6), "{net:?}");
    let element = Element::VertexCoordinate { vertex: 6, axis: 3 };
    assert_eq!(problem(&weighted), (6, 9, NotOne { element, found: "2".into() }));
    assert_eq!(parse_bspline(plain.replace(" 1\nv", " 1 1\nv").as_bytes(), false).map(|n| n.len()), Ok(1));
}

#[test]
fn refusals_each_with_its_place() {
    let own = String::from;
    let grid = text(4, 4, [false; 2], hilly);
    let face = |n: usize| 16 + n;
    let swap = |from: &str, to: &str| grid.replacen(from, to, 1);
    let vertex = |vertex| Element::Vertex { vertex };
    let element = Element::Face { face: 1 };
    let table = [
        (own(""), 1, 1, Grid(GridError::NoFaces)),
        (own("v 0 0 0\n"), 1, 8, Grid(GridError::NoFaces)),
        (own("solid x\n"), 1, 1, Statement { found: own("solid") }),
        (own("v 0 0\n"), 1, 1, Vertex { vertex: vertex(1), found: 2 }),
        (own("v 0 0 0 1 1\n"), 1, 1, Vertex { vertex: vertex(1), found: 5 }),
        (
            own("v 0 0 0\nv 0 x 0\n"),
            2,
            5,
            NotANumber { expected: Element::VertexCoordinate { vertex: 2, axis: 1 }, found: own("x") },
        ),
        (
            own("v 0 inf 0\n"),
            1,
            5,
            NotFinite { element: Element::VertexCoordinate { vertex: 1, axis: 1 }, found: own("inf") },
        ),
        (swap("f 1 5 6 2", "f 1 5 x 2"), face(1), 7, Corner { face: element, found: own("x") }),
        (swap("f 1 5 6 2", "f 1 5 0 2"), face(1), 7, Corner { face: element, found: own("0") }),
        (swap("f 1 5 6 2", "f 1/ 5 6 2"), face(1), 3, Corner { face: element, found: own("1/") }),
        (swap("f 1 5 6 2", "f 1 5/1/1/1 6 2"), face(1), 5, Corner { face: element, found: own("5/1/1/1") }),
        (
            swap("f 1 5 6 2", "f 1 5 17 2"),
            face(1),
            7,
            NoVertex { face: element, found: own("17"), vertices: 16 },
        ),
        (
            swap("f 1 5 6 2", "f 1 5 -17 2"),
            face(1),
            7,
            NoVertex { face: element, found: own("-17"), vertices: 16 },
        ),
        (swap("f 1 5 6 2", "f 1 5 6"), face(1), 1, Grid(GridError::NotAQuad { face: 1, found: 3 })),
        (swap("f 1 5 6 2", "f"), face(1), 1, Grid(GridError::NotAQuad { face: 1, found: 0 })),
        (swap("f 1 5 6 2", "f 1 5 5 2"), face(1), 1, Grid(GridError::Repeated { face: 1, vertex: 5 })),
        (
            swap("f 2 6 7 3", "f 3 7 6 2"),
            face(2),
            1,
            Grid(GridError::Edge { face: 2, other: 1, from: 6, to: 2 }),
        ),
        (swap("f 1 5 6 2\n", ""), 6, 1, Grid(GridError::Border { vertex: 6, faces: 3 })),
        (swap("f 6 10 11 7\n", ""), 6, 1, Grid(GridError::Border { vertex: 6, faces: 3 })),
        (text(3, 3, [false; 2], hilly), 10, 1, Grid(GridError::Small { rows: 3, columns: 3 })),
    ];
    for (text, line, column, expected) in table {
        assert_eq!(problem(&text), (line, column, expected), "{text}");
    }
}

#[test]
fn faces_that_are_no_grid() {
    // A cube: three faces around every vertex.
    let cube = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n\
                f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
    assert_eq!(problem(cube), (1, 1, Grid(GridError::Inside { vertex: 1, faces: 3 })));
    // Two grids in one file.
    let grid = text(4, 4, [false; 2], hilly);
    let second: String = faces(4, 4, [false; 2]).iter().map(|f| line(f.map(|i| i + 16))).collect();
    let vertices: String = grid.lines().filter(|l| l.starts_with('v')).map(|l| format!("{l}\n")).collect();
    let two = format!("{vertices}{grid}{second}");
    assert_eq!(problem(&two), (42, 1, Grid(GridError::Apart { face: 10 })));
    // Two quads that touch at a corner.
    let pinched = format!("{vertices}f 1 5 6 2\nf 6 10 11 7\n");
    assert_eq!(problem(&pinched), (6, 1, Grid(GridError::Pinched { vertex: 6 })));
    // A torus of 5 × 4 whose last row meets the first one column on.
    let shift = |[a, b, c, d]: [usize; 4]| {
        let moved = |v: usize| if v <= 4 { v % 4 + 1 } else { v };
        if a > 16 { [a, moved(b), moved(c), d] } else { [a, b, c, d] }
    };
    let vertices: String = (0..20).map(|i| format!("v {i} 0 0\n")).collect();
    let shifted: String = faces(5, 4, [true; 2]).into_iter().map(shift).map(line).collect();
    let (.., found) = problem(&format!("{vertices}{shifted}"));
    assert!(matches!(found, Grid(GridError::Shifted { .. })), "{found}");
}

#[test]
fn grids_of_the_library() {
    let grid = |rows, columns, closed| ControlGrid {
        rows,
        columns,
        closed,
        points: (0..rows * columns).map(|k| [k as f64, 0.0, 0.0, 1.0]).collect(),
    };
    for (rows, columns, closed, nets) in [
        (4, 4, [false, false], 1),
        (3, 9, [false, false], 0),
        (3, 4, [true, false], 3),
        (2, 4, [true, false], 0),
        (0, 0, [true, true], 0),
    ] {
        assert_eq!(grid(rows, columns, closed).nets().len(), nets, "{rows} × {columns} {closed:?}");
    }
}

proptest! {
    #[test]
    fn no_text_panics(text in "((v|f|vt|#|g)( -?[0-9]{1,2}(/[0-9]?){0,3}){0,6}\n){0,30}", rational: bool) {
        let _ = parse_bspline(text.as_bytes(), rational);
    }

    /// Faces at random over few vertices.
    #[test]
    fn no_faces_panic(faces in prop::collection::vec(prop::array::uniform4(1usize..10), 1..12)) {
        let vertices = "v 0 0 0\n".repeat(9);
        let text = vertices + &faces.into_iter().map(line).collect::<String>();
        if let Err(error) = parse_bspline(text.as_bytes(), false) {
            prop_assert!(error.line <= text.lines().count());
        }
    }
}
