//! Cells that a box is cut into.

use crate::domain::Domain;
use stripmine_kernels::sweep::fast::{Grid, GridError};

/// Sectors for each disc, and more for few discs, beyond which they are made wider: each takes time in every step, also if it is
/// empty.
const SECTORS_A_DISC: f64 = 64.0;
const SECTORS_OF_FEW: f64 = 1024.0;
/// Sides of a sector over the reach in single precision, at most: places seen from its centre are then known to 3·10⁻⁶ of the
/// reach, and the squares of distances to less than the margin with which pairs are looked for.
const WIDEST: f64 = 100.0;

/// Sectors at least `reach` wide (length) for `discs` discs in a box. Where numbers of single precision are at work, places
/// seen from a sector's centre must be short, so that sectors are narrow even if most are empty; but not so narrow that there
/// are many times more sectors than discs.
///
/// # Errors
/// [`GridError`] if the box is none for sectors.
pub(crate) fn sectors_of(domain: &Domain, reach: f64, single: bool, discs: usize) -> Result<Grid, GridError> {
    let most = SECTORS_A_DISC * discs as f64 + SECTORS_OF_FEW;
    let widest = match single {
        true => (domain.area() / most).sqrt().clamp(2.0 * reach, WIDEST * reach),
        false => f64::INFINITY,
    };
    Grid::new(domain.corner(), domain.lengths(), domain.periodic(), reach, widest, discs)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// However large the box, there are at most some sectors a disc, none narrower than the reach; in single precision not so
    /// wide that places are inexact, and where discs are not very far apart as narrow as ever.
    #[test]
    fn empty_boxes_have_few_sectors() {
        for single in [false, true] {
            for discs in [1, 400, 100_000] {
                // From discs that touch to those that are 30 000 reaches apart.
                for spacing in [1.0, 3.0, 30.0, 300.0, 3000.0, 30_000.0] {
                    let side = (spacing * f64::from(discs).sqrt()).max(3.0);
                    for sides in [[side; 2], [side * side / 3.0, 3.0]] {
                        let domain = Domain::planar([0.0; 2], sides, [true; 2]);
                        let Ok(grid) = sectors_of(&domain, 1.0, single, discs as usize) else {
                            // A box so large that sectors as wide as places bear are more than can be numbered.
                            let least = (domain.area() / (WIDEST * WIDEST)).max(3.0 * sides[0] / WIDEST);
                            assert!(single && least >= f64::from(u32::MAX), "{sides:?}");
                            continue;
                        };
                        let [width, height] = grid.frame.edge;
                        let count = (grid.counts[0] * grid.counts[1]) as f64;
                        let bound = match single {
                            true => (SECTORS_A_DISC * f64::from(discs) + SECTORS_OF_FEW)
                                .max(domain.area() / (WIDEST * WIDEST))
                                .max(grid.counts[0] as f64 * 3.0),
                            false => f64::from(discs).max(9.0).max(grid.counts[0] as f64 * 3.0),
                        };
                        assert!(width >= 1.0 && height >= 1.0, "{width} {height}");
                        assert!(count <= 1.5 * bound, "{discs} {sides:?}: {count} of {bound} sectors");
                        if single {
                            assert!(
                                width.max(height) <= 1.5 * WIDEST || grid.counts.contains(&3),
                                "{width} {height}"
                            );
                        }
                        if single && spacing <= 10.0 {
                            assert!(width.max(height) <= 3.0, "{width} {height}");
                        }
                    }
                }
            }
        }
    }
}
