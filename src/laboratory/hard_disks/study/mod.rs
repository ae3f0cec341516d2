//! Studies of hard discs, each a file.

pub mod atmosphere;
pub mod collapse;
pub mod complexity;
pub mod cooling;
pub mod fluid;
pub mod masks;
pub mod precision;
pub mod rates;
pub mod soft_hard;
pub mod structure;
