//! Curves from .svg, .csv and .obj, and their pictures.

use burgeon::curve::{Module, Word};
use burgeon::io::curves::{Line, Panel, Picture, Polyline, Style, csv, raster, svg};
use burgeon::io::{ParseError, obj};
use burgeon::language::system::{Field, Topology};
use burgeon::language::{Type, Value};
use burgeon::patch::Symbol;
use burgeon::tessellate::Up;
use proptest::prelude::*;

fn in_svg(body: &str) -> String {
    format!("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 9 9\">\n{body}\n</svg>\n")
}

#[track_caller]
fn read(body: &str) -> Vec<Vec<[f32; 2]>> {
    let curves = svg::parse(in_svg(body).as_bytes()).unwrap_or_else(|e| panic!("{body}: {e}"));
    curves.iter().map(|curve| curve.iter().map(|&[x, y, _, _]| [x, y]).collect()).collect()
}

#[test]
fn svg_shapes_of_lines() {
    let square = vec![[1.0, -1.0], [3.0, -1.0], [3.0, -2.0], [1.0, -2.0]];
    for body in [
        "<path d=\"M1 1 3 1 3 2 1 2\"/>",
        "<path d=\"M 1,1 L 3,1 L 3,2 L 1,2 Z\"/>",
        "<path d='M1 1h2v1H1z'/>",
        "<path d='m1 1 2 0 0 1-2 0z'/>",
        "<path d='M1,1\n  l2,0\n  V2\n  h-2\n  v-1 z'/>",
        "<path d='M1 1H3V2H1V1'/>",
        "<polygon points='1,1 3,1 3,2 1,2'/>",
        "<polyline points='1 1 3 1 3 2 1 2 1 1'/>",
        "<rect x='1' y='1' width='2px' height='1'/>",
        "<g transform='translate(1 1)'><g transform='scale(2 1)'><path d='M0 0H1V1H0Z'/></g></g>",
        "<rect width='2' height='1' transform='matrix(1 0 0 1 1 1)'/>",
        "<defs><circle r='2'/></defs><title>a square</title><text>x</text><path d='M1e0+1L3 1.0 3 .2e1 1 2'/>",
    ] {
        assert_eq!(read(body), std::slice::from_ref(&square), "{body}");
    }
    let turned = read("<line x1='1' x2='2' transform='rotate(90)'/>");
    assert!((0..2).all(|k| (turned[0][k][1] + (k + 1) as f32).abs() < 1e-6 && turned[0][k][0].abs() < 1e-6));
    // Subpaths are curves; a move alone is none, and behind a Z the pen is where the curve began.
    let path = "M9 9 M0 0 L1 0 M2 0 h1 z l1 1";
    let expected = [[[0.0, 0.0], [1.0, 0.0]], [[2.0, 0.0], [3.0, 0.0]], [[2.0, 0.0], [3.0, -1.0]]];
    assert_eq!(read(&format!("<path d='{path}'/>")), expected);
    // Points count from the first of the file.
    assert_eq!(read("<line x2='1'/><line x2='2'/>").len(), 2);
    let plain = "<?xml version='1.0'?><!DOCTYPE svg><svg><line x2='1'/></svg>";
    assert_eq!(svg::parse(plain.as_bytes()).expect("no namespace").len(), 1);
}

#[track_caller]
fn refused(read: Result<Vec<Polyline>, ParseError>, place: (usize, usize), says: &str) {
    let error = read.expect_err(says);
    assert_eq!((error.line, error.column), place, "{error}");
    assert!(error.to_string().contains(says), "{error}");
}

