//! Integrators of the equations of motion, one small file each.

pub mod gear;
