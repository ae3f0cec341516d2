//! Cells that a box is cut into.

use crate::domain::Domain;
use stripmine_kernels::sweep::fast::{Grid, GridError};

/// Sectors at least `reach` wide (length) for `discs` discs in a box. Where numbers of single precision are at work, places
/// seen from a sector's centre must be short, so that sectors are narrow even if nearly all are empty.
///
/// # Errors
/// [`GridError`] if the box is none for sectors.
pub fn sectors_of(domain: &Domain, reach: f64, single: bool, discs: usize) -> Result<Grid, GridError> {
    let widest = if single { 2.0 * reach } else { f64::INFINITY };
    Grid::new(domain.corner(), domain.lengths(), domain.periodic(), reach, widest, discs)
}
