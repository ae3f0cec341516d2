//! Sectors of a box for neighbour searches.

use crate::domain::Domain;
use stripmine_kernels::sweep::fast::{CellGrid, GridError};

/// Largest number of sectors for each disc, and a number added for small systems. Beyond it sectors are widened, because an empty sector takes time
/// in every step too.
const SECTORS_A_DISC: f64 = 64.0;
const SECTORS_OF_FEW: f64 = 1024.0;
/// Largest side of a sector over the reach in single precision. Positions relative to its centre then have an error of 3·10⁻⁶ of the reach, and
/// squared distances have an error below the margin of the pair search.
const WIDEST: f64 = 100.0;

/// Grid of sectors at least `reach` wide (length) for `discs` discs in a box. Single precision needs short positions relative to a sector's centre.
/// Its sectors are narrow even if most are empty, as long as there are not many times more sectors than discs.
///
/// # Errors
/// [`GridError`] if the box cannot be divided into sectors.
pub(crate) fn sectors_of(
    domain: &Domain,
    reach: f64,
    single: bool,
    discs: usize,
) -> Result<CellGrid, GridError> {
    let most = SECTORS_A_DISC * discs as f64 + SECTORS_OF_FEW;
    let widest = match single {
        true => (domain.area() / most).sqrt().clamp(2.0 * reach, WIDEST * reach),
        false => f64::INFINITY,
    };
    CellGrid::new(domain.corner(), domain.lengths(), domain.periodic(), reach, widest, discs)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The number of sectors for each disc is bounded in a box of any size, and none is narrower than the reach. In single precision sectors stay
    /// narrow enough for exact positions, and are as narrow as possible unless discs are very far apart.
    #[test]
    fn empty_boxes_have_few_sectors() {
        for single in [false, true] {
            for discs in [1, 400, 100_000] {
                // Spacings from touching discs to 30 000 reaches.
                for spacing in [1.0, 3.0, 30.0, 300.0, 3000.0, 30_000.0] {
                    let side = (spacing * f64::from(discs).sqrt()).max(3.0);
                    for sides in [[side; 2], [side * side / 3.0, 3.0]] {
                        let domain = Domain::planar([0.0; 2], sides, [true; 2]);
                        let Ok(grid) = sectors_of(&domain, 1.0, single, discs as usize) else {
                            // In a box this large, even sectors of the greatest width are too many to number.
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
