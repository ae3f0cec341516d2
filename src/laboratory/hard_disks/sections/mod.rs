//! How the report shows what is measured of hard discs.

pub mod complexity;
pub mod masks;
pub mod precision;
pub mod rates;
