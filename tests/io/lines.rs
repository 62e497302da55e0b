//! Curves from `.obj`: edges that share vertices are lines and rings.

use super::refused;
use burgeon::io::obj;
use proptest::prelude::*;
use std::collections::BTreeSet;

/// The curves, by the numbers of their vertices, and whether they close.
#[track_caller]
fn chains(lines: &str) -> Vec<(Vec<usize>, bool)> {
    let vertices: String = (1..=9).map(|n| format!("v {n} 0 0\n")).collect();
    let read = obj::lines(format!("{vertices}{lines}").as_bytes()).unwrap_or_else(|e| panic!("{lines}: {e}"));
    let numbers = |points: &[[f32; 4]]| points.iter().map(|p| p[0] as usize).collect();
    read.value.iter().map(|c| (numbers(&c.points), c.closed.expect("lines say it"))).collect()
}

#[test]
fn edges_are_chained() {
    let ring = |points: &[usize]| vec![(points.to_vec(), true)];
    let open = |points: &[usize]| vec![(points.to_vec(), false)];
    for (lines, expected) in [
        ("l 1 2\nl 2 3\nl 3 4\nl 4 1\n", ring(&[1, 2, 3, 4])),
        ("l 3 4\nl 2 1\nl 4 1\nl 2 3\n", ring(&[3, 4, 1, 2])),
        ("l 1 2\nl 3 2\nl 3 1\n", ring(&[1, 2, 3])),
        ("l 1 2 3 4 1\n", ring(&[1, 2, 3, 4])),
        ("l 1 2 3\nl 1 5 3\n", ring(&[1, 2, 3, 5])),
        ("l 2 3\nl 1 2\nl 4 3\n", open(&[1, 2, 3, 4])),
        ("l 3 2\nl 1 2\nl 4 3\n", open(&[4, 3, 2, 1])),
        ("l 1 2 3\nl 5 4 3\n", open(&[1, 2, 3, 4, 5])),
        ("l 1 2\nl 2 1\nl 1 2\nl 2 3\n", open(&[1, 2, 3])),
        ("l -9 -8\nl -8/1 -7/2\n", open(&[1, 2, 3])),
        ("l 1 2 \\\n 3 4\nl 4 \\  \r\n5\r\n", open(&[1, 2, 3, 4, 5])),
        ("# up to here \\\nl 1 2\n", open(&[1, 2])),
        ("l 1 1\nl 1 2\n", open(&[1, 2])),
        // There and back again is a line of its own.
        ("l 1 2 1\n", ring(&[1, 2])),
    ] {
        assert_eq!(chains(lines), expected, "{lines}");
    }
    // Lines end at a vertex with three edges, whoever passes there.
    let three = [(vec![1, 2], false), (vec![2, 3], false), (vec![2, 4, 5], false)];
    assert_eq!(chains("l 1 2\nl 2 3\nl 2 4\nl 5 4\n"), three);
    assert_eq!(chains("l 1 2 3\nl 2 4\nl 4 5\n"), [(vec![1, 2, 3], false), (vec![2, 4, 5], false)]);
    assert_eq!(chains("l 1 2 3 1\nl 1 4\n"), [(vec![1, 2, 3], true), (vec![1, 4], false)]);
    // Two rings that touch: four edges.
    let eight = chains("l 1 2\nl 2 3\nl 3 1\nl 1 4\nl 4 5\nl 5 1\n");
    assert_eq!(eight, [(vec![1, 2, 3, 1], false), (vec![1, 4, 5, 1], false)]);
    assert_eq!(chains("l 1 2\nl 5 6\nl 3 2\nl 6 7\n"), [(vec![1, 2, 3], false), (vec![5, 6, 7], false)]);
}

#[test]
fn weights_are_no_factors() {
    let read =
        obj::lines(b"v 2 0 0 2\nv 1 0 0 1\nv 3 4 5 0\nv 1 2 3 0.1 0.2 0.3\nl 1 2 3 4").expect("a line").value;
    assert_eq!(
        read[0].points,
        [[2.0, 0.0, 0.0, 2.0], [1.0, 0.0, 0.0, 1.0], [3.0, 4.0, 5.0, 0.0], [1.0, 2.0, 3.0, 1.0]]
    );
}