#[test]
fn svg_refusals() {
    // `^` stands before what is wrong.
    let cases = [
        ("<path d='M0 0\nL1 1\nC1 2 3 4 5 ^q'/>", "`q` stands where"),
        ("<path d='M0 0 A1 1 0 0 0 3 ^z'/>", "`z` stands where"),
        ("<path d='^L0 0'/>", "of which M is the first"),
        ("<path d='M0 0 L 1 ^x'/>", "`x` stands where"),
        ("<path d='M0 0 L ^nan 1'/>", "`nan` stands where"),
        ("<path d='M0 0 L 1^'/>", "the end of the value"),
        ("<path d='M0 0 L ^1e999 1'/>", "`1e999`"),
        ("<path d='M0 0 L 1 1\n 2 2 1e39 ^1'/>", "x of point 3 is `1e39`, beyond the range"),
        ("<polyline points='0 0 1^'/>", "3 numbers for points"),
        ("<polyline points='0 0 1 ^inf'/>", "`inf` stands where a coordinate should"),
        ("<polyline points='0 0\n 1 -^1e39'/>", "y of point 1 is `1e39`, beyond the range"),
        ("^<circle r='1'/>", "circle"),
        ("<g>^<use href='#a'/></g>", "use"),
        ("^<rect width='1' height='1' rx='0.1'/>", "round corners"),
        ("<rect width='^10%'/>", "width is `10%`"),
        ("<g transform='^turn(3)'/>", "transform is `turn(3)`"),
    ];
    for (marked, says) in cases {
        let before = marked.split('^').next().expect("a place");
        let column = before.chars().rev().take_while(|&c| c != '\n').count() + 1;
        let place = (before.matches('\n').count() + 2, column);
        refused(svg::parse(in_svg(&marked.replacen('^', "", 1)).as_bytes()), place, says);
    }
    for empty in ["<path d=''/>", "<path d='M1 2'/>", "<g/>"] {
        refused(svg::parse(in_svg(empty).as_bytes()), (1, 1), "draws no lines");
    }
    refused(svg::parse(in_svg("<path d=>").as_bytes()), (2, 9), "expected");
    refused(svg::parse(b" \n"), (1, 1), "empty");
    refused(svg::parse(b"<html/>"), (1, 1), "<html>");
    refused(svg::parse(b"<svg>\xff</svg>"), (1, 6), "UTF-8");
}

