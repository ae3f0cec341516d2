//! Studies of bodies that attract each other.

pub(super) mod collapse;
pub(super) mod energy;
pub(super) mod force;
pub(super) mod rates;