#[test]
fn what_is_no_line() {
    let read = obj::lines(b"v 0 0 0\nv 1 0 0\nf 1 2 1\np 1\nl 1 2\nl 2 2\n").expect("a line");
    assert_eq!(read.value.len(), 1);
    assert_eq!(read.notes, ["skipped 1 × face, 1 × point, 1 × line from a vertex to itself"]);
    // Vertices alone are one curve, of which nobody says whether it closes.
    let read = obj::lines(b"v 0 0 0\nv 1 0 0\n").expect("two points").value;
    assert_eq!((read.len(), read[0].closed), (1, None));
    let free = "v 0 0 0\nv 1 0 0\nl 1 2\ncstype rat bspline\ndeg 3\ncurv 0 1 1 2 \\\n 1 2\nparm u 0 1\nend\ncurv2 1 2\n\
                surf 0 1 0 1 1 2\ntrim 0 1 1\nhole 0 1 1\nscrv 0 1 1\nsp 1\ncon 1 0 1 1 2 0 1 1\nbmat u 1\nstep 1\nmg 1\nusemap a\n\
                maplib a\nshadow_obj a\ntrace_obj a\nlod 1\nbevel on\nc_interp on\nd_interp on\nctech cparm 1\n\
                stech cparma 1 1\ncsh ls\ncall a.obj\nsurf 0 1 0 1 1 2\n";
    let read = obj::lines(free.as_bytes()).expect("a line");
    let says = "skipped 1 × curve of free form, 1 × curve of free form on a surface, 2 × surface of free form, 1 × call of \
                another file";
    assert_eq!((read.value.len(), &read.notes[..]), (1, &[says.to_string()][..]));
    refused(obj::lines(b"v 0 0 0\ncurve 1\n"), (2, 1), "`curve` is no statement");
    for (text, place, says) in [
        ("v 0 0 0\nl\n", (2, 1), "line 1 has 0 of the two vertices"),
        ("v 0 0 0\nv 0 0 1\nl 1 2\nl 1\n", (4, 1), "line 2 has 1 of the two vertices"),
        ("v 0 0 0\nl 1 -9223372036854775808\n", (2, 5), "names the vertex"),
        ("v 0 0 \\\n x\nl 1 1\n", (2, 2), "`x` stands where z of vertex 1 should"),
        ("v 0 0 \\\n 1\nl 1 7\n", (3, 5), "names the vertex 7"),
        ("v 0 0 0 nan\n", (1, 9), "the weight of vertex 1 is `nan`"),
    ] {
        refused(obj::lines(text.as_bytes()), place, says);
    }
}

proptest! {
    /// Every edge is in one curve and once, in whatever order edges come, and lines end only at vertices where other than
    /// two edges meet.
    #[test]
    fn no_edge_is_lost(edges in prop::collection::vec((1usize..=9, 1usize..=9), 1..20)) {
        let text: String = edges.iter().map(|(a, b)| format!("l {a} {b}\n")).collect();
        let wanted: BTreeSet<(usize, usize)> =
            edges.iter().filter(|(a, b)| a != b).map(|&(a, b)| (a.min(b), a.max(b))).collect();
        let degree = |v: usize| wanted.iter().filter(|&&(a, b)| a == v || b == v).count();
        let mut found = Vec::new();
        for (mut points, closed) in chains(&text) {
            if closed {
                prop_assert!(points.len() > 2 && points.iter().all(|&v| degree(v) == 2), "{:?}", points);
                points.push(points[0]);
            } else {
                prop_assert!([points[0], points[points.len() - 1]].iter().all(|&v| degree(v) != 2), "{:?}", points);
                prop_assert!(points[1..points.len() - 1].iter().all(|&v| degree(v) == 2), "{:?}", points);
            }
            found.extend(points.windows(2).map(|e| (e[0].min(e[1]), e[0].max(e[1]))));
        }
        prop_assert_eq!(found.len(), wanted.len());
        prop_assert_eq!(found.into_iter().collect::<BTreeSet<_>>(), wanted);
    }
}