/// A circle as four arcs, as four cubic curves, and a parabola: on the curve within a thousandth, none left out.
#[test]
fn svg_curves_become_lines() {
    let round = [
        "M10 0A10 10 0 0 1 0 10 10 10 0 0 1 -10 0a10 10 0 0 1 10 -10A10 10 0 0 1 10 0Z",
        "M10 0C10 5.5228475 5.5228475 10 0 10S-10 5.5228475 -10 0c0 -5.5228475 4.4771525 -10 10 -10S10 -5.5228475 10 0z",
    ];
    for path in round {
        let curves = svg::parse(in_svg(&format!("<path d='{path}'/>")).as_bytes()).expect("a circle");
        let [circle] = &curves[..] else { panic!("{} curves", curves.len()) };
        assert!((48..200).contains(&circle.len()), "{}", circle.len());
        let pairs = circle.iter().zip(circle.iter().cycle().skip(1));
        for (a, b) in pairs {
            let middle = [(a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0];
            for [x, y] in [[a[0], a[1]], middle] {
                assert!((x.hypot(y) - 10.0).abs() < 0.02, "{x} {y} of {path}");
            }
        }
    }
    // y = x² from −1 to 3, drawn downwards, and its mirror image by T; in a transform that halves y.
    let d = "<g transform='scale(1 0.5)'><path d='M-1 1Q1 -3 3 9T7 17'/></g>";
    let curves = svg::parse(in_svg(d).as_bytes()).expect("two parabolas");
    assert!(curves[0].len() > 30 && curves[0].iter().any(|p| p[..2] == [3.0, -4.5]));
    for p in &curves[0] {
        let (x, y) = (p[0], -2.0 * p[1]);
        let expected = if x <= 3.0 { x * x } else { 18.0 - (6.0 - x) * (6.0 - x) };
        assert!((y - expected).abs() < 1e-4, "{x} {y}");
    }
    // A curve that is a point.
    let point = svg::parse(in_svg("<path d='M1 1C1 1 1 1 1 1L2 2'/>").as_bytes()).expect("a line");
    assert_eq!(point[0].first(), Some(&[1.0, -1.0, 0.0, 1.0]));
}

#[test]
fn other_refusals() {
    refused(csv::parse(b""), (1, 1), "ends where point 0 should");
    refused(csv::parse(b"x,y\n"), (2, 1), "ends where point 0 should");
    refused(csv::parse(b"1,2\n3,inf\n"), (2, 3), "y of point 1 is `inf`");
    refused(csv::parse(b"1,2\n3,1e39\n"), (2, 3), "beyond the range");
    refused(csv::parse(b"1,2\n3,NaN\n"), (2, 3), "finite");
    refused(csv::parse(b"1,2\n3\n"), (2, 1), "numbers in this row: 1, in the first: 2;");
    refused(csv::parse(b"1,2,3,4,5\n"), (1, 1), "numbers in this row: 5,");
    refused(csv::parse(b"1;2\n"), (1, 1), "`1;2`");
    refused(csv::parse(b"1,2\n3,\n"), (2, 3), "a number is needed");
    refused(obj::lines(b"# nothing\n"), (1, 10), "ends where vertex 1 should");
    refused(obj::lines(b"v 0 0 0\nv 0 nan 0\n"), (2, 5), "finite");
    refused(obj::lines(b"v 0 0\n"), (1, 1), "2 numbers for vertex 1");
    refused(obj::lines(b"v 0 0 0\nl 1 2\n"), (2, 5), "names the vertex 2, but the file has 1");
    // A point is a curve: alone it is its own neighbour.
    assert_eq!(csv::parse(b"1,2").expect("a point"), [[[1.0, 2.0, 0.0, 1.0]]]);
    assert_eq!(obj::lines(b"v 1 2 3").expect("a point"), [[[1.0, 2.0, 3.0, 1.0]]]);
    // A row as long as the file costs no more than to read it.
    let long = [b"1,".repeat(2_000_000), b"1\n".to_vec()].concat();
    refused(csv::parse(&long), (1, 1), "numbers in this row: 5,");
    let long = in_svg(&format!("<path d='M0 0L{}x'/>", "1 ".repeat(2_000_000)));
    refused(svg::parse(long.as_bytes()), (2, 4_000_015), "`x`");
    let deep = in_svg(&format!("{}<line x2='1'/>{}", "<g>".repeat(50_000), "</g>".repeat(50_000)));
    assert_eq!(svg::parse(deep.as_bytes()).expect("a line").len(), 1);
}

fn word(topology: Topology, points: &[[f32; 3]]) -> Word {
    let field = Field { name: "v".to_string(), ty: Type::Vec3 };
    let module = |(n, &p): (usize, &[f32; 3])| {
        let params = vec![Value::Vec3(p)];
        Module { symbol: 0, params, path: 0, parent: n.checked_sub(1), lateral: false }
    };
    Word {
        system: "s & <t>".to_string(),
        steps: 1,
        topology,
        symbols: vec![Symbol { name: "P".to_string(), fields: vec![field] }],
        modules: points.iter().enumerate().map(module).collect(),
    }
}

fn written(word: &Word, style: &Style) -> Vec<u8> {
    let mut text = Vec::new();
    svg::write(&mut text, &Picture::of(&[word], style).expect("finite points")).expect("memory");
    text
}

proptest! {
    #[test]
    fn what_is_drawn_is_read_again(
        points in prop::collection::vec(prop::array::uniform3(-1e30f32..1e30), 2..40),
        ring: bool,
        marked: bool,
    ) {
        let topology = if ring { Topology::Ring } else { Topology::Open };
        let text = written(&word(topology, &points), &Style { points: marked, ..Style::default() });
        let curves = svg::parse(&text).expect("what is written is read");
        let mut expected: Polyline = points.iter().map(|&[x, y, _]| [x, y, 0.0, 1.0]).collect();
        if expected.first() == expected.last() {
            expected.pop();
        }
        prop_assert_eq!(curves, [expected]);
    }
}

const CORNER: [[f32; 3]; 3] = [[0.0, 0.0, 0.0], [10.0, 0.0, 5.0], [10.0, 10.0, 0.0]];

#[test]
fn a_picture_has_margins_and_strokes_in_proportion() {
    for scale in [1e-20f32, 1.0, 1e20] {
        let points = CORNER.map(|p| p.map(|x| x * scale));
        let picture =
            Picture::of(&[&word(Topology::Open, &points)], &Style::default()).expect("finite points");
        let near = |x: f64, y: f64| (x / f64::from(scale) - y).abs() < 1e-5;
        assert!(picture.size.iter().all(|&side| near(side, 11.0)), "{:?}", picture.size);
        assert!(picture.corner.iter().all(|&x| near(x, -0.5)) && near(picture.strokes[0].width, 0.05));
    }
    let up = Style { up: Up::Z, ..Style::default() };
    let picture = Picture::of(&[&word(Topology::Open, &CORNER)], &up).expect("finite points");
    assert_eq!(picture.strokes[0].points, [[0.0, 0.0], [10.0, 5.0], [10.0, 0.0]]);
    let infinite = word(Topology::Open, &[[0.0; 3], [0.0, 0.0, f32::INFINITY]]);
    let error = Picture::of(&[&infinite], &Style::default()).expect_err("no such point");
    assert!(error.to_string().contains("point 1"), "{error}");
}

#[test]
fn the_svg_says_what_it_shows() {
    let control =
        vec![Line { points: vec![[0.0, 0.0, 0.0], [12.0, 0.0, 0.0]], closed: true, widths: Vec::new() }];
    let style = Style { points: true, ..Style::default() };
    let ring = word(Topology::Ring, &CORNER);
    let picture =
        Picture::sheet(&[Panel { words: vec![&ring], control }], None, &style).expect("finite points");
    let mut text = Vec::new();
    svg::write(&mut text, &picture).expect("memory");
    let text = String::from_utf8(text).expect("UTF-8");
    assert!(text.contains("<title>s &amp; &lt;t></title>"), "{text}");
    assert!(text.contains(" -10.6 13.2 11.2\""), "{text}");
    assert!(text.contains("M 0.0 0.0 10.0 0.0 10.0 -10.0 Z"), "{text}");
    assert_eq!(text.matches("<path").count(), 2);
    assert_eq!(text.matches("url(#point)").count(), 3);
}

/// Red, green and blue where a point is.
fn pixel(picture: &Picture, side: u32, at: [f64; 2]) -> [u8; 3] {
    let image = raster::draw(picture, side);
    let scale = f64::from(side) / picture.size[0].max(picture.size[1]);
    let (x, y) = (at[0] - picture.corner[0], picture.corner[1] + picture.size[1] - at[1]);
    let [r, g, b, a] = image.pixel((x * scale) as u32, (y * scale) as u32).expect("inside");
    assert_eq!(a, 255);
    [r, g, b]
}

#[test]
fn the_png_shows_the_same() {
    let of = |word: &Word, style: &Style| Picture::of(&[word], style).expect("finite points");
    let plain = of(&word(Topology::Open, &CORNER), &Style { stroke: 0.02, ..Style::default() });
    let (ink, white) = ([31, 95, 107], [255; 3]);
    assert_eq!([pixel(&plain, 400, [5.0, 0.0]), pixel(&plain, 400, [10.0, 5.0])], [ink; 2]);
    // Not closed, and y is up.
    assert_eq!([pixel(&plain, 400, [5.0, 5.0]), pixel(&plain, 400, [2.0, 8.0])], [white; 2]);
    let style = Style { stroke: 0.02, points: true, ..Style::default() };
    let ring = of(&word(Topology::Ring, &CORNER), &style);
    assert_eq!(pixel(&ring, 400, [5.0, 5.0]), ink);
    assert_eq!(pixel(&ring, 400, [10.0, 10.0]), [180, 71, 47]);
    // Edges are smooth: there are pixels between ink and white.
    let image = raster::draw(&plain, 97);
    assert!((image.width, image.height) == (97, 97) && image.pixels.len() == 97 * 97 * 4);
    assert!(image.pixels.chunks(4).any(|p| p[0] > 40 && p[0] < 240));
}

#[test]
fn long_strokes_have_no_gaps() {
    // A circle of far more points than one piece of a path holds, and far more than pixels.
    for count in [3_000, 200_000] {
        let at = |n: usize| (n as f32 / count as f32 * std::f32::consts::TAU).sin_cos();
        let points: Vec<[f32; 3]> = (0..count).map(at).map(|(y, x)| [x, y, 0.0]).collect();
        let picture =
            Picture::of(&[&word(Topology::Ring, &points)], &Style { stroke: 0.01, ..Style::default() });
        let picture = picture.expect("finite points");
        for n in 0..360 {
            let (y, x) = f64::from(n).to_radians().sin_cos();
            let [red, ..] = pixel(&picture, 300, [x, y]);
            assert!(red < 160, "{red} at {n}° of {count}");
        }
    }
}

#[test]
fn words_of_nothing_and_of_one_point_are_drawn() {
    for points in [&[][..], &[[3.0, 4.0, 5.0]]] {
        for topology in [Topology::Ring, Topology::Open] {
            let style = Style { points: true, ..Style::default() };
            let picture = Picture::of(&[&word(topology, points)], &style).expect("finite points");
            assert_eq!(raster::draw(&picture, 50).pixels.len(), 50 * 50 * 4);
            assert!(!written(&word(topology, points), &style).is_empty());
        }
    }
}

/// A tree: a trunk that thins out, and a branch from its second point.
#[test]
fn a_tree_is_a_line_for_each_axis() {
    let fields = vec![
        Field { name: "v".to_string(), ty: Type::Vec2 },
        Field { name: "r".to_string(), ty: Type::Float },
    ];
    let module = |(p, r, parent, lateral): ([f32; 2], f32, Option<usize>, bool)| {
        let params = vec![Value::Vec2(p), Value::Float(r)];
        Module { symbol: 0, params, path: 0, parent, lateral }
    };
    let all = [
        ([0.0, 0.0], 2.0, None, false),
        ([0.0, 1.0], 2.0, Some(0), false),
        ([1.0, 2.0], 1.0, Some(1), true),
        ([2.0, 3.0], 1.0, Some(2), false),
        ([0.0, 2.0], 0.5, Some(1), false),
    ];
    let tree = Word {
        symbols: vec![Symbol { name: "P".to_string(), fields }],
        modules: all.map(module).to_vec(),
        ..word(Topology::Tree, &[])
    };
    let lines = burgeon::io::curves::lines(&tree);
    let points: Vec<Vec<[f32; 3]>> = lines.iter().map(|line| line.points.clone()).collect();
    let (trunk, branch) =
        ([[0.0; 3], [0.0, 1.0, 0.0], [0.0, 2.0, 0.0]], [[0.0, 1.0, 0.0], [1.0, 2.0, 0.0], [2.0, 3.0, 0.0]]);
    assert_eq!(points, [trunk, branch]);
    let picture = Picture::of(&[&tree], &Style::default()).expect("finite points");
    let widths: Vec<(usize, f64)> = picture.strokes.iter().map(|s| (s.points.len(), s.width)).collect();
    assert_eq!(widths, [(2, 2.0), (2, 0.5), (3, 1.0)]);
    let mut text = Vec::new();
    obj::write_lines(&mut text, &[&tree]).expect("memory");
    assert_eq!(obj::lines(&text).expect("what is written").len(), 2);
}

#[test]
fn a_sheet_has_a_place_for_each_word() {
    // Of different sizes, far apart.
    let sides = [4.0f32, 2.0, 1.0, 3.0, 0.0];
    let square = |(n, &side): (usize, &f32)| {
        let [x, y] = [100.0 * n as f32, -50.0];
        word(
            Topology::Ring,
            &[[x, y, 0.0], [x + side, y, 0.0], [x + side, y + side, 0.0], [x, y + side, 0.0]],
        )
    };
    let words: Vec<Word> = sides.iter().enumerate().map(square).collect();
    let panels: Vec<Panel> =
        words.iter().map(|word| Panel { words: vec![word], ..Panel::default() }).collect();
    let sheet = Picture::sheet(&panels, Some(2), &Style::default()).expect("finite points");
    // A gap of 0.12 of the largest side, 4; strokes and margins in proportion to that side.
    let left: Vec<[f32; 2]> = sheet.strokes.iter().map(|stroke| stroke.points[0]).collect();
    // The columns are 4 and 3 wide, the rows 4, 3 and 0 high.
    let rows = [3.96, 3.96, 0.48, 0.48, 0.0];
    let columns = [0.0, 4.48 + 0.5, 1.5, 4.48, 2.0];
    for (n, at) in left.iter().enumerate() {
        assert!((at[0] - columns[n]).abs() < 1e-5 && (at[1] - rows[n]).abs() < 1e-5, "{n}: {at:?}");
    }
    assert!((sheet.size[0] - 7.88).abs() < 1e-5 && (sheet.size[1] - 8.36).abs() < 1e-5, "{:?}", sheet.size);
    assert!(sheet.strokes.iter().all(|stroke| (stroke.width - 0.02).abs() < 1e-6));
    // Nobody has said how many columns: about 3 to 2, and no place is left over.
    for (count, columns, rows) in [(3, 3, 1), (6, 3, 2), (9, 3, 3), (10, 5, 2), (13, 5, 3), (100, 10, 10)] {
        let panels = vec![panels[0].clone(); count];
        let [width, height] = Picture::sheet(&panels, None, &Style::default()).expect("finite points").size;
        let side = |n: u32| 0.4 + 4.48 * f64::from(n) - 0.48;
        assert!((width - side(columns)).abs() < 1e-5 && (height - side(rows)).abs() < 1e-5, "{count}");
    }
}

#[test]
fn several_words_are_one_file() {
    let words = [word(Topology::Ring, &CORNER), word(Topology::Ring, &CORNER[..2])];
    let all: Vec<&Word> = words.iter().collect();
    let expected: Vec<usize> = words.iter().map(|word| word.modules.len()).collect();
    let mut text = Vec::new();
    csv::write(&mut text, &all).expect("memory");
    let read = csv::parse(&text).expect("what is written is read");
    assert_eq!(read.iter().map(Vec::len).collect::<Vec<_>>(), expected);
    let mut text = Vec::new();
    obj::write_lines(&mut text, &all).expect("memory");
    let read = obj::lines(&text).expect("what is written is read");
    assert_eq!(read.iter().map(Vec::len).collect::<Vec<_>>(), expected);
    let text = String::from_utf8(text).expect("UTF-8");
    assert!(text.contains("o s & <t>_0\n") && text.contains("o s & <t>_1\n"), "{text}");
    let infinite = word(Topology::Open, &[[0.0; 3], [0.0, 0.0, f32::INFINITY]]);
    let wrong = [&words[0], &infinite];
    let said = [
        csv::write(&mut Vec::new(), &wrong).expect_err("no such number").to_string(),
        obj::write_lines(&mut Vec::new(), &wrong).expect_err("no such number").to_string(),
    ];
    assert_eq!(
        said,
        ["module 1 of word 1", "point 1 of word 1"]
            .map(|element| { format!("{element} holds inf, which is not a finite number") })
    );
}
