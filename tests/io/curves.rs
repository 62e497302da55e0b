//! Curves from .svg, .csv and .obj, and their pictures.

use super::{in_svg, refused};
use burgeon::curve::{Module, Word};
use burgeon::io::curves::{self, Line, Panel, Picture, Polyline, Style, csv, raster, svg};
use burgeon::io::obj;
use burgeon::language::system::{Field, Topology};
use burgeon::language::{Type, Value};
use burgeon::tessellate::Up;
use burgeon::word::{Params, Symbol};
use proptest::prelude::*;

#[test]
fn other_refusals() {
    let cases: [(&str, usize, (usize, usize), &str); 31] = [
        ("", 4, (1, 1), "ends where point 0 should"),
        ("x,y\n", 2, (2, 1), "ends where point 0 should"),
        ("1,2\n3,inf\n", 2, (2, 3), "y of point 1 is `inf`"),
        ("1,2\n3,1e39\n", 2, (2, 3), "beyond the range"),
        ("1,2\n3,NaN\n", 2, (2, 3), "finite"),
        // No names of columns.
        ("nan,2\n3,4\n", 2, (1, 1), "x of point 0 is `nan`"),
        ("Infinity,2\n3,4\n", 2, (1, 1), "x of point 0 is `Infinity`"),
        ("inf , nan\n3,4\n", 2, (1, 1), "x of point 0 is `inf`"),
        ("a,2\n3,4\n", 2, (1, 1), "`a` stands where x of point 0 should"),
        ("x,y\nx,y\n", 2, (2, 1), "`x` stands where x of point 0 should"),
        ("1,2\n3\n", 2, (2, 1), "columns of this row: 1, of the first: 2"),
        ("1,2\n3,4,5\n", 3, (2, 1), "columns of this row: 3, of the first: 2"),
        ("1,2,3,4,5\n", 4, (1, 1), "5 columns where a point is x,y or x,y,z or x,y,z,w"),
        ("1;2\n", 3, (1, 1), "1 column where a point is x,y or x,y,z, with commas between"),
        ("1 2\n", 2, (1, 1), "1 column where a point is x,y, with commas between"),
        ("1,2\n3,\n", 2, (2, 3), "a number is needed"),
        // Decimal commas, and columns that are no coordinates.
        ("0,5,1,5\n", 2, (1, 1), "4 columns where a point is x,y, with commas"),
        ("0,5,1,5\n", 3, (1, 1), "points in decimals, as in 0.5,1.5"),
        ("x,y\n0,5,1\n", 2, (2, 1), "3 columns where"),
        (
            "\"0,5\",\"1,5\"\n",
            2,
            (1, 1),
            "`0,5` stands where x of point 0 should: a number is written with a point",
        ),
        ("x,y\n\"0.5\",\"1,5\"\n", 2, (2, 7), "`1,5` stands where y of point 0 should"),
        ("\"0,5\";\"1,5\"\n", 2, (1, 1), "`\"0,5\";\"1` stands where"),
        ("\"0.5,1\n1,2\n", 2, (1, 1), "`\"0.5` stands where"),
        ("a,b,c\n3,4\n", 3, (2, 1), "columns of this row: 2, of the row of their names: 3"),
        ("x\n0,0\n", 2, (2, 1), "columns of this row: 2, of the row of their names: 1"),
        ("x,y,z\n0,0\n", 3, (2, 1), "of their names: 3"),
        ("\"x, across\"\n0,0\n", 2, (2, 1), "of their names: 1"),
        ("id,x,y\n1,0,0\n", 3, (1, 1), "the columns are id,x,y; they should be x,y or x,y,z, in this order"),
        ("x,y,id\n0,0,1\n", 3, (1, 5), "the columns are x,y,id"),
        ("y,x\n0,0\n", 2, (1, 1), "the columns are y,x"),
        ("symbol,v.x,v.y\nP,0,0\n", 3, (1, 1), "the columns are symbol,v.x,v.y"),
    ];
    for (text, coordinates, place, says) in cases {
        refused(csv::parse(text.as_bytes(), coordinates), place, says);
    }
    for names in ["x,y", "X, Y", "\"x\",\"y\"", "v.x,v.y", "x [mm],y [mm]", "lon,lat", "#x,y", "größe,höhe"]
    {
        let text = format!("{names}\n1,2\n");
        let read = csv::parse(text.as_bytes(), 2).unwrap_or_else(|e| panic!("{names}: {e}"));
        assert_eq!(read, [Polyline::from(vec![[1.0, 2.0, 0.0, 1.0]])], "{names}");
    }
    // Spreadsheets may put all into quotes, and a first row of quoted numbers is a point.
    for text in [
        "\"0.5\",\"1.5\"\n2.5,3.5",
        "\"x\",\"y\"\n\"0.5\",\"1.5\"\r\n \" 2.5\" ,\"3.5\"\r\n",
        "\"a, b\",\"\"\"b\"\"\"\n0.5,\"1.5\"\n2.5,3.5\n",
    ] {
        let read = csv::parse(text.as_bytes(), 2).unwrap_or_else(|e| panic!("{text}: {e}"));
        assert_eq!(read, [Polyline::from(vec![[0.5, 1.5, 0.0, 1.0], [2.5, 3.5, 0.0, 1.0]])], "{text}");
    }
    refused(obj::lines(b"# nothing\n"), (1, 10), "ends where vertex 1 should");
    refused(obj::lines(b"v 0 0 0\nv 0 nan 0\n"), (2, 5), "finite");
    refused(obj::lines(b"v 0 0\n"), (1, 1), "2 numbers for vertex 1");
    refused(obj::lines(b"v 0 0 0\nl 1 2\n"), (2, 5), "names the vertex 2, but the file has 1");
    // A point is a curve: alone it is its own neighbour.
    assert_eq!(csv::parse(b"1,2", 2).expect("a point"), [Polyline::from(vec![[1.0, 2.0, 0.0, 1.0]])]);
    assert_eq!(obj::lines(b"v 1 2 3").expect("a point").value, [Polyline::from(vec![[1.0, 2.0, 3.0, 1.0]])]);
    // A row as long as the file costs no more than to read it.
    let long = [b"1,".repeat(2_000_000), b"1\n".to_vec()].concat();
    refused(csv::parse(&long, 4), (1, 1), "100 columns or more where");
    let long = in_svg(&format!("<path d='M0 0L{}x'/>", "1 ".repeat(2_000_000)));
    refused(svg::parse(long.as_bytes()), (2, 4_000_015), "`x`");
    let deep = in_svg(&format!("{}<line x2='1'/>{}", "<g>".repeat(50_000), "</g>".repeat(50_000)));
    assert_eq!(svg::parse(deep.as_bytes()).expect("a line").value.len(), 1);
}

