//! Where the points of a root go: what it owns of a level, in one piece of the level's buffer.

use super::tile::Place;
use crate::mesh::Roots;
use glam::Vec4;

/// What a root, or a band of its rows, owns of a level. Points have `N` numbers.
pub struct Output<'a, const N: usize> {
    /// Corners in order; sides as the root runs along them.
    corners: [Option<&'a mut [f32; N]>; 4],
    sides: [Option<&'a mut [[f32; N]]>; 4],
    /// Inner rows, from row `first`.
    inside: &'a mut [[f32; N]],
    first: usize,
    /// The first point along each side that is here.
    along: [usize; 4],
}

impl<'a, const N: usize> Output<'a, N> {
    /// What a root owns, from the front of `level`; and the rest.
    pub fn of(roots: &Roots, root: usize, s: usize, level: &'a mut [[f32; N]]) -> (Self, &'a mut [[f32; N]]) {
        let m = s - 1;
        let mut rest = level;
        let mut take = |count: usize| {
            let (own, after) = std::mem::take(&mut rest).split_at_mut(count);
            rest = after;
            own
        };
        let corners = [0, 1, 2, 3].map(|k| roots.owns_corner(root, k).then(|| &mut take(1)[0]));
        let sides = [0, 1, 2, 3].map(|k| roots.owns_side(root, k).then(|| take(m)));
        let inside = take(m * m);
        (Output { corners, sides, inside, first: 1, along: [1; 4] }, rest)
    }

    /// The rows before row `y`, and those from it on.
    pub fn split(self, y: usize, s: usize) -> (Self, Self) {
        let [a, b, c, d] = self.corners;
        let [bottom, right, top, left] = self.sides;
        let m = s - 1;
        let (low, high) = self.inside.split_at_mut((y - self.first) * m);
        let (right_low, right_high) = parted(right, y - self.along[1]);
        // The last side runs down.
        let (left_high, left_low) = parted(left, s - y + 1 - self.along[3]);
        let before = Output {
            corners: [a, b, None, None],
            sides: [bottom, right_low, None, left_low],
            inside: low,
            first: self.first,
            along: [1, self.along[1], 1, s - y + 1],
        };
        let after = Output {
            corners: [None, None, c, d],
            sides: [None, right_high, top, left_high],
            inside: high,
            first: y,
            along: [1, y, 1, self.along[3]],
        };
        (before, after)
    }

    /// Takes from a tile what is owned here: all points of its quads but those that the next block has first.
    pub fn write(&mut self, place: Place, points: &[Vec4]) {
        let Place { x, y, n, s } = place;
        let short =
            |at: [usize; 2]| *points[place.index(at)].as_ref().first_chunk::<N>().expect("up to four");
        for (k, corner) in self.corners.iter_mut().enumerate() {
            if let (Some(corner), true) = (corner, place.has_corner(k)) {
                **corner = short(place.corner(k));
            }
        }
        // The block after this one has its last row and column first.
        let rows = y.max(1)..y + n;
        let columns = x.max(1)..x + n;
        for (k, side) in self.sides.iter_mut().enumerate() {
            let (Some(side), true) = (side, place.touches(k)) else { continue };
            for at in [&columns, &rows, &columns, &rows][k].clone() {
                side[place.along(k, at, true) - self.along[k]] = short(place.on_side(k, at));
            }
        }
        if columns.is_empty() {
            return;
        }
        let m = s - 1;
        for row in rows {
            let out = &mut self.inside[(row - self.first) * m + columns.start - 1..][..columns.len()];
            copy(&points[place.index([columns.start, row])..][..columns.len()], out);
        }
    }
}

type Half<'a, T> = Option<&'a mut [T]>;

fn parted<T>(side: Half<T>, at: usize) -> (Half<T>, Half<T>) {
    match side.map(|side| side.split_at_mut(at)) {
        Some((before, after)) => (Some(before), Some(after)),
        None => (None, None),
    }
}

/// Four numbers a point, of which the next point overwrites what is too much: whole stores in place of shuffles.
pub fn copy<const N: usize>(points: &[Vec4], out: &mut [[f32; N]]) {
    let Some((last, others)) = points.split_last() else { return };
    let out = out.as_flattened_mut();
    let end = N * others.len();
    for (point, at) in others.iter().zip((0..end).step_by(N)) {
        if let Some(out) = out.get_mut(at..at + 4) {
            out.copy_from_slice(&point.to_array());
        } else {
            out[at..at + N].copy_from_slice(&point.to_array()[..N]);
        }
    }
    out[end..end + N].copy_from_slice(&last.to_array()[..N]);
}
