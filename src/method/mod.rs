//! The methods: one folder or file a source.

pub mod lattice_md;
