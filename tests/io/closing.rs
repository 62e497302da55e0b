//! Which curves of an `.svg` are closed, and what becomes of them in rings and open words.

use super::in_svg;
use crate::oracle::Random;
use burgeon::curve::{Axiom, Note, Polyline};
use burgeon::io::curves::svg;
use burgeon::language::{System, Type};

#[track_caller]
fn path(d: &str) -> Polyline {
    let read =
        svg::parse(in_svg(&format!("<path d='{d}'/>")).as_bytes()).unwrap_or_else(|e| panic!("{d}: {e}"));
    let [curve] = &read.value[..] else { panic!("{} curves: {d}", read.value.len()) };
    curve.clone()
}

#[test]
fn decimals_that_sum_to_nothing() {
    for (d, points) in [
        ("m 0 0 3.3 0 0 1.1 -1.1 0 -2.2 -1.1 z", 4),
        ("m 0 0 3.3 0 0 1.1 -1.1 0 -2.2 -1.1", 4),
        ("M10 10l.1.2.7-.1-.8-.1z", 3),
        ("M1e2 3h.1v.7h-.1v-.7", 4),
        // A unit of the last digit or two, as rounded deltas miss.
        ("m 5.25 7.5 10.33 0 0 4.67 -5.16 3.33 -5.18 -7.99 z", 4),
        ("m0 0c1.333 0 2.667 1.333 2.667 2.667s-1.333 2.667-2.667 2.667l.001-5.333z", 0),
        // Scripts print numbers that have been calculated.
        (
            "M1 0L0.30901699437494745 0.9510565162951535L-0.8 0.6L0.9999999999999998 -2.4492935982947064e-16Z",
            3,
        ),
        ("M1 0L.3 .9L-.8 .6L.999999 .000001Z", 3),
    ] {
        let read = path(d);
        assert_eq!(read.closed, Some(true), "{d}");
        assert!(points == 0 || read.points.len() == points, "{d}: {:?}", read.points);
    }
}

/// Ways back that are meant to end beside the start.
#[test]
fn gaps_stay() {
    for (d, points, closed) in [
        ("M0 0h10v10h-10v-9z", 5, true),
        ("m5 3h14v18h-15v-17z", 5, true),
        ("m0 0h2v2h-1v-1z", 5, true),
        ("M0.5 0.5L10.5 0.5L10.5 10.5L0.6 0.6Z", 4, true),
        ("m0 0 1.5 0 0 1.5 -1.4 0 0 -1.4", 5, false),
        ("M0 0 3.25 0 3.25 1", 3, false),
        ("m0 0.5 1e-7 0", 2, false),
        ("m0 0.25 0 1", 2, false),
    ] {
        let read = path(d);
        assert_eq!((read.points.len(), read.closed), (points, Some(closed)), "{d}: {:?}", read.points);
    }
}

/// A ring of so many points that its sides are shorter than what is no gap in others.
#[test]
fn dense_rings_keep_all_points() {
    let count = 1 << 20;
    let at = |n: usize| (std::f64::consts::TAU * n as f64 / count as f64).sin_cos();
    let d: String = (0..count)
        .map(|n| (if n == 0 { "M" } else { " " }, at(n)))
        .map(|(s, (y, x))| format!("{s}{x:.9} {y:.9}"))
        .collect();
    assert_eq!(path(&format!("{d}Z")).points.len(), count);
}

#[test]
fn an_arc_to_its_own_start_adds_no_point() {
    for (d, points) in [
        ("M0 0L1 0A5 5 0 1 0 1 0L1 1Z", 3),
        ("M0 0L1 0a5 5 0 1 0 0 0L1 1Z", 3),
        ("M0 0a2 2 0 1 1 0 0L1 0 1 1Z", 3),
        ("M0 0L1 0 1 1Za1 1 0 0 1 0 0", 3),
        // Without a radius an arc is a line.
        ("M0 0A0 1 0 0 0 1 0L1 1Z", 3),
        // Doubled control points are meant.
        ("M0 0L1 0L1 0L1 1Z", 4),
    ] {
        assert_eq!(path(d).points.len(), points, "{d}");
    }
    let circle = path("M10 0a10 10 0 1 0 -20 0a10 10 0 1 0 20 0z");
    let points = &circle.points;
    assert!((0..points.len()).all(|n| points[n] != points[(n + 1) % points.len()]), "{points:?}");
}

