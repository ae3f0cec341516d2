//! What is measured of particles in a bath beside a run: each study a file, its section of the report in `sections`.
