//! Which elements of an `.svg` are read, where they stand, and what is told of the others.

use super::{in_svg, refused};
use burgeon::io::Noted;
use burgeon::io::curves::{Polyline, svg};

#[track_caller]
fn all(body: &str) -> Noted<Vec<Polyline>> {
    svg::parse(in_svg(body).as_bytes()).unwrap_or_else(|e| panic!("{body}: {e}"))
}

#[track_caller]
fn read(body: &str) -> Vec<Vec<[f32; 2]>> {
    all(body).value.iter().map(|curve| curve.points.iter().map(|&[x, y, _, _]| [x, y]).collect()).collect()
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
    assert_eq!(svg::parse(plain.as_bytes()).expect("no namespace").value.len(), 1);
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
        ("<path d='M0 0 A1 1 0 0 ^2 3 3'/>", "`2` stands where a flag of an arc should, which is 0 or 1"),
        ("<path d='M0 0 a1 1 0 ^-1 0 3 3'/>", "`-1` stands where a flag of an arc should"),
        ("<path d='M0 0 a1 1 0 0 0 3 3 1 1 0 1^.5 1 1'/>", "`.5` stands where a flag"),
        ("<path d='M0 0 A1 1 0 0 0 ^1e400 3'/>", "`1e400` is beyond the range"),
        ("<path d='M0 0h^-1e400v1'/>", "`-1e400` is beyond the range"),
        ("<path d='M0 0z ^2'/>", "`2` stands where a number or one of the path commands"),
        ("<polygon points='0,0 ^1e400,1'/>", "`1e400` is beyond the range"),
        (
            "<g style='^transform: rotate3d(1,1,1,45deg)'/>",
            "transform is `rotate3d(1,1,1,45deg)`: a transform is made",
        ),
        ("<style>.a{transform:perspective(3px)}</style>^<g class='a'/>", "transform is `perspective(3px)`"),
        ("<g style='^rotate: 45deg'/>", "rotate is `45deg`: it is not read; the property transform is"),
        (
            "<g transform='scale(2)' style='^transform-box:fill-box;transform-origin:center'/>",
            "transform-box is `fill-box`: only view-box is read",
        ),
        // The point that stays is a corner of the box.
        ("<g transform='scale(2)' transform-box='^fill-box'/>", "transform-box is `fill-box`: only view-box"),
        (
            "<g transform='scale(2)' transform-origin='^1em 0'/>",
            "transform-origin is `1em 0`: it is not read unless",
        ),
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
        let curves = svg::parse(in_svg(&format!("<path d='{path}'/>")).as_bytes()).expect("a circle").value;
        let [circle] = &curves[..] else { panic!("{} curves", curves.len()) };
        assert_eq!(circle.closed, Some(true));
        let circle = &circle.points;
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
    let curves = read(d);
    assert!(curves[0].len() > 30 && curves[0].contains(&[3.0, -4.5]));
    for p in &curves[0] {
        let (x, y) = (p[0], -2.0 * p[1]);
        let expected = if x <= 3.0 { x * x } else { 18.0 - (6.0 - x) * (6.0 - x) };
        assert!((y - expected).abs() < 1e-4, "{x} {y}");
    }
    // A curve that is a point.
    assert_eq!(read("<path d='M1 1C1 1 1 1 1 1L2 2'/>"), [[[1.0, -1.0], [2.0, -2.0]]]);
}

/// A line from the origin that many units to the right, by which it is known.
#[track_caller]
fn lengths(body: &str) -> Vec<f32> {
    read(body).iter().map(|line| line[1][0] - line[0][0]).collect()
}