/// A number with so many decimals at most, as editors write it.
fn short(x: f64, decimals: usize) -> String {
    let text = format!("{x:.decimals$}");
    let text = if decimals > 0 { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    let text = text.strip_prefix("0.").map_or(text.to_string(), |rest| format!(".{rest}"));
    text.strip_prefix("-0.").map_or(text.clone(), |rest| format!("-.{rest}"))
}

/// Shapes as an editor writes them: relative coordinates, each rounded by itself, the way back written out.
#[test]
fn shapes_of_editors_close() {
    let mut random = Random::new(0x5eed_0007);
    let mut part = |from: f64, to: f64| from + (to - from) * (random.next() % 100_000) as f64 / 1e5;
    for decimals in [1, 2, 3, 6] {
        for n in 3..63 {
            // Around a middle, not too near to it; corners do not come nearer than some units of the last digit.
            let size = if decimals == 1 { 60.0 } else { 4.0 } * part(0.5, 2.0) * (n as f64 / 12.0).max(1.0);
            let corner = |k: usize, away: f64| {
                let (y, x) = (std::f64::consts::TAU * k as f64 / n as f64).sin_cos();
                [size * away * x, size * away * y]
            };
            let corners: Vec<[f64; 2]> = (0..n).map(|k| corner(k, part(0.7, 1.3))).collect();
            let [x, y] = corners[0];
            let mut d = format!("m {} {}", short(x, decimals), short(y, decimals));
            for k in 1..=n {
                let ([x, y], [p, q]) = (corners[k % n], corners[k - 1]);
                d += &format!(" {},{}", short(x - p, decimals), short(y - q, decimals));
            }
            for d in [d.clone(), format!("{d} z")] {
                let read = path(&d);
                assert_eq!((read.points.len(), read.closed), (n, Some(true)), "{decimals} decimals: {d}");
            }
        }
    }
}

fn axiom(head: &str, curves: Vec<Polyline>) -> (Vec<String>, usize) {
    let text = format!(
        "system s : curve {head}\nmodule P(v: vec2)\naxiom: file \"a.svg\"\nrules:\n  P(v) -> P(v)\n"
    );
    let system = System::parse(&text).unwrap_or_else(|e| panic!("{e}"));
    let axiom = Axiom::load::<String>(&system, &mut |_| Ok(curves.clone())).expect("an axiom");
    assert!(axiom.notes.iter().all(|(file, _)| file == "a.svg"));
    (axiom.notes.iter().map(|(_, note)| note.to_string()).collect(), axiom.len())
}

#[test]
fn closed_and_open_curves_in_words() {
    let curve = |n: usize, closed| {
        let points = (0..n).map(|k| [k as f32, (k * k) as f32, 0.0, 1.0]).collect();
        Polyline { points, closed }
    };
    let none: Vec<String> = Vec::new();
    for head in ["open", "tree"] {
        assert_eq!(axiom(head, vec![curve(3, Some(true))]), (none.clone(), 4));
        assert_eq!(axiom(head, vec![curve(3, Some(false))]), (none.clone(), 3));
        assert_eq!(axiom(head, vec![curve(3, None)]), (none.clone(), 3));
        assert_eq!(axiom(head, vec![curve(1, Some(true))]), (none.clone(), 1));
    }
    assert_eq!(axiom("ring", vec![curve(3, Some(true))]), (none.clone(), 3));
    assert_eq!(axiom("ring", vec![curve(3, None)]), (none.clone(), 3));
    let open = "the curve is open; a ring joins its last point to its first";
    assert_eq!(axiom("ring", vec![curve(3, Some(false))]), (vec![open.to_string()], 3));
    let joined = "2 curves are joined to one, each from the end of the one before";
    let two = vec![curve(3, Some(true)), curve(2, Some(false))];
    assert_eq!(axiom("open", two.clone()), (vec![joined.to_string()], 6));
    assert_eq!(axiom("ring", two), (vec![joined.to_string()], 5));
}

#[test]
fn coordinates_that_a_module_does_not_hold() {
    let points = vec![[0.0, 0.0, 0.0, 1.0], [1.0, 0.0, 2.0, 0.5], [1.0, 0.0, 3.0, 1.0]];
    let curve: Polyline = points.into();
    let z = "z of 2 points is left out: P holds a vec2";
    let w = "the weight of 1 point is left out: P holds a vec2";
    assert_eq!(axiom("open", vec![curve.clone()]).0, [z, w]);
    let notes = |ty: &str| {
        let text = format!(
            "system s : curve ring\nmodule Q(r: float, v: {ty})\naxiom: Q(1, _) = file \"a.obj\"\nrules:\n  Q(r, v) -> Q(r, v)\n"
        );
        let system = System::parse(&text).unwrap_or_else(|e| panic!("{e}"));
        burgeon::curve::notes(&system, "a.obj", std::slice::from_ref(&curve), false)
    };
    let left_out = Note::LeftOut { axis: 3, points: 1, module: "Q".to_string(), ty: Type::Vec3 };
    assert_eq!(notes("vec3"), [left_out]);
    assert_eq!(notes("vec4"), []);
}
