//! What is measured of bodies beside a run: each study a file, its section of the report in `sections`.

pub mod collapse;
pub mod energy;
pub mod rates;