#[test]
fn what_is_not_rendered_is_not_read() {
    for (body, expected) in [
        ("<g style='display:none'><path d='M9 9h9'/></g><path d='M0 0h1'/>", &[1.0][..]),
        ("<line x2='2' display='none'/><line x2='1'/>", &[1.0]),
        ("<line x2='2' style='fill:red; DISPLAY : None ;'/><line x2='1'/>", &[1.0]),
        ("<line x2='2' visibility='hidden'/><line x2='3' visibility='collapse'/><line x2='1'/>", &[1.0]),
        ("<g visibility='hidden'><line x2='2'/><g><line x2='1' visibility='visible'/></g></g>", &[1.0]),
        ("<g style='visibility:hidden'><line x2='2'/><line x2='1' style='visibility:visible'/></g>", &[1.0]),
        // display has no way back.
        ("<g display='none'><line x2='2' display='inline' visibility='visible'/></g><line x2='1'/>", &[1.0]),
        ("<style>.st0{display:none;}</style><g class='st0'><line x2='2'/></g><line x2='1'/>", &[1.0]),
        (
            "<style type='text/css'><![CDATA[ .a, .b { visibility: hidden } ]]></style><line class='x b' x2='2'/><line x2='1'/>",
            &[1.0],
        ),
        ("<line id='guide' x2='2'/><line x2='1'/><style>#guide{display:none}</style>", &[1.0]),
        (
            "<style>line{display:none} .on{display:inline}</style><line x2='2'/><line class='on' x2='1'/>",
            &[1.0],
        ),
        ("<style>g > line{display:none}</style><g><line x2='2'/></g><line x2='1'/>", &[1.0]),
        // What counts more: style over sheets over attributes, but for !important.
        ("<style>.a{display:none}</style><line class='a' style='display:inline' x2='1'/>", &[1.0]),
        ("<style>.a{display:inline}</style><line class='a' display='none' x2='1'/>", &[1.0]),
        (
            "<style>.a{display:none!important}</style><line class='a' style='display:inline' x2='2'/><line x2='1'/>",
            &[1.0],
        ),
        ("<style>#a{display:inline}.a{display:none}</style><line id='a' class='a' x2='1'/>", &[1.0]),
        (
            "<style media='screen'>.c{fill:red}</style><style>@media print{.c{x:1}}.a{display:none}</style><line class='a' x2='2'/><line class='c' x2='1'/>",
            &[1.0],
        ),
        (
            "<defs><line x2='2'/></defs><symbol><line x2='3'/></symbol><clipPath><line x2='4'/></clipPath><line x2='1'/>",
            &[1.0],
        ),
        (
            "<mask><line x2='2'/></mask><marker><line x2='3'/></marker><pattern><g><line x2='4'/></g></pattern><line x2='1'/>",
            &[1.0],
        ),
        ("<x:line xmlns:x='other' x2='2'/><line x2='1'/>", &[1.0]),
        // In what is hidden nothing is wrong.
        ("<g display='none'><path d='nonsense'/><use href='#g'/><text>x</text></g><line x2='1'/>", &[1.0]),
    ] {
        assert_eq!(lengths(body), expected, "{body}");
        assert!(all(body).notes.is_empty(), "{body}: {:?}", all(body).notes);
    }
    let hidden = in_svg("<line x2='1'/>").replacen("<svg", "<svg style='display:none'", 1);
    refused(svg::parse(hidden.as_bytes()), (1, 1), "draws no lines");
}

#[test]
fn a_switch_takes_one_child() {
    for (children, expected) in [
        ("<line x2='1'/><line x2='2'/>", 1.0),
        ("<title>t</title><g><line x2='1'/></g><line x2='2'/>", 1.0),
        ("<line systemLanguage='de' x2='2'/><line systemLanguage='fr, en-GB' x2='1'/><line x2='3'/>", 1.0),
        ("<line systemLanguage='de' x2='2'/><line x2='1'/>", 1.0),
        ("<line systemLanguage='' x2='2'/><line systemLanguage='english' x2='3'/><line x2='1'/>", 1.0),
        (
            "<foreignObject requiredExtensions='http://ns.adobe.com/AdobeIllustrator/10.0/'/><g><line x2='1'/></g>",
            1.0,
        ),
    ] {
        let body = format!("<switch>{children}</switch>");
        assert_eq!(lengths(&body), [expected], "{body}");
        assert!(all(&body).notes.is_empty());
    }
    // What is chosen may be hidden; conditions hold outside of a switch, too.
    assert_eq!(lengths("<switch><line display='none' x2='2'/><line x2='3'/></switch><line x2='1'/>"), [1.0]);
    assert_eq!(lengths("<line systemLanguage='de' x2='2'/><line systemLanguage='en' x2='1'/>"), [1.0]);
}