fn word(topology: Topology, points: &[[f32; 3]]) -> Word {
    let field = Field { name: "v".to_string(), ty: Type::Vec3 };
    let symbols = vec![Symbol { name: "P".to_string(), fields: vec![field] }];
    let mut params = Params::new(&symbols);
    let module = |(n, &p): (usize, &[f32; 3])| {
        let row = params.push(0, &[Value::Vec3(p)]).expect("a point");
        Module { symbol: 0, row, path: 0, parent: n.checked_sub(1), lateral: false }
    };
    let modules = points.iter().enumerate().map(module).collect();
    Word { system: "s & <t>".to_string(), steps: 1, topology, symbols, modules, params }
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
        let curves = svg::parse(&text).expect("what is written is read").value;
        let mut expected: Vec<[f32; 4]> = points.iter().map(|&[x, y, _]| [x, y, 0.0, 1.0]).collect();
        if expected.first() == expected.last() {
            expected.pop();
        }
        prop_assert_eq!(curves, [Polyline { points: expected, closed: Some(ring) }]);
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
    let symbols = vec![Symbol { name: "P".to_string(), fields }];
    let mut params = Params::new(&symbols);
    let module = |(p, r, parent, lateral): ([f32; 2], f32, Option<usize>, bool)| {
        let row = params.push(0, &[Value::Vec2(p), Value::Float(r)]).expect("a point and a width");
        Module { symbol: 0, row, path: 0, parent, lateral }
    };
    let all = [
        ([0.0, 0.0], 2.0, None, false),
        ([0.0, 1.0], 2.0, Some(0), false),
        ([1.0, 2.0], 1.0, Some(1), true),
        ([2.0, 3.0], 1.0, Some(2), false),
        ([0.0, 2.0], 0.5, Some(1), false),
    ];
    let modules = all.map(module).to_vec();
    let tree = Word { symbols, modules, params, ..word(Topology::Tree, &[]) };
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
    assert_eq!(obj::lines(&text).expect("what is written").value.len(), 2);
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
    let read = csv::parse(&text, 3).expect("what is written is read");
    assert_eq!(read.iter().map(|curve| curve.points.len()).collect::<Vec<_>>(), expected);
    let mut text = Vec::new();
    obj::write_lines(&mut text, &all).expect("memory");
    let read = obj::lines(&text).expect("what is written is read").value;
    assert!(read.iter().all(|curve| curve.closed == Some(true)));
    assert_eq!(read.iter().map(|curve| curve.points.len()).collect::<Vec<_>>(), expected);
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

/// What closes a polygon in a table stands at both of its ends; a module without parameters has a row, too.
#[test]
fn csv_of_polygons_and_of_symbols() {
    let square = csv::parse(b"0,0\n1,0\n1,1\n0,0\n\n2,2\n3,3\n2,2\n", 2).expect("two curves");
    assert_eq!((square[0].points.len(), square[0].closed), (3, Some(true)));
    assert_eq!((square[1].points.len(), square[1].closed), (3, None));
    let symbol = |name: &str| Symbol { name: name.to_string(), fields: Vec::new() };
    let module = |symbol| Module { symbol, row: 0, path: 0, parent: None, lateral: false };
    let of = |names: &[&str], modules: &[usize]| {
        let symbols: Vec<Symbol> = names.iter().map(|name| symbol(name)).collect();
        let (params, modules) = (Params::new(&symbols), modules.iter().copied().map(module).collect());
        Word { symbols, params, modules, ..word(Topology::Open, &[]) }
    };
    let (one, two) = (of(&["F"], &[0, 0]), of(&["F", "G"], &[0, 1]));
    for (words, expected) in [
        (vec![&one], "symbol\nF\nF\n"),
        (vec![&one, &one], "symbol\nF\nF\n\nF\nF\n"),
        (vec![&two], "symbol\nF\nG\n"),
    ] {
        let mut text = Vec::new();
        csv::write(&mut text, &words).expect("memory");
        assert_eq!(String::from_utf8_lossy(&text), expected);
        refused(csv::parse(&text, 3), (2, 1), "1 column where");
    }
}

/// Encodings and ends of lines are a matter of files, whatever their format.
#[test]
fn files_are_in_other_encodings() {
    let folder = tempfile::tempdir().expect("a folder");
    let read = |file: &str, bytes: &[u8]| {
        let path = folder.path().join(file);
        std::fs::write(&path, bytes).expect("written");
        curves::read(&path, 3).map(|read| read.value[0].points.len()).map_err(|e| e.to_string())
    };
    let utf16 = |text: &str, mark: &[u8], bytes: fn(u16) -> [u8; 2]| -> Vec<u8> {
        mark.iter().copied().chain(text.encode_utf16().flat_map(bytes)).collect()
    };
    for (file, text) in [
        ("a.csv", "größe,höhe\n0,0\n1,0\n2,0\n"),
        ("a.obj", "# 𝄞\nv 0 0 0\nv 1 0 0\nv 2 0 0\nl 1 2 3\n"),
        (
            "a.svg",
            "<?xml version=\"1.0\" encoding=\"UTF-16\"?>\n<svg><polyline points='0 0 1 0 2 0'/></svg>\n",
        ),
    ] {
        for bytes in [
            text.as_bytes().to_vec(),
            [b"\xef\xbb\xbf", text.as_bytes()].concat(),
            utf16(text, b"\xff\xfe", u16::to_le_bytes),
            utf16(text, b"\xfe\xff", u16::to_be_bytes),
            utf16(text, b"", u16::to_le_bytes),
            utf16(text, b"", u16::to_be_bytes),
            text.replace('\n', "\r").into_bytes(),
            text.replace('\n', "\r\n").into_bytes(),
            text.replace('\n', "\r\r\n").into_bytes(),
        ] {
            assert_eq!(read(file, &bytes), Ok(3), "{file}: {:?}", String::from_utf8_lossy(&bytes));
        }
    }
    // Places are those of what an editor shows.
    for (bytes, says) in [
        (&b"0,0\r1,x\r"[..], "a.csv:2:3: `x` stands where"),
        (b"\xef\xbb\xbf0,x\n", "a.csv:1:3: `x` stands where"),
        (b"\xff\xfe1\0,", "a.csv:1:1: the file is in UTF-16, which is broken in places: save it as UTF-8"),
        (b"\xff\xfe\0\xd8", "the file is in UTF-16, which is broken"),
        (b"\xff\xfe\0\0x\0\0\0", "a.csv:1:1: the file is in UTF-32: save it as UTF-8"),
    ] {
        let error = read("a.csv", bytes).expect_err(says);
        assert!(error.contains(says), "{error}");
    }
    // An empty row ends a curve, however rows end.
    let path = folder.path().join("b.csv");
    std::fs::write(&path, "0,0\r1,0\r\r2,0\r").expect("written");
    assert_eq!(curves::read(&path, 2).expect("two curves").value.len(), 2);
}
