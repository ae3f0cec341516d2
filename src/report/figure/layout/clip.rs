//! The part of a line inside a box.

use super::super::sheet::{Area, Place};

/// The part of a straight line in a box (Liang and Barsky).
pub fn segment(area: &Area, from: Place, to: Place) -> Option<[Place; 2]> {
    let [dx, dy] = [to[0] - from[0], to[1] - from[1]];
    let mut part = [0.0_f64, 1.0];
    for (rise, room) in [
        (-dx, from[0] - area.left),
        (dx, area.right() - from[0]),
        (-dy, from[1] - area.top),
        (dy, area.bottom() - from[1]),
    ] {
        if rise < 0.0 {
            part[0] = part[0].max(room / rise);
        } else if rise > 0.0 {
            part[1] = part[1].min(room / rise);
        } else if room < 0.0 {
            return None;
        }
    }
    let at = |part: f64| [from[0] + part * dx, from[1] + part * dy];
    // A place too far away to be a number leaves nothing.
    (part[0] <= part[1] && dx.is_finite() && dy.is_finite()).then(|| part.map(at))
}

/// The parts of a line through many places in a box, each without a gap.
pub fn line(area: &Area, places: &[Place]) -> Vec<Vec<Place>> {
    let mut pieces: Vec<Vec<Place>> = Vec::new();
    for (from, to) in places.iter().zip(places.iter().skip(1)) {
        let Some([start, end]) = segment(area, *from, *to) else { continue };
        match pieces.last_mut() {
            Some(piece) if piece.last() == Some(&start) => piece.push(end),
            _ => pieces.push(vec![start, end]),
        }
    }
    pieces
}

/// Diagonal hatching of a box, the same wherever the box lies, so that neighbours join.
pub fn hatching(area: &Area, spacing: f64) -> Vec<Vec<Place>> {
    let (first, last) = (area.left + area.top, area.right() + area.bottom());
    let from = (first / spacing).ceil() as i64;
    let to = (last / spacing).floor() as i64;
    (from..=to)
        .filter_map(|i| {
            // All places of a line have the same sum of coordinates.
            let sum = i as f64 * spacing;
            segment(area, [sum - area.bottom(), area.bottom()], [sum - area.top, area.top])
        })
        .map(Vec::from)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const AREA: Area = Area { left: 0.0, top: 0.0, width: 10.0, height: 10.0 };

    #[test]
    fn lines_end_at_the_edge() {
        assert_eq!(segment(&AREA, [-5.0, 5.0], [5.0, 5.0]), Some([[0.0, 5.0], [5.0, 5.0]]));
        assert_eq!(segment(&AREA, [1.0, 2.0], [3.0, 4.0]), Some([[1.0, 2.0], [3.0, 4.0]]));
        assert_eq!(segment(&AREA, [-5.0, 12.0], [15.0, 12.0]), None);
        assert_eq!(segment(&AREA, [1.0, f64::NEG_INFINITY], [3.0, 4.0]), None);
        let pieces = line(&AREA, &[[1.0, 1.0], [4.0, 4.0], [4.0, 20.0], [8.0, 20.0], [8.0, 5.0]]);
        assert_eq!(pieces, [vec![[1.0, 1.0], [4.0, 4.0], [4.0, 10.0]], vec![[8.0, 10.0], [8.0, 5.0]]]);
    }

    #[test]
    fn hatching_stays_inside() {
        let area = Area { left: 33.0, top: 7.0, width: 50.0, height: 120.0 };
        let lines = hatching(&area, 9.0);
        assert!(lines.len() > 15);
        assert!(lines.iter().flatten().all(|&[x, y]| {
            (33.0 - 1e-9..=83.0 + 1e-9).contains(&x) && (7.0 - 1e-9..=127.0 + 1e-9).contains(&y)
        }));
    }
}