#[test]
fn transforms_of_css() {
    for transform in [
        "style='transform: translate(1px, 2px)'",
        "style='transform:translate(1px,2px)'",
        "style='transform: translateX(1px) translateY(2px)'",
        "style='transform: translate(.75pt, 1.5pt)'",
        "style='transform: matrix(1, 0, 0, 1, 1, 2)'",
        "style='transform: rotate(0.25turn) translate(2px, -1px) rotate(-90deg)'",
        "style='transform: rotate(90deg) rotate(-100grad) translate(1px, 2px) scale(1) skewX(0)'",
        "class='moved'",
        "class='moved' transform='scale(7)'",
        "transform='translate(1 2)'",
        "transform='rotate(90) translate(2 -1) rotate(-90)'",
        "transform='scale(-1)' transform-origin='1 1.5' style='transform:translate(1px,2px)'",
    ] {
        let body =
            format!("<style>.moved{{transform:translate(1px,2px)}}</style><g {transform}><line x2='1'/></g>");
        let [[x, y], _] = read(&body)[0][..] else { panic!("{body}") };
        assert!((x - 1.0).abs() < 1e-6 && (y + 2.0).abs() < 1e-6, "{x} {y}: {body}");
    }
    assert_eq!(
        read("<line x2='1' style='transform:none' transform='scale(2)'/>"),
        [[[0.0, 0.0], [1.0, 0.0]]]
    );
    // The point that stays.
    let turned = read("<line x2='1' style='transform:rotate(180deg);transform-origin:1px 1px'/>");
    assert!((turned[0][0][0] - 2.0).abs() < 1e-6 && (turned[0][0][1] + 2.0).abs() < 1e-6, "{turned:?}");
    let turned = read("<line x2='1' transform='rotate(180)' style='transform-origin:50% 50%'/>");
    assert!((turned[0][0][0] - 9.0).abs() < 1e-5 && (turned[0][0][1] + 9.0).abs() < 1e-5, "{turned:?}");
}

#[test]
fn round_shapes() {
    let on = |body: &str, middle: [f32; 2], radii: [f32; 2]| {
        let read = all(body).value;
        assert_eq!((read.len(), read[0].closed), (1, Some(true)), "{body}");
        let points = &read[0].points;
        assert!((40..200).contains(&points.len()), "{body}: {}", points.len());
        for (n, p) in points.iter().enumerate() {
            let away = [0, 1].map(|k| (p[k] - middle[k]) / radii[k]);
            assert!((away[0].hypot(away[1]) - 1.0).abs() < 2e-3, "{p:?}: {body}");
            assert_ne!(p, &points[(n + 1) % points.len()], "{body}");
        }
    };
    on("<circle cx='1' cy='2' r='3'/>", [1.0, -2.0], [3.0; 2]);
    on("<circle style='cx:1px;cy:2px;r:3px' r='9'/>", [1.0, -2.0], [3.0; 2]);
    on("<ellipse cx='1' cy='2' rx='3' ry='1'/>", [1.0, -2.0], [3.0, 1.0]);
    on("<ellipse rx='3'/>", [0.0; 2], [3.0; 2]);
    on("<circle r='1000000' transform='scale(1e-6)'/>", [0.0; 2], [1.0; 2]);
    // Corners so round that no side is left.
    on("<rect x='-2' y='-1' width='4' height='2' rx='9' ry='7'/>", [0.0; 2], [2.0, 1.0]);
    on("<rect width='2' height='2' rx='1'/>", [1.0, -1.0], [1.0; 2]);
    let rect = &read("<rect width='6' height='4' rx='1' ry='2'/>")[0];
    assert!(rect.iter().all(|p| p[0] >= -1e-6 && p[0] <= 6.0 && p[1] <= 1e-6 && p[1] >= -4.0), "{rect:?}");
    let corner = rect.iter().filter(|p| p[0] > 5.0 && p[1] > -2.0).map(|p| [p[0] - 5.0, (p[1] + 2.0) / 2.0]);
    assert!(corner.clone().count() > 10);
    corner.for_each(|[x, y]| assert!((x.hypot(y) - 1.0).abs() < 2e-3));
    assert_eq!(read("<rect width='1' height='2' rx='0' ry='2'/>")[0].len(), 4);
    assert_eq!(read("<rect width='1' height='2' rx='-1'/>")[0].len(), 4);
}

