//! Lines that share their ends, as one line.

/// A line, by its vertices, and whether its last is followed by its first.
pub struct Chain {
    pub vertices: Vec<usize>,
    pub closed: bool,
}

/// Joins lines where exactly two of them end at a vertex that no other line passes, whatever way each of them runs: so
/// edges, of which each is a line, become polylines and rings. At a vertex with three edges or more all lines end that
/// end there. A chain stands where its first line stood, and runs as that one does.
///
/// Each line has two vertices at least, all below `count`; an edge that is there twice is one.
pub fn chains(lines: Vec<Vec<usize>>, count: usize) -> Vec<Chain> {
    let lines = without_doubles(lines);
    let joints = Joints::of(&lines, count);
    let mut used = vec![false; lines.len()];
    let mut chains = Vec::new();
    for first in 0..lines.len() {
        if used[first] {
            continue;
        }
        // Back to where the chain begins, or once around the ring.
        let (mut start, mut closed) = (End { line: first, last: false }, is_ring(&lines[first]));
        while let (Some(before), false) = (joints.across(&lines, start), closed) {
            closed = before.line == first;
            start = if closed { End { line: first, last: false } } else { before.other() };
        }
        let mut vertices = Vec::new();
        let mut next = Some(start);
        while let Some(from) = next.filter(|from| !used[from.line]) {
            used[from.line] = true;
            // The joint is the last vertex of the line before.
            vertices.pop();
            let line = &lines[from.line];
            if from.last {
                vertices.extend(line.iter().rev());
            } else {
                vertices.extend(line);
            }
            next = joints.across(&lines, from.other());
        }
        if closed {
            vertices.pop();
        }
        chains.push(Chain { vertices, closed });
    }
    chains
}

fn is_ring(line: &[usize]) -> bool {
    line.len() > 2 && line.first() == line.last()
}

fn without_doubles(mut lines: Vec<Vec<usize>>) -> Vec<Vec<usize>> {
    let mut edges = std::collections::HashSet::new();
    lines.retain(|line| match line[..] {
        [a, b] => edges.insert((a.min(b), a.max(b))),
        _ => true,
    });
    lines
}

/// An end of a line.
#[derive(Clone, Copy, PartialEq)]
struct End {
    line: usize,
    last: bool,
}

impl End {
    fn other(self) -> End {
        End { last: !self.last, ..self }
    }

    fn vertex(self, lines: &[Vec<usize>]) -> usize {
        let line = &lines[self.line];
        if self.last { line[line.len() - 1] } else { line[0] }
    }
}

/// For each vertex the ends that meet there, if these are two and there is no other edge.
struct Joints(Vec<[Option<End>; 2]>);

impl Joints {
    fn of(lines: &[Vec<usize>], count: usize) -> Joints {
        let mut edges = vec![0usize; count];
        let mut ends = vec![[None; 2]; count];
        for (line, vertices) in lines.iter().enumerate() {
            for pair in vertices.windows(2).filter(|pair| pair[0] != pair[1]) {
                edges[pair[0]] += 1;
                edges[pair[1]] += 1;
            }
            for end in [End { line, last: false }, End { line, last: true }] {
                let there: &mut [Option<End>; 2] = &mut ends[end.vertex(lines)];
                if let Some(free) = there.iter_mut().find(|place| place.is_none()) {
                    *free = Some(end);
                }
            }
        }
        for (ends, edges) in ends.iter_mut().zip(edges) {
            if edges != 2 || ends[1].is_none() {
                *ends = [None; 2];
            }
        }
        Joints(ends)
    }

    /// The end of another line that this end is joined to.
    fn across(&self, lines: &[Vec<usize>], end: End) -> Option<End> {
        let there = self.0[end.vertex(lines)];
        there.into_iter().flatten().find(|&other| other != end && there[0].is_some())
    }
}
