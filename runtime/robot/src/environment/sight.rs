//! What can be seen from a place: nothing behind walls, nothing beyond the range.

use floorguard_types::geometry::Point2;

/// Walls and furniture as seen from above.
#[derive(Clone, Debug, Default)]
pub struct Sight {
    edges: Vec<(Point2, Point2)>,
    range_m: f32,
}

impl Sight {
    /// From outlines; people are recognised up to `range_m`.
    pub fn new<'a>(outlines: impl Iterator<Item = &'a Vec<Point2>>, range_m: f32) -> Self {
        let edges = outlines.flat_map(|outline| {
            let next = outline.iter().cycle().skip(1);
            outline.iter().copied().zip(next.copied()).collect::<Vec<_>>()
        });
        Self { edges: edges.collect(), range_m }
    }

    /// The walls that can matter from here, to be asked many times.
    pub fn from(&self, observer: Point2) -> impl Fn(Point2) -> bool + use<> {
        let range_m = self.range_m;
        let near = |(a, b): &&(Point2, Point2)| {
            let middle = Point2::new(0.5 * (a.x_m + b.x_m), 0.5 * (a.y_m + b.y_m));
            middle.distance(observer) - 0.5 * a.distance(*b) < range_m
        };
        let edges: Vec<(Point2, Point2)> = self.edges.iter().filter(near).copied().collect();
        move |point| {
            point.distance(observer) <= range_m
                && !edges.iter().any(|(a, b)| cross((observer, point), (*a, *b)))
        }
    }
}

/// Two segments cross.
fn cross((a, b): (Point2, Point2), (c, d): (Point2, Point2)) -> bool {
    let side = |p: Point2, q: Point2, r: Point2| {
        (q.x_m - p.x_m) * (r.y_m - p.y_m) - (q.y_m - p.y_m) * (r.x_m - p.x_m)
    };
    side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn walls_hide() {
        let shelf =
            [(2.0, -1.0), (2.2, -1.0), (2.2, 1.0), (2.0, 1.0)].map(|(x, y)| Point2::new(x, y)).to_vec();
        let sight = Sight::new([shelf].iter(), 10.0);
        let sees = sight.from(Point2::new(0.0, 0.0));
        assert!(sees(Point2::new(1.9, 0.0)) && sees(Point2::new(4.0, 6.0)));
        assert!(!sees(Point2::new(4.0, 0.0)) && !sees(Point2::new(-11.0, 0.0)));
    }
}