#[test]
fn lengths_have_units() {
    let inch =
        lengths("<line x2='1in'/><line x2='2.54cm'/><line x2='25.4mm'/><line x2='72pt'/><line x2='6pc'/>");
    assert!(inch.iter().all(|x| (x - 96.0).abs() < 1e-4), "{inch:?}");
    // Of the viewBox, which is 9 × 9.
    assert_eq!(lengths("<line x2='100%'/>"), [9.0]);
    let plain = b"<svg width='20' height='10'><line x2='50%' y2='50%'/></svg>";
    assert_eq!(svg::parse(plain).expect("a line").value[0].points[1], [10.0, -5.0, 0.0, 1.0]);
    refused(
        svg::parse(b"<svg><line x2='50%'/></svg>"),
        (1, 1),
        "x2 is not read (`50%`: the svg has no viewBox and no size",
    );
}

#[test]
fn what_has_no_size_is_counted() {
    let body = "<rect width='3'/><rect height='0' width='2'/><rect width='-1' height='2'/><circle/><circle r='-1'/>\
        <ellipse rx='0' ry='2'/><ellipse/><polygon/><polyline points=' '/><path/><line x1='1' x2='1'/><line x2='1'/>";
    let read = all(body);
    assert_eq!(read.value.len(), 1);
    let says = "skipped 3 × rect without a size, 2 × circle without a size, 2 × ellipse without a size, 1 × polygon \
                without points, 1 × polyline without points, 1 × path without data, 1 × line without a length";
    assert_eq!(read.notes, [says]);
}

#[test]
fn what_is_not_read_is_counted() {
    let body = "<text>a<tspan>b</tspan></text><image/><g><text>c</text></g><flowRoot/><line x2='1'/><use href='b.svg#a'/>\
        <use href='#none'/><use/><a><line x2='2'/></a>";
    let read = all(body);
    assert_eq!(read.value.len(), 2);
    let says = "skipped 2 × text, 1 × image, 1 × flowRoot, 1 × use of another file, 2 × use of nothing";
    assert_eq!(read.notes, [says]);
    let text = in_svg("<text>a</text>");
    refused(svg::parse(text.as_bytes()), (1, 1), "circle and ellipse are read (skipped 1 × text)");
    for (body, says) in [
        (
            "<g display='none'><path d='M0 0h1'/><rect/></g>",
            "it has 2 shapes, but renders none (hidden by display",
        ),
        (
            "<defs><line x2='1'/></defs>",
            "it has 1 shape, but renders none (hidden by display or visibility, in defs",
        ),
        (
            "<rect/><text>a</text>",
            "it has 1 shape, but renders none (skipped 1 × rect without a size, 1 × text)",
        ),
    ] {
        refused(svg::parse(in_svg(body).as_bytes()), (1, 1), says);
    }
}

/// What cannot be read is no reason to refuse what can be.
#[test]
fn what_is_wrong_in_itself_is_skipped() {
    let flat = "in a transform of size zero";
    for (body, note) in [
        ("<rect width='1em' height='2rem'/>", "1 × rect whose width is not read (`1em`: no font is known here)".to_string()),
        ("<rect width='abc'/>", "1 × rect whose width is not read (`abc`: a length is a number, with px, mm, cm, in, pt or pc if it has a unit)".to_string()),
        (
            "<rect style='width:1furlong' height='2'/>",
            "1 × rect whose width is not read (`1furlong`: a length is a number, with px, mm, cm, in, pt or pc if it has a unit)".to_string(),
        ),
        ("<circle r='x'/><circle r='x'/>", "2 × circle whose r is not read (`x`: a length is a number, with px, mm, cm, in, pt or pc if it has a unit)".to_string()),
        (
            "<path style='d:path(\"M0 0L1 1\")'/>",
            "1 × path whose d is not read (`path(\"M0 0L1 1\")`: the data of a path are read from its attribute d)".to_string(),
        ),
        ("<polyline points='none'/>", "1 × polyline without points".to_string()),
        (
            "<svg viewBox='0 0 1 x'><line x2='2'/></svg>",
            "1 × svg whose viewBox is not read (`0 0 1 x`: a viewBox is four numbers, of which width and height are positive)".to_string(),
        ),
        (
            "<svg viewBox='0 0 1 1' preserveAspectRatio='middle'/>",
            "1 × svg whose preserveAspectRatio is not read (`middle`: it is none or one as xMidYMid, with meet or slice)".to_string(),
        ),
        (
            "<line id='l' x2='3' display='none'/><use href='#l' x='a'/>",
            "1 × use whose x is not read (`a`: a length is a number, with px, mm, cm, in, pt or pc if it has a unit)".to_string(),
        ),
        ("<g id='a'><use href='#a'/></g>", "1 × use of what it is a part of".to_string()),
        ("<use id='a' href='#a'/>", "1 × use of what it is a part of".to_string()),
        (
            "<defs><g id='a'><use href='#b'/></g><g id='b'><use href='#a'/></g></defs><use href='#a'/>",
            "1 × use of what it is a part of".to_string(),
        ),
        (
            "<g transform='scale(0)'><path d='M1 1h2'/><g><line x2='2'/></g></g>",
            format!("1 × path {flat}, 1 × line {flat}"),
        ),
        (
            "<rect width='1' height='1' transform='rotate(30) scale(1 0) rotate(50)'/>",
            format!("1 × rect {flat}"),
        ),
        ("<circle r='1' style='transform:skewX(45deg) matrix(1,1,1,1,0,0)'/>", format!("1 × circle {flat}")),
    ] {
        let read = all(&format!("{body}<line x2='1'/>"));
        assert_eq!((read.value.len(), &read.notes[..]), (1, &[format!("skipped {note}")][..]), "{body}");
    }
    // Small is not flat.
    assert_eq!(read("<line x2='1e9' transform='scale(1e-9 1e-20)'/>").len(), 1);
}

#[test]
fn sheets_are_for_media() {
    for (media, applies) in [
        ("", true),
        ("all", true),
        ("Screen", true),
        ("print, screen", true),
        ("only screen", true),
        ("not print", true),
        ("print", false),
        ("not screen", false),
        ("screen and (max-width: 10px)", false),
    ] {
        let body = format!(
            "<style media='{media}'>.a{{display:none}}</style><line class='a' x2='2'/><line x2='1'/>"
        );
        assert_eq!(read(&body).len(), if applies { 1 } else { 2 }, "{media}");
    }
}

#[test]
fn instances() {
    let defs = "<defs><line id='l' x2='1'/><g id='g'><line x2='1'/><use href='#l' y='1'/></g></defs>";
    let drawn = |body: &str| read(&format!("{defs}{body}"));
    assert_eq!(drawn("<use href='#l' x='2' y='3'/>"), [[[2.0, -3.0], [3.0, -3.0]]]);
    assert_eq!(
        drawn("<use xmlns:xlink='http://www.w3.org/1999/xlink' xlink:href='#l' x='2' transform='scale(2)'/>"),
        [[[4.0, 0.0], [6.0, 0.0]]]
    );
    assert_eq!(drawn("<use href='#g' x='2'/>"), [[[2.0, 0.0], [3.0, 0.0]], [[2.0, -1.0], [3.0, -1.0]]]);
    // Twice is no circle, and what is hidden at one place is not at another.
    assert_eq!(drawn("<use href='#g'/><g display='none'><use href='#g'/></g><use href='#g'/>").len(), 4);
    assert_eq!(drawn("<use href='#l' visibility='hidden'/><use href='#l'/>").len(), 1);
    // Before what it names, of what is drawn itself, of a shape with a class.
    assert_eq!(
        read(
            "<use href='#b' y='1'/><line id='b' class='c' x2='1'/><style>.c{transform:translate(1px)}</style>"
        ),
        [[[1.0, -1.0], [2.0, -1.0]], [[1.0, 0.0], [2.0, 0.0]]]
    );
    // A symbol is fitted into the box of its use.
    let symbol = "<symbol id='s' viewBox='0 0 2 1'><rect width='2' height='1'/></symbol>";
    let corners = |body: &str| {
        let read = read(&format!("{symbol}{body}"));
        assert_eq!(read.len(), 1, "{body}");
        (read[0][0], read[0][2])
    };
    assert_eq!(corners("<use href='#s' x='1' width='4' height='4'/>"), ([1.0, -1.0], [5.0, -3.0]));
    assert_eq!(corners("<use href='#s'/>"), ([0.0, -2.25], [9.0, -6.75]));
    let plain = "<symbol id='p'><line x2='1'/></symbol><use href='#p' x='1'/>";
    assert_eq!(read(plain), [[[1.0, 0.0], [2.0, 0.0]]]);
}

#[test]
fn drawings_in_drawings() {
    for (svg, first) in [
        ("x='1' y='2' width='4' height='8' viewBox='0 0 1 1'", [1.0, -4.0]),
        ("x='1' y='2' width='4' height='8' viewBox='0 0 1 1' preserveAspectRatio='xMinYMin'", [1.0, -2.0]),
        (
            "x='1' y='2' width='4' height='8' viewBox='0 0 1 1' preserveAspectRatio='xMaxYMax meet'",
            [1.0, -6.0],
        ),
        (
            "x='1' y='2' width='4' height='8' viewBox='0 0 1 1' preserveAspectRatio='xMidYMid slice'",
            [-1.0, -2.0],
        ),
        ("x='1' y='2' width='4' height='8' viewBox='-1 -1 1 1' preserveAspectRatio='none'", [5.0, -10.0]),
        ("x='1' y='2'", [1.0, -2.0]),
    ] {
        assert_eq!(read(&format!("<svg {svg}><rect width='1' height='1'/></svg>"))[0][0], first, "{svg}");
    }
    // Percents are of the inner one.
    assert_eq!(
        lengths(
            "<svg width='10%' height='1'><line x2='100%'/></svg><svg viewBox='0 0 90 90'><line x2='50%'/></svg>"
        ),
        [0.9, 4.5]
    );
    let none = all("<svg width='0' height='1'><line x2='1'/></svg><line x2='1'/>");
    assert_eq!((none.value.len(), &none.notes[..]), (1, &["skipped 1 × svg without a size".to_string()][..]));
}

/// Ten lines, each of which names the one before ten times.
#[test]
fn instances_do_not_multiply_without_end() {
    let mut body = "<defs><line id='a0' x2='1'/>".to_string();
    for n in 1..10 {
        body += &format!("\n<g id='a{n}'>{}</g>", format!("<use href='#a{}'/>", n - 1).repeat(10));
    }
    body += "</defs><use href='#a9'/>";
    let error = svg::parse(in_svg(&body).as_bytes()).expect_err("a thousand million lines").to_string();
    assert!(error.contains("draws more than 1048576 elements"), "{error}");
    let deep: String = (0..20_000).map(|n| format!("<use id='a{}' href='#a{n}'/>", n + 1)).collect();
    assert_eq!(read(&format!("<defs><line id='a0' x2='1'/>{deep}</defs><use href='#a20000'/>")).len(), 1);
}
